"""The fixtures of the driver's tests."""

from virtual_robot import controller, robot

__all__ = ["controller", "robot"]
