"""What acts on the arm from outside: pushes in time, and things that stand in its way.

The contact law is our own, not MuJoCo's: its soft constraints tie stiffness and damping to the effective
mass, and here they have to be the stated N/m and N s/m. It also needs no geometry but a point and a plane.
"""

from math import cos, pi
from typing import Literal

import mujoco
import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from ..robots import Robot
from ..robots.schema import Frozen, Vector3
from .model import link_frame

Array = npt.NDArray[np.float64]


class Contact(Frozen):
    """A wrench at a point of a link from `start` to `end` (s).

    link: 1..N, None = the last; point: m in its DH frame. force (N), moment (Nm): in the base frame, or in
    the link's.
    profile: smooth = raised cosine; hold = rises and falls over `edge` s and stays in between.
    """

    start: float
    end: float
    force: Vector3 = (0.0, 0.0, 0.0)
    moment: Vector3 = (0.0, 0.0, 0.0)
    link: int | None = Field(default=None, ge=1, le=6)
    point: Vector3 = (0.0, 0.0, 0.0)
    frame: Literal["base", "link"] = "base"
    profile: Literal["smooth", "hold"] = "smooth"
    edge: float = Field(default=0.1, gt=0)

    @model_validator(mode="after")
    def _ends_after_it_starts(self) -> "Contact":
        if self.end <= self.start:
            raise ValueError("end must be later than start")
        return self

    def strength(self, time: float) -> float:
        """Return the part 0..1 of the wrench that acts at a time (s)."""
        if not self.start < time < self.end:
            return 0.0
        half = 0.5 * (self.end - self.start)
        edge = half if self.profile == "smooth" else min(self.edge, half)
        near = min(time - self.start, self.end - time)
        return 1.0 if near >= edge else 0.5 * (1.0 - cos(pi * near / edge))


class Obstacle(Frozen):
    """Something soft with a flat face, which a point of a link may run into; without surface friction.

    link: 1..N, None = the last; point: m in its DH frame. place: a point of the face (m, base frame);
    normal: out of the obstacle, towards the arm.
    Force along the normal, at depth x > 0: stiffness x + damping x' min(x / 2 mm, 1), never below 0 (the
    damper fades in, since a soft thing does not hit at once); beyond `thickness` bottom_stiffness is added.
    """

    place: Vector3
    normal: Vector3
    stiffness: float = Field(gt=0)  # N/m
    damping: float = Field(default=0.0, ge=0)  # N s/m
    thickness: float | None = Field(default=None, gt=0)  # m
    bottom_stiffness: float = Field(default=1.0e5, ge=0)  # N/m
    link: int | None = Field(default=None, ge=1, le=6)
    point: Vector3 = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _normal_is_a_direction(self) -> "Obstacle":
        if sum(x * x for x in self.normal) == 0.0:
            raise ValueError("normal must not be zero")
        return self

    def force(self, depth: float, rate: float) -> float:
        """Return the force along the normal (N) at some depth (m) and rate of depth (m/s)."""
        if depth <= 0.0:
            return 0.0
        force = self.stiffness * depth + self.damping * rate * min(depth / 0.002, 1.0)
        if self.thickness is not None and depth > self.thickness:
            force += self.bottom_stiffness * (depth - self.thickness)
        return max(force, 0.0)


def foam(
    place: Vector3, normal: Vector3, link: int | None = None, point: Vector3 = (0.0, 0.0, 0.0)
) -> Obstacle:
    """Return a foam cushion: 3 N/mm and 60 N s/m, bottoming at 60 mm (assumed; a seat cushion's order)."""
    return Obstacle(
        place=place, normal=normal, stiffness=3.0e3, damping=60.0, thickness=0.06, bottom_stiffness=5.0e4,
        link=link, point=point,
    )  # fmt: skip


def clamped_hand(
    place: Vector3, normal: Vector3, link: int | None = None, point: Vector3 = (0.0, 0.0, 0.0)
) -> Obstacle:
    """Return a hand against a table: 75 N/mm (ISO/TS 15066:2016, table A.3), 300 N s/m (assumed)."""
    return Obstacle(place=place, normal=normal, stiffness=7.5e4, damping=300.0, link=link, point=point)


class Surroundings:
    """The forces of contacts and obstacles on one arm, step by step.

    After `act`: torque (N,) about the joints (Nm), flange (6,) force and moment that act on the last link,
    about its frame's origin, in the base frame (N, Nm).
    """

    def __init__(self, robot: Robot, contacts: tuple[Contact, ...], obstacles: tuple[Obstacle, ...]) -> None:
        self.torque, self.flange = np.zeros(len(robot.joint)), np.zeros(6)
        self._last = len(robot.joint)
        self._frames = {link: link_frame(robot, link) for link in range(1, self._last + 1)}
        self._contacts = [(contact, contact.link or self._last) for contact in contacts]
        self._obstacles: list[tuple[Obstacle, int, Array]] = []
        for obstacle in obstacles:
            self.add(obstacle)
        self.present = bool(contacts or obstacles)

    def add(self, obstacle: Obstacle) -> None:
        """Put one more obstacle in the way."""
        normal = np.array(obstacle.normal)
        self._obstacles.append((obstacle, obstacle.link or self._last, normal / np.linalg.norm(normal)))
        self.present = True

    def clear(self) -> None:
        """Take all obstacles away; contacts stay."""
        self._obstacles.clear()
        self.present = bool(self._contacts)
        self.torque[:], self.flange[:] = 0.0, 0.0

    def where(self, data: "mujoco.MjData", link: int, point: Vector3) -> Array:
        """Return a point (3,) of a link (DH frame) in the base frame (m); kinematics must be up to date."""
        rotation, origin = self._frames[link]
        local = origin + rotation @ np.array(point)
        return np.asarray(data.xpos[link] + data.xmat[link].reshape(3, 3) @ local)

    def act(self, model: "mujoco.MjModel", data: "mujoco.MjData", time: float) -> None:
        """Work out all forces at this state; needs MuJoCo's position and velocity stage."""
        self.torque[:], self.flange[:] = 0.0, 0.0
        for contact, link in self._contacts:
            strength = contact.strength(time)
            if strength > 0.0:
                force, moment = strength * np.array(contact.force), strength * np.array(contact.moment)
                if contact.frame == "link":
                    turn = data.xmat[link].reshape(3, 3) @ self._frames[link][0]
                    force, moment = turn @ force, turn @ moment
                self._push(model, data, link, self.where(data, link, contact.point), force, moment)
        for obstacle, link, normal in self._obstacles:
            point = self.where(data, link, obstacle.point)
            depth = float(normal @ (np.array(obstacle.place) - point))
            if depth > 0.0:
                size = obstacle.force(depth, -float(normal @ self._speed(model, data, link, point)))
                self._push(model, data, link, point, size * normal, np.zeros(3))

    def _push(
        self,
        model: "mujoco.MjModel",
        data: "mujoco.MjData",
        link: int,
        point: Array,
        force: Array,
        moment: Array,
    ) -> None:
        mujoco.mj_applyFT(model, data, force, moment, point, link, self.torque)
        if link == self._last:
            lever = point - self.where(data, link, (0.0, 0.0, 0.0))
            self.flange[:3] += force
            self.flange[3:] += moment + np.cross(lever, force)

    @staticmethod
    def _speed(model: "mujoco.MjModel", data: "mujoco.MjData", link: int, point: Array) -> Array:
        jacobian = np.zeros((3, model.nv))
        mujoco.mj_jac(model, data, jacobian, None, point, link)
        return np.asarray(jacobian @ data.qvel)
