"""What one may choose of the generated URScript."""

from dataclasses import dataclass

from ..errors import InputError
from ..urscript import Version
from .motion import Motion

CURRENT_SOURCES = ("modbus", "rtde")
REACTIONS = ("hold", "freedrive", "retract")
DETECTORS = ("static", "speed", "cusum", "velocity", "vote")
BIASES = ("check", "subtract")
#: Resume inputs: kind -> (first number, last number, function of the script manual).
RESUME = {
    "register": (64, 127, "read_input_boolean_register"),
    "digital": (0, 7, "get_standard_digital_in"),
}
#: First PolyScope versions with get_rtde_value, 5 and X (URScript_Examples; absent from the manual 5.11).
RTDE_VALUE = ("5.23", "10.10")


@dataclass(frozen=True)
class Options:
    """What gen-model lets one choose of the program that guards; the defaults are the command's.

    current_source: "modbus" or "rtde". reaction: "hold", "freedrive" or "retract". detector: "static",
    "speed", "cusum", "velocity" or "vote". polyscope: target version, empty for 5.11, or 5.23 with rtde.
    resume: "register:64..127" (boolean input) or "digital:0..7". payload: mass at the flange that the
    model knows of, kg. bias: what becomes of the residual measured at rest, "check" or "subtract".
    motion: the user's, or None. Raises InputError where they do not go together.
    """

    current_source: str = "modbus"
    reaction: str = "freedrive"
    detector: str = "speed"
    polyscope: str = ""
    resume: str = "register:64"
    payload: float = 0.0
    bias: str = "check"
    motion: Motion | None = None

    def __post_init__(self) -> None:
        for name, allowed in (
            ("current_source", CURRENT_SOURCES),
            ("reaction", REACTIONS),
            ("detector", DETECTORS),
            ("bias", BIASES),
        ):
            if getattr(self, name) not in allowed:
                option = name.replace("_", "-")
                raise InputError(f"--{option} {getattr(self, name)}: give one of {', '.join(allowed)}")
        if not 0 <= self.payload < 100:
            raise InputError(f"--payload {self.payload:g}: give the mass at the flange in kg, 0 to 100")
        version = self.version
        if self.current_source == "rtde" and not version.reached(*RTDE_VALUE):
            raise InputError(
                f"--current-source rtde: PolyScope {self.polyscope} has no get_rtde_value; "
                f"use modbus, or --polyscope {RTDE_VALUE[0]} or {RTDE_VALUE[1]} and newer"
            )
        _ = self.resume_input

    @property
    def target(self) -> str:
        """PolyScope version that the program is written for."""
        return self.polyscope or ("5.23" if self.current_source == "rtde" else "5.11")

    @property
    def version(self) -> Version:
        """The same, to compare with."""
        try:
            return Version.parse(self.target)
        except InputError as error:
            raise InputError(f"--polyscope: {error}") from None

    @property
    def resume_input(self) -> str:
        """The call that reads the resume input."""
        kind, _, number = self.resume.partition(":")
        first, last, function = RESUME.get(kind, (0, -1, ""))
        if not number.isdecimal() or not first <= int(number) <= last:
            raise InputError(
                f"--resume {self.resume}: give register:64 to register:127 (boolean input register) "
                "or digital:0 to digital:7 (standard input)"
            )
        return f"{function}({int(number)})"
