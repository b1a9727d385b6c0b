"""What newer controllers tell of their own dynamic model: MuJoCo's, of the robot file."""

import mujoco
import numpy as np
import numpy.typing as npt

from ...robots import Robot
from ..model import build_model

Array = npt.NDArray[np.float64]


class Dynamics:
    """Nominal dynamics of one robot, without payload."""

    def __init__(self, robot: Robot) -> None:
        self._model = build_model(robot)
        self._data = mujoco.MjData(self._model)
        self._rotors = np.array([joint.reflected_inertia for joint in robot.joint])

    def mass_matrix(self, q: Array, rotors: bool) -> Array:
        """Return (N, N) kg m^2 at angles (N,) rad, with or without reflected rotor inertia."""
        self._set(q, np.zeros_like(q))
        full = np.zeros((len(q), len(q)))
        mujoco.mj_fullM(self._model, self._data, full)
        return full if rotors else full - np.diag(self._rotors)

    def coriolis(self, q: Array, qd: Array) -> Array:
        """Return Coriolis and centrifugal torques (N,) Nm."""
        self._set(q, np.zeros_like(q))
        still = self._data.qfrc_bias.copy()
        self._set(q, qd)
        return np.asarray(self._data.qfrc_bias - still)

    def _set(self, q: Array, qd: Array) -> None:
        self._data.qpos[:], self._data.qvel[:] = q, qd
        mujoco.mj_forward(self._model, self._data)
