"""The controller without its sockets: arm, programs, registers and messages, one tick per 2 ms."""

from collections.abc import Callable, Mapping

from ...robots import Robot
from ...urscript import Dialect
from ..plant import Plant
from .arm import HOME, IDLE, POWER_OFF, RUNNING, Arm
from .primary import ErrorCode, Key, Message, Mode, Text, encode, robot_state
from .programs import Programs
from .session import Owners, Session
from .snapshot import Snapshot
from .world import RobotWorld

VERSIONS = {"5.21": (5, 21, 0, 0), "5.25.1": (5, 25, 1, 0)}
"""PolyScope versions that can be imitated -> what RTDE answers to a request for the version."""

_BIT_GROUPS = {"standard_digital_output": "standard", "configurable_digital_output": "configurable",
               "tool_digital_output": "tool"}  # fmt: skip


class Controller:
    """One robot and its control box.

    version: a key of VERSIONS. say: takes one line for the operator now and then.
    Raises InputError as `Simulator` does.
    """

    def __init__(
        self,
        robot: Robot,
        plant: Plant | None = None,
        version: str = "5.21",
        start: tuple[float, ...] = HOME,
        seed: int = 0,
        say: Callable[[str], None] = lambda _line: None,
    ) -> None:
        self.version, self.robot, self.say = VERSIONS[version], robot, say
        self.arm = Arm(robot, plant or Plant(), start, seed)
        self.arm.alarm = self._alarm
        self.messages: list[Message] = []
        self.world = RobotWorld(self.arm, self.version, lambda text: self.announce(Text(text)))
        major, minor = self.version[:2]
        self.programs = Programs(self.world, Dialect(version=f"{major}.{minor}"), self.announce)
        self.loaded = ""
        self._owners: Owners = {}
        self._written: dict[str, float] = {}
        self.snapshot = self.world.snapshot = self._look()

    def tick(self) -> Snapshot:
        """Let 2 ms pass; return what the controller tells of them."""
        if self.world.watchdogs:
            self._check_watchdogs()
        self.programs.frame()
        self.arm.tick()
        self.world.snapshot, self.snapshot = self.snapshot, self._look()
        return self.snapshot

    def session(self) -> Session:
        """Return the state of a new RTDE connection."""
        return Session(self.version, self._owners, self._receive)

    def announce(self, message: Message) -> None:
        """Tell the clients of the primary interface, and the operator what matters."""
        self.messages.append(message)
        if not isinstance(message, Text):
            self.say(_spoken(message))

    def take_messages(self) -> bytes:
        """Return the messages since the last call, encoded."""
        if not self.messages:
            return b""
        waiting, self.messages = self.messages, []
        return b"".join(encode(message, self.arm.time) for message in waiting)

    def power(self, on: bool) -> None:
        """Switch the motors off, or the box on; brakes are released apart."""
        if not on:
            self.programs.stop()
        self.arm.mode = IDLE if on and self.arm.mode == POWER_OFF else self.arm.mode if on else POWER_OFF

    def release_brakes(self) -> None:
        """Make the robot ready to run."""
        self.arm.mode = RUNNING

    def robot_state(self) -> bytes:
        """Return the robot state of the primary interface."""
        arm, program = self.arm, self.programs.state
        mode = Mode(
            arm.powered, arm.protective_stop, program == "playing", program == "paused", arm.mode, arm.rate
        )
        names = ("actual_q", "target_q", "actual_qd", "actual_current")
        columns = [arm.state.rtde[name].tolist() for name in names]
        heat = arm.state.rtde["joint_temperatures"].tolist()
        joints = [(*row, 48.0, t) for *row, t in zip(*columns, heat, strict=True)]
        return robot_state(mode, joints, (*self.snapshot.value("actual_TCP_pose"), *arm.tcp), arm.time)

    def _look(self) -> Snapshot:
        arm, world = self.arm, self.world
        analog = world.analog[0], world.analog[1]
        return Snapshot(
            arm.time, arm.state, arm, arm.mode, arm.protective_stop, self.programs.state,
            dict(world.inputs), dict(world.outputs), dict(world.digital), analog,
        )  # fmt: skip

    def _alarm(self, reason: str) -> None:
        self.announce(ErrorCode(153, 0, f"Protective stop: {reason}"))
        self.programs.stop()

    def _check_watchdogs(self) -> None:
        for name, (frequency, action) in list(self.world.watchdogs.items()):
            last = self._written.setdefault(name, self.arm.time)
            if self.arm.time - last > 1.0 / frequency:
                del self.world.watchdogs[name]
                self.announce(ErrorCode(0, 0, f"RTDE watchdog of {name}: {action}"))
                self.programs.stop() if action == "stop" else self.programs.pause()

    def _receive(self, values: Mapping[str, tuple[float, ...]]) -> None:
        """Take what an RTDE client sets."""
        world = self.world
        for name, numbers in values.items():
            self._written[name] = self.arm.time
            kind, _, number = name.removeprefix("input_").partition("_register_")
            if name.startswith("input_bit_registers"):
                first, bits = int(name.split("registers")[1].split("_")[0]), int(numbers[0])
                world.inputs |= {("boolean", first + i): bool(bits >> i & 1) for i in range(32)}
            elif number:
                sort = {"int": "integer", "double": "float", "bit": "boolean"}[kind]
                world.inputs[sort, int(number)] = numbers[0]
        for name, group in _BIT_GROUPS.items():
            mask, bits = (int(values.get(key, (0,))[0]) for key in (f"{name}_mask", name))
            world.digital |= {(group, i): bool(bits >> i & 1) for i in range(8) if mask >> i & 1}
        self._receive_scales(values)

    def _receive_scales(self, values: Mapping[str, tuple[float, ...]]) -> None:
        if values.get("speed_slider_mask", (0,))[0] and "speed_slider_fraction" in values:
            self.arm.speed_fraction = min(max(values["speed_slider_fraction"][0], 0.0), 1.0)
        mask = int(values.get("standard_analog_output_mask", (0,))[0])
        for i in range(2):
            if mask >> i & 1 and f"standard_analog_output_{i}" in values:
                self.world.analog[i] = min(max(values[f"standard_analog_output_{i}"][0], 0.0), 1.0)


def _spoken(message: Message) -> str:
    if isinstance(message, Key):
        return f"program {message.program} {message.event.lower()}"
    if isinstance(message, ErrorCode):
        return f"C{message.code}A{message.argument}: {message.text}"
    line, column = getattr(message, "line", 0), getattr(message, "column", 0)
    return f"line {line}, column {column}: {getattr(message, 'text', '')}"
