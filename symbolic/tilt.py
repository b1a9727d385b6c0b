"""A model on a base that does not stand as it was thought to."""

from math import cos, sin

from ..robots import Robot
from ..robots.model import Model
from .nominal import nominal_model


def tilted_gravity(
    gravity: tuple[float, float, float], roll: float, pitch: float
) -> tuple[float, float, float]:
    """Return gravity (m/s^2) as a base sees it that was turned by roll about x, then pitch about y (rad)."""
    x, y, z = gravity
    x, z = x * cos(pitch) - z * sin(pitch), x * sin(pitch) + z * cos(pitch)
    return x, y * cos(roll) + z * sin(roll), z * cos(roll) - y * sin(roll)


def tilted(model: Model, robot: Robot, roll: float, pitch: float) -> Model:
    """Return the model with its base turned by roll about x, then pitch about y (rad).

    On a level base nothing depends on the first link's moments about the vertical; tilted, something does.
    Base parameters that the model does not have for that reason are those of the robot's published links.
    """
    gravity = tilted_gravity(model.gravity, roll, pitch)
    turned = robot.model_copy(update={"gravity": gravity})
    published = nominal_model(turned, "", model.dof, model.locked_angles)
    return model.model_copy(update={"gravity": gravity, "base": {**published.base, **model.base}})
