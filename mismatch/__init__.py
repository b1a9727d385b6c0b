"""Locates where recordings and model differ, names the physics that was left out, and proves it."""

from .explain import Task, explain
from .result import Explanation

__all__ = ["Explanation", "Task", "explain"]
