"""What an effect of the catalogue is: the physics, and what a lab engineer needs to know about it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from ..terms import CATALOGUE, Parameter
from ..terms.forms import equation as term_equation


@dataclass(frozen=True)
class Effect:
    """An effect by its name in findings.

    title: in plain words. terms: names of the catalogue's terms that it is modelled with; none where it
    changes the rigid body or the measurement. scope: "joint" where it sits on single joints, "all" where one
    cause moves all joints at once. source: paper or data sheet. signature: how it shows in the residual.
    rivals: effects that look like it. motion: what would show it. remedy: what to do about it in the cell.
    written: LaTeX, and own: parameters, where no term has them.
    """

    name: str
    title: str
    terms: tuple[str, ...]
    scope: Literal["joint", "all"]
    source: str
    signature: str
    rivals: tuple[str, ...]
    motion: str
    remedy: str
    written: str = ""
    own: Mapping[str, Parameter] = field(default_factory=dict)

    @property
    def equation(self) -> str:
        """Return the torque in Nm as LaTeX, printed from the terms' SymPy expressions where there are any."""
        if self.written:
            return self.written
        return r";\quad ".join(term_equation(CATALOGUE[name]) for name in self.terms)

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """Return what is identified, each with its unit and plausible range."""
        found = dict(self.own)
        for name in self.terms:
            found |= {n: p for n, p in CATALOGUE[name].parameters.items() if p.plausible is not None}
        return found
