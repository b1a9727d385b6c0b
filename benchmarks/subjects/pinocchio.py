"""Pinocchio, from C++ and from Python, built from the same robot data in DH link frames."""

import ctypes
import importlib
import time
from pathlib import Path
from types import ModuleType

import numpy as np

from residuum.robots import Robot

from .native import CMEEL, Loop, compile_library, eigen_folder
from .subject import Array, States, Subject, Unavailable

SOURCE = Path(__file__).with_name("pinocchio_native.cpp")
FLAGS = (
    "-std=c++17",
    "-DNDEBUG",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
)


def package() -> ModuleType:
    """Return the module of the wheel `pin`."""
    try:
        return importlib.import_module("pinocchio")
    except ImportError:
        raise Unavailable("Pinocchio is not installed: pip install pin") from None


def library(folder: Path) -> ctypes.CDLL:
    """Compile the C++ functions against the wheel's headers."""
    package()
    if not (CMEEL / "include" / "pinocchio").is_dir():
        raise Unavailable("the installed Pinocchio carries no C++ headers")
    include = [f"-I{CMEEL / 'include'}", f"-I{eigen_folder()}"]
    where = CMEEL / "lib"
    link = [f"-L{where}", f"-Wl,-rpath,{where}", "-lpinocchio_default"]
    return compile_library(SOURCE, folder / "pinocchio.so", [*FLAGS, *include], link)


def native(robot: Robot, dof: int, compiled: ctypes.CDLL, loop: Loop) -> list[Subject]:
    """Return Pinocchio's C++: through its matrices, and through derivatives of its inverse dynamics."""
    dh = [[j.a, j.d, j.alpha, j.offset] for j in robot.joint]
    bodies = [[j.mass, *j.centre_of_mass, *j.inertia] for j in robot.joint]
    armature = [j.reflected_inertia for j in robot.joint[:dof]]
    arrays = [np.array(x, dtype=float) for x in (dh, bodies, armature, robot.gravity)]
    compiled.build(dof, len(robot.joint), *(x.ctypes.data_as(ctypes.c_void_p) for x in arrays))
    return [
        loop.subject("Pinocchio C++, crba + Coriolis matrix + gravity", compiled, f"matrices_{dof}"),
        loop.subject("Pinocchio C++, RNEA derivatives + gravity", compiled, f"derivatives_{dof}"),
    ]


def python(robot: Robot, dof: int) -> list[Subject]:
    """Return Pinocchio called from Python, sample by sample."""
    pin = package()
    model = python_model(pin, robot, dof)
    data = model.createData()

    def evaluate(states: States) -> tuple[Array, Array]:
        momentum, beta = np.empty_like(states.q), np.empty_like(states.q)
        for k, (q, qd) in enumerate(zip(*states, strict=True)):
            momentum[k] = pin.crba(model, data, q) @ qd
            coriolis = pin.computeCoriolisMatrix(model, data, q, qd)
            beta[k] = coriolis.T @ qd - pin.computeGeneralizedGravity(model, data, q)
        return momentum, beta

    def time_it(states: States) -> float:
        some = States(states.q[:1000], states.qd[:1000])
        start = time.thread_time_ns()
        evaluate(some)
        return (time.thread_time_ns() - start) / len(some.q)

    return [Subject("Pinocchio from Python, crba + Coriolis matrix + gravity", "python", evaluate, time_it)]


def python_model(pin: ModuleType, robot: Robot, dof: int) -> object:
    """Return the arm as Pinocchio's model; joints beyond `dof` are rigid at zero angle, with their mass."""
    model, parent, frame = pin.Model(), 0, pin.SE3.Identity()
    model.gravity.linear = np.array(robot.gravity)
    for number, joint in enumerate(robot.joint, start=1):
        if number <= dof:
            parent = model.addJoint(parent, pin.JointModelRZ(), frame, f"joint_{number}")
            frame = pin.SE3.Identity()
        turn = pin.utils.rotate("z", joint.offset)
        twist = pin.utils.rotate("x", joint.alpha)
        frame = frame * pin.SE3(turn @ twist, turn @ np.array([joint.a, 0, joint.d]))
        xx, yy, zz, xy, xz, yz = joint.inertia
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        model.appendBodyToJoint(
            parent, pin.Inertia(joint.mass, np.array(joint.centre_of_mass), tensor), frame
        )
    model.armature = np.array([joint.reflected_inertia for joint in robot.joint[:dof]])
    return model
