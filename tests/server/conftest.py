"""The fixtures of the virtual controller's tests."""

from virtual_robot import controller, robot

__all__ = ["controller", "robot"]
