"""A robot that moves as a recording did."""

# ruff: noqa: D102 - a method do_NAME is the instruction NAME of the script manual

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import Fault
from .values import Array, Value, from_python
from .world import IdleWorld

JOINTS = 6
ANGLE, SPEED, CURRENT = 270, 280, 290
"""First port registers of the joints: mrad, mrad/s, mA (UR article 16377, Modbus server)."""
ROOM = 30.0
"""Joint temperature in deg C where none was recorded."""


class RecordedWorld(IdleWorld):
    """Replays joint positions, speeds and currents, one row a frame; the last row stays.

    Args:
        q: positions (T, 6) in rad.
        qd: speeds (T, 6) in rad/s.
        current: motor currents (T, 6) in A.
        encoding: how a negative port register appears. The script manual says signed, the Modbus article
            unsigned; a program should accept both.
        rtde: further RTDE fields by name, a row or a value a frame; target_qd and joint_temperatures also
            answer get_target_joint_speeds and get_joint_temp.

    Raises:
        ValueError: shapes do not agree.

    """

    def __init__(
        self,
        q: ArrayLike,
        qd: ArrayLike,
        current: ArrayLike,
        encoding: Literal["signed", "unsigned"] = "signed",
        rtde: Mapping[str, ArrayLike] | None = None,
    ) -> None:
        super().__init__()
        arrays = [np.asarray(a, dtype=float) for a in (q, qd, current)]
        if any(a.ndim != 2 or a.shape != (len(arrays[0]), JOINTS) or not len(a) for a in arrays):
            raise ValueError(f"q, qd and current must be (T, 6), got {[a.shape for a in arrays]}")
        self._q, self._qd, self._current = arrays
        self._encoding = encoding
        fields = dict(zip(("actual_q", "actual_qd", "actual_current"), arrays, strict=True))
        fields |= {"target_qd": np.zeros((1, JOINTS)), "joint_temperatures": np.full((1, JOINTS), ROOM)}
        self._rtde = {**fields, **{name: np.asarray(value) for name, value in (rtde or {}).items()}}

    @property
    def ended(self) -> bool:
        """Whether the last row has been shown."""
        return self.frame >= len(self._q)

    def _row(self, rows: NDArray[np.float64], back: int = 0) -> Value:
        index = min(max(self.frame - back, 0), len(rows) - 1)
        return from_python(rows[index])

    def do_get_actual_joint_positions(self) -> Value:  # type: ignore[override]
        return self._row(self._q)

    def do_get_actual_joint_speeds(self) -> Value:  # type: ignore[override]
        return self._row(self._qd)

    def do_get_target_joint_speeds(self) -> Value:  # type: ignore[override]
        return self._row(self._rtde["target_qd"])

    def do_get_joint_temp(self, j: Value) -> float:
        if isinstance(j, bool) or not isinstance(j, int) or not 0 <= j < JOINTS:
            raise Fault("get_joint_temp takes a joint from 0 to 5", "domain")
        row = self._row(self._rtde["joint_temperatures"])
        assert isinstance(row, Array)
        return float(row[j])

    def do_get_actual_joint_positions_history(self, steps: Value) -> Value:
        if isinstance(steps, bool) or not isinstance(steps, int) or steps < 0:
            raise Fault("get_actual_joint_positions_history counts steps from 0", "domain")
        return self._row(self._q, steps)

    def do_read_port_register(self, address: Value) -> int:
        """Give registers of the joints as whole numbers of 16 bits."""
        tables = {ANGLE: (self._q, 1e3), SPEED: (self._qd, 1e3), CURRENT: (self._current, 1e3)}
        for first, (rows, scale) in tables.items():
            if isinstance(address, int) and first <= address < first + JOINTS:
                return self._encoded(self._row(rows), address - first, scale)
        raise Fault(f"port register {address} is not simulated", "address")

    def _encoded(self, row: Value, joint: int, scale: float) -> int:
        assert isinstance(row, Array)
        value: int = min(max(round(row[joint] * scale), -(2**15)), 2**15 - 1)
        return value % 2**16 if self._encoding == "unsigned" else value

    def do_get_rtde_value(self, key: Value) -> Value:
        """Give the field as it was one step ago (script manual 5.25)."""
        if key not in self._rtde:
            raise Fault(f"get_rtde_value: no field {key!r}", "rtde-field")
        return self._row(self._rtde[str(key)], back=1)
