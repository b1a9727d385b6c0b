"""Collision experiments: the thesis' campaign on the virtual arm, what lies beyond it, real recordings."""
