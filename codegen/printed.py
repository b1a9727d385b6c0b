"""Printed functions, as the templates want them."""

from dataclasses import dataclass

from .languages import Body
from .listing import Listing

_SUMMARY = {
    "step": "A sample: momentum (Nm s), beta (Nm), friction (Nm) and the states after it.",
    "core": "Momentum (Nm s), beta (Nm) and friction (Nm) in one go: what the observer needs.",
    "momentum_and_beta": "Momentum (Nm s) and beta (Nm).",
    "momentum": "Momentum p = M(q) qd, Nm s.",
    "beta": "beta = C^T qd - g = d(T - V)/dq, Nm.",
    "mass_matrix": "Mass matrix with rotors, row by row, kg m^2.",
    "gravity": "Gravity torque g = dV/dq, Nm.",
    "inverse_dynamics": "Rigid-body torque with rotors, without friction, Nm; qdd in rad/s^2.",
    "friction": "Torque of the friction and drive terms, Nm; load: carried torque, Nm; temperature in deg C.",
    "energy": "Kinetic and potential energy, J.",
}
_MEMORY = """    dt: seconds from the sample before to each sample, a number or (T,). With it the axis before
    the last is time, and the terms that remember are updated along it from a start without memory. Without
    it they are those of a motion that goes on as it is: nothing.
    carried: what they take as the torque that the joints carry, Nm; by default the momentum's change
    less beta.
    """
_PUBLIC = ("momentum", "beta", "mass_matrix", "gravity", "inverse_dynamics", "friction", "energy")


@dataclass(frozen=True)
class Function:
    """A printed function, as the templates want it."""

    name: str
    body: Body
    listing: Listing

    @property
    def summary(self) -> str:
        """One line on what it returns; nothing for what is internal to NumPy."""
        return _SUMMARY.get(self.name, "")

    @property
    def public(self) -> str:
        """Its name in NumPy, or nothing when it is internal."""
        return self.name if self.name in _PUBLIC else ""

    @property
    def flat(self) -> list[str]:
        """All results, one after another."""
        return [text for texts in self.body.outputs.values() for text in texts]

    @property
    def arguments(self) -> list[str]:
        """The scalars that the function really uses."""
        return [name for name, _, _ in self.body.inputs]


@dataclass(frozen=True)
class NumpyFunction(Function):
    """What the NumPy template needs on top. remembers: whether the model has terms with state."""

    remembers: bool = False

    @property
    def input_names(self) -> list[str]:
        """Array arguments."""
        return list(self.listing.inputs)

    @property
    def used(self) -> str:
        """(Which array, which column) of each scalar."""
        return str([(self.input_names.index(array), element) for _, array, element in self.body.inputs])

    @property
    def matrix(self) -> bool:
        """Whether the result is N x N."""
        return self.name == "mass_matrix"

    @property
    def public_arguments(self) -> list[str]:
        """Arguments after q, with defaults."""
        defaults = {"load": "load=None", "temperature": "temperature=None"}
        found = [defaults.get(x, x) for x in self.input_names if x != "q"]
        return [*found, "dt=None", "carried=None"] if self.along_time else found

    @property
    def along_time(self) -> bool:
        """Whether it can be evaluated along time, with terms that remember."""
        return self.remembers and self.name == "friction"

    @property
    def split(self) -> str:
        """How several results are handed out."""
        return "values[..., 0], values[..., 1]" if self.name == "energy" else ""

    @property
    def doc(self) -> str:
        """Docstring."""
        shape = "(..., N, N)" if self.matrix else "each (...)" if self.split else "(..., N)"
        text = f"{self.summary} Returns {shape}."
        return f"{text}\n\n{_MEMORY}" if self.along_time else text

    @property
    def defaults(self) -> list[str]:
        """Lines that fill in what was not given."""
        lines = []
        if "load" in self.input_names:
            lines.append("load = gravity(q) if load is None else load")
        if "temperature" in self.input_names:
            lines.append("temperature = REFERENCE_TEMPERATURE if temperature is None else temperature")
        return lines


@dataclass(frozen=True)
class CFunction(Function):
    """What the C templates need on top."""

    upper: str = ""

    @property
    def c_parameters(self) -> list[str]:
        """Parameters: inputs, then results."""
        sizes = {"state": f"{self.upper}_STATES", "clock": "2"}
        inputs = [f"const double {x}[{sizes.get(x, f'{self.upper}_DOF')}]" for x in self.listing.inputs]
        results = [f"double {x}[{len(indices)}]" for x, (_, indices) in self.listing.outputs.items()]
        return inputs + results

    @property
    def unused(self) -> list[str]:
        """Inputs that this model does not need."""
        used = {array for _, array, _ in self.body.inputs}
        return [x for x in self.listing.inputs if x not in used]

    @property
    def assignments(self) -> list[tuple[str, str]]:
        """(element, text) of each result."""
        return [(f"{x}[{k}]", text) for x, texts in self.body.outputs.items() for k, text in enumerate(texts)]
