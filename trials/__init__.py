"""Concealed trials: the virtual robot with something hidden in it, answered without labels, scored."""
