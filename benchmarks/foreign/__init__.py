"""Robots whose physics is not ours: MuJoCo's own friction loss, damping and springs, and a plain controller."""
