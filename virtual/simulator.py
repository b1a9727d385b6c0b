"""One virtual arm, stepped by control cycles of 2 ms.

Within a cycle, `substeps` times: servo -> current -> motor torque -> friction and gear -> MuJoCo.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from ..robots import Robot
from ..robots.schema import Vector3
from .assembly import build_of, check_joints, heat_factors, load_body, make_drives, springs
from .command import Command, Position
from .controller import TICK, Controller, Nominal
from .drive import ElasticDrive
from .friction import curves, within
from .model import Build, RigidBody, build_model, link_frame, turned_inertia
from .plant import Plant
from .sensing import Rows, Sensors
from .surroundings import Obstacle, Surroundings

Array = npt.NDArray[np.float64]
SETTLING = 1.0  # s of holding still before time 0
FASTEST = 50.0  # rad/s; whoever gets there has left physics


@dataclass(frozen=True)
class State:
    """What one cycle shows. rtde: what the controller reports, name -> (N,) ((6,) for actual_TCP_force).

    truth: what no sensor of a UR sees, name -> (N,): link_q, link_qd, motor, friction, gear, external
    (see `Rows`), and flange (6,).
    """

    time: float
    rtde: dict[str, Array]
    truth: dict[str, Array]


class Simulator:
    """A robot with its plant, at rest at `start` (N,) (rad, as its encoders read) when time is 0.

    robot: data of N joints. seed: of sensor noise and of everything else that is random.
    Raises InputError when the plant names a joint that the robot lacks, or makes a link impossible; and
    FloatingPointError while stepping, when a joint gets faster than 50 rad/s.
    """

    def __init__(
        self, robot: Robot, plant: Plant | None = None, start: Array | None = None, seed: int = 0
    ) -> None:
        self.robot, self.plant = robot, plant or Plant()
        check_joints(robot, self.plant)
        plant, n = self.plant, len(robot.joint)
        soft = plant.joint_elasticity or plant.backlash
        self._substeps = plant.substeps or (8 if soft else 2)
        self._dt = TICK / self._substeps
        self.time, self._cycle = 0.0, 0
        self._declared: RigidBody | None = None
        self._offset = [0.0] * n
        for encoder in plant.encoder_offset:
            self._offset[encoder.joint - 1] += encoder.offset
        self._build_models()
        joint_curves = curves(robot, plant.friction)
        self._nominal = Nominal(robot, joint_curves, self._believed())
        self._drives = make_drives(
            robot, plant, joint_curves, turned_inertia(self._bare)[1], self._dt, seed, lambda: self.time
        )
        self._elastic = [(k, d) for k, d in enumerate(self._drives) if isinstance(d, ElasticDrive)]
        loose = {backlash.joint - 1 for backlash in plant.backlash}
        self._gaps = [(k, drive) for k, drive in self._elastic if k in loose]
        self._springs, self._heat = springs(plant), heat_factors(plant)
        self._limits = [(a.joint - 1, a.limit) for a in plant.outside.amplifier if a.limit]
        self._around = Surroundings(robot, plant.external_contact, plant.obstacle)
        self.temperature = list(plant.thermal.start[:n])
        self._sensors = Sensors(plant, n, seed)
        q = [0.0] * n if start is None else [float(x) for x in start]
        self._controller = Controller(self._nominal, q)
        self._settle(q)

    def step(self, command: Command) -> State:
        """Apply a command for 2 ms; return what is reported at the start of that cycle.

        (The answer to a command is seen in the next cycle, as on the controller.)
        """
        rows = Rows.of(np.array([self.advance(command)]), len(self.robot.joint))
        truth = ("link_q", "link_qd", "motor", "friction", "gear", "external", "flange")
        measured = self._sensors.measure(rows)
        return State(
            float(rows.time[0]),
            {name: values[0] for name, values in measured.items() if name != "timestamp"},
            {name: getattr(rows, name)[0] for name in truth},
        )

    def measure(self, rows: list[list[float]]) -> tuple[Rows, dict[str, Array]]:
        """Return a block of rows from `advance`, and what the sensors make of it."""
        block = Rows.of(np.array(rows), len(self.robot.joint))
        return block, self._sensors.measure(block)

    def add_obstacle(self, obstacle: Obstacle) -> None:
        """Put something in the way from now on."""
        self._around.add(obstacle)

    def clear_obstacles(self) -> None:
        """Take everything out of the way."""
        self._around.clear()

    def declare(self, load: RigidBody | None) -> None:
        """Tell the controller what hangs at the flange (frame of the last link); nothing is attached."""
        self._declared = load
        self._nominal.load(self.robot, self._believed())

    def where(self, link: int, point: Vector3 = (0.0, 0.0, 0.0)) -> Array:
        """Return a point (3,) of a link (its DH frame, m) in the base frame (m)."""
        mujoco.mj_kinematics(self._model, self._data)
        return self._around.where(self._data, link, point)

    def frame(self, link: int) -> tuple[Array, Array]:
        """Return origin (3,) (m) and rotation (3, 3) of a link's DH frame; the last is the flange."""
        return self.where(link), self._data.xmat[link].reshape(3, 3) @ link_frame(self.robot, link)[0]

    def advance(self, command: Command) -> list[float]:
        """Do one cycle without sensing; return its row, 1 + 15 N + 6 numbers in the order of `Rows`."""
        self._carry()
        q, qd = self._motion()
        control = self._controller
        control.begin(command, q, qd)
        row: list[float] = []
        for substep in range(self._substeps):
            self.time = self._cycle * TICK + substep * self._dt
            if substep:
                q, qd = self._motion()
            currents = control.currents(substep * self._dt, self._dt, q, qd)
            for k, limit in self._limits:
                currents[k] = max(-limit, min(limit, currents[k]))
            link_q, link_qd = self._substep(currents)
            if not substep:
                row = self._row(currents, q, qd, link_q, link_qd)
        self._warm(currents)
        self._cycle += 1
        self.time = self._cycle * TICK
        return row

    def _substep(self, currents: list[float]) -> tuple[list[float], list[float]]:
        """Advance by one substep; return link angles and speeds at its start."""
        model, data, drives = self._model, self._data, self._drives
        q: list[float] = self._qpos.tolist()
        qd: list[float] = self._qvel.tolist()
        torque = [d.torque(i, x, v) for d, i, x, v in zip(drives, currents, q, qd, strict=True)]
        for k, stiffness, rest, constant in self._springs:
            torque[k] += constant - stiffness * (q[k] - rest)
        for k, drive in self._gaps:
            model.dof_armature[k] = drive.armature
        mujoco.mj_step1(model, data)
        self._applied[:] = torque
        if self._around.present:
            self._around.act(model, data, self.time)
            self._applied += self._around.torque
        mujoco.mj_step2(model, data)
        for each, qdd in zip(drives, self._qacc.tolist(), strict=True):
            each.advance(qdd)
        return q, qd

    def _row(
        self,
        currents: list[float],
        q: list[float],
        qd: list[float],
        link_q: list[float],
        link_qd: list[float],
    ) -> list[float]:
        control, drives = self._controller, self._drives
        if not max(qd) - min(qd) < FASTEST:
            raise FloatingPointError(
                f"the simulation left physics at {self.time:.3f} s: joint speeds {qd} rad/s"
            )
        return [
            self.time,
            *[a - b for a, b in zip(q, self._offset, strict=True)],
            *qd,
            *currents,
            *self.temperature,
            *control.q,
            *control.qd,
            *control.qdd,
            *control.current,
            *control.moment,
            *link_q,
            *link_qd,
            *[drive.motor for drive in drives],
            *[drive.friction for drive in drives],
            *[drive.load for drive in drives],
            *self._around.torque.tolist(),
            *self._flange(),
        ]

    def _motion(self) -> tuple[list[float], list[float]]:
        """Return what the encoders read: angles with their offsets, and speeds, of the motors."""
        q: list[float] = self._qpos.tolist()
        qd: list[float] = self._qvel.tolist()
        for k, drive in self._elastic:
            q[k], qd[k] = drive.angle, drive.speed
        return [a + b for a, b in zip(q, self._offset, strict=True)], qd

    def _flange(self) -> list[float]:
        """Return what acts on the last link at the flange: contacts, and a payload that was not declared."""
        wrench = self._around.flange
        payload = self.plant.payload
        if self._held and payload is not None and not payload.declared:
            model, data, last = self._model, self._data, len(self.robot.joint)
            mujoco.mj_rnePostConstraint(model, data)
            # What the flange does to the load, at the arm's centre of mass; the answer, at the flange.
            mx, my, mz, fx, fy, fz = data.cfrc_int[last + 1].tolist()
            x, y, z = (data.subtree_com[1] - data.xpos[last + 1]).tolist()
            load = (-fx, -fy, -fz, z * fy - y * fz - mx, x * fz - z * fx - my, y * fx - x * fy - mz)
            return [a + b for a, b in zip(wrench.tolist(), load, strict=True)]
        return list(wrench.tolist())

    def _warm(self, currents: list[float]) -> None:
        """Warm the joints for one cycle: C dT/dt = friction loss + copper loss + idle - (T - ambient) / R."""
        thermal, temperature = self.plant.thermal, self.temperature
        speeds = self._qvel.tolist()
        for k, drive in enumerate(self._drives):
            loss = abs(drive.friction * speeds[k]) + thermal.winding * currents[k] ** 2 + thermal.idle
            flow = loss - (temperature[k] - thermal.ambient) / thermal.resistance
            temperature[k] += TICK * flow / thermal.capacity
        self._warm_friction()

    def _warm_friction(self) -> None:
        for k, factors in self._heat:
            self._drives[k].heat(*factors(self.temperature[k]))

    def _build_models(self) -> None:
        """Compile the arm without and with its payload."""
        plant = self.plant
        self._bare = build_model(self.robot, build_of(self.robot, plant, False), self._dt)
        loaded = build_of(self.robot, plant, True)
        self._loaded = build_model(self.robot, loaded, self._dt) if plant.payload else self._bare
        always = plant.payload is not None and not plant.payload.intervals
        self._holds = within(plant.payload.intervals) if plant.payload else (lambda _t: False)
        self._always, self._held = always, always or self._holds(0.0)
        self._use(self._loaded if self._held else self._bare)

    def _use(self, model: "mujoco.MjModel") -> None:
        self._model, self._data = model, mujoco.MjData(model)
        self._qpos, self._qvel = self._data.qpos, self._data.qvel
        self._qacc, self._applied = self._data.qacc, self._data.qfrc_applied

    def _carry(self) -> None:
        """Take or leave the payload when its time has come; the controller hears of it if it is declared."""
        payload = self.plant.payload
        if payload is None or self._always or self._holds(self.time) == self._held:
            return
        self._held = not self._held
        q, qd = self._qpos.copy(), self._qvel.copy()
        self._use(self._loaded if self._held else self._bare)
        self._qpos[:], self._qvel[:] = q, qd
        self._arm()
        if payload.declared:
            self._nominal.load(self.robot, self._believed())

    def _believed(self) -> Build:
        payload = self.plant.payload
        if self._declared is not None:
            return Build(load=self._declared)
        return Build(load=load_body(payload) if payload and payload.declared and self._held else None)

    def _arm(self) -> None:
        """Tell MuJoCo the inertia that each drive adds to its link."""
        self._model.dof_armature[:] = [drive.armature for drive in self._drives]

    def _settle(self, q: list[float]) -> None:
        """Hold still until the servo carries everything, then call that time 0."""
        n = len(q)
        self._qpos[:] = [a - b for a, b in zip(q, self._offset, strict=True)]
        motors = self._qpos.tolist()
        for _ in range(3):  # gravity where the links hang, and links where gravity takes them
            mujoco.mj_forward(self._model, self._data)
            for k, drive in self._elastic:
                self._qpos[k] = drive.place(motors[k], float(self._data.qfrc_bias[k]))
        self._arm()
        warm, hold = list(self.temperature), Position(tuple(q), (0.0,) * n, (0.0,) * n)
        present, self._around.present = self._around.present, False
        self._warm_friction()
        for _ in range(round(SETTLING / TICK)):
            self.time, self._cycle = 0.0, 0
            self.advance(hold)
            self.temperature = list(warm)
        self.time, self._cycle, self._around.present = 0.0, 0, present
