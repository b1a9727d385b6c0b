"""The rigid-body part of the virtual robot: a MuJoCo model built from robot data.

MjSpec and not MJCF text: numbers go in as doubles, there is no string pasting, and a wrong value fails
with the name of its body. Nothing here is shared with the symbolic derivation: this is the check on it.
"""

from dataclasses import dataclass, field

import mujoco
import numpy as np
import numpy.typing as npt

from ..robots import Robot

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class RigidBody:
    """A body as ten numbers: mass (kg), centre of mass (3,) (m), inertia about it (3, 3) (kg m^2)."""

    mass: float
    centre_of_mass: Array
    inertia: Array


@dataclass(frozen=True)
class Build:
    """What may differ from the robot file when a model is built.

    links: link number 1..N -> its body in the DH link frame, instead of the robot file's.
    load: a body at the flange (frame of the last link). gravity: (3,) m/s^2 in the base frame.
    """

    links: dict[int, RigidBody] = field(default_factory=dict)
    load: RigidBody | None = None
    gravity: Array | None = None


def symmetric(values: tuple[float, float, float, float, float, float]) -> Array:
    """Return the (3, 3) tensor of xx, yy, zz, xy, xz, yz."""
    xx, yy, zz, xy, xz, yz = values
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def link_body(robot: Robot, link: int) -> RigidBody:
    """Return link 1..N of a robot file as a rigid body in its DH frame."""
    joint = robot.joint[link - 1]
    return RigidBody(joint.mass, np.array(joint.centre_of_mass), symmetric(joint.inertia))


def link_frame(robot: Robot, link: int) -> tuple[Array, Array]:
    """Return rotation (3, 3) and origin (3,) of DH frame `link` in MuJoCo's body `link`.

    MuJoCo turns a body about an axis through its own origin, so body i sits at DH frame i-1 and turns
    with q_i; frame i = Rz(offset) Tz(d) Tx(a) Rx(alpha) is then fixed in it.
    """
    joint = robot.joint[link - 1]
    turn, twist = _turn("z", joint.offset), _turn("x", joint.alpha)
    return turn @ twist, turn @ np.array([joint.a, 0.0, joint.d])


def build_model(robot: Robot, build: Build | None = None, timestep: float = 0.001) -> "mujoco.MjModel":
    """Return a MuJoCo model of N hinges with full link inertias and reflected rotor inertias.

    Contacts and constraints are off: forces of the environment are laws of this package. Body `link_i`
    carries link i, body `load` (if any) what is attached at the flange. Integrator: semi-implicit Euler.
    """
    build = build or Build()
    spec = mujoco.MjSpec()
    spec.option.timestep = timestep
    spec.option.gravity = robot.gravity if build.gravity is None else build.gravity
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    spec.option.disableflags = mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_CONTACT
    parent, rotation, origin = spec.worldbody, np.eye(3), np.zeros(3)
    for link, joint in enumerate(robot.joint, start=1):
        parent = parent.add_body(name=f"link_{link}", pos=origin, quat=_quaternion(rotation))
        parent.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1], armature=joint.reflected_inertia)
        rotation, origin = link_frame(robot, link)
        _give_inertia(parent, build.links.get(link) or link_body(robot, link), rotation, origin)
    if build.load is not None:
        load = parent.add_body(name="load", pos=origin, quat=_quaternion(rotation))
        _give_inertia(load, build.load, np.eye(3), np.zeros(3))
    return spec.compile()


def impossible(inertia: Array) -> str | None:
    """Return why no body has this inertia (3, 3), kg m^2, or None when there are such bodies."""
    low, middle, high = np.linalg.eigvalsh(inertia)
    if low < -1e-9:
        return f"a principal moment of inertia is negative ({low:.4g} kg m^2)"
    if low + middle < high - 1e-9:
        return f"principal moments {low:.4g}, {middle:.4g}, {high:.4g} kg m^2 break the triangle inequality"
    return None


def turned_inertia(model: "mujoco.MjModel") -> tuple[Array, Array]:
    """Return what joints turn, over random poses: two arrays (N,), kg m^2.

    The median of M_ii, rotors included; and the least effective inertia 1 / (M^-1)_ii of the links alone,
    with all other joints free.
    """
    data, rng = mujoco.MjData(model), np.random.default_rng(0)
    whole, links = [], []
    for _ in range(64):
        data.qpos[:] = rng.uniform(-np.pi, np.pi, model.nv)
        mujoco.mj_forward(model, data)
        full = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
        whole.append(np.diag(full))
        links.append(1.0 / np.diag(np.linalg.inv(full - np.diag(model.dof_armature))))
    return np.median(whole, axis=0), np.min(links, axis=0)


def tilted_gravity(gravity: tuple[float, float, float], roll: float, pitch: float) -> Array:
    """Return gravity (3,) seen from a base that is turned by roll about x, then pitch about y (rad)."""
    base = _turn("y", pitch) @ _turn("x", roll)
    return np.asarray(base.T @ np.array(gravity))


def _give_inertia(body: "mujoco.MjsBody", rigid: RigidBody, rotation: Array, origin: Array) -> None:
    """Set mass, centre of mass and full inertia, given in a frame (rotation, origin) of the body."""
    moments, axes = np.linalg.eigh(rotation @ rigid.inertia @ rotation.T)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] = -axes[:, 0]
    body.explicitinertial = True
    body.mass = rigid.mass
    body.ipos = origin + rotation @ rigid.centre_of_mass
    body.inertia, body.iquat = np.maximum(moments, 0.0), _quaternion(axes)  # fullinertia refuses point masses


def _turn(axis: str, angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    if axis == "x":
        return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    if axis == "y":
        return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])


def _quaternion(rotation: Array) -> Array:
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, rotation.ravel())
    return quaternion
