"""The refined model: published or referenced rigid body, Coulomb and viscous friction, and what was found."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..identify.physical import project
from ..robots import Robot
from ..robots.model import Covariance, Model, TermData
from ..symbolic.terms import CATALOGUE
from ..symbolic.tilt import tilted
from .candidates import Candidate
from .columns import BASELINE, DELAYS, LATE, WINDUP, Space
from .evidence import Evidence
from .handed import handed, moved
from .judging import Accepted
from .physics import of_links
from .selection import Directions, normal_equations

Array = NDArray[np.float64]

#: rad/s; width of the smooth sign in the model: sharp, and above the noise of a speed at rest.
_WIDTH = 2e-3
_DIGITS = 10


def refined(
    evidence: Evidence, nominal: Model, robot: Robot, accepted: Sequence[Accepted],
    shapes: Sequence[Candidate], values: Mapping[int, Mapping[str, float]],
) -> Model:  # fmt: skip
    """Return the model of the observed robot with everything that was found in it.

    shapes: of the healthy robot's friction. values: by position in `accepted`, nonlinear values that replace
    those of the grid.
    """
    evidence, space = _in_full(evidence), evidence.setup.space
    held = [a for a in accepted if a.score.candidate.effect != "dropped_coupling"]
    directions = handed(evidence, held, shapes)
    used = moved(evidence, directions)
    theta, spread = _fit(evidence, directions, used)
    full = np.zeros(space.size)
    full[used] = theta
    base = {
        n: nominal.base[n].model_copy(
            update={
                "value": _short(theta[k]),
                "std": _short(float(np.sqrt(spread[k, k]))),
                "source": "explain",
            }
        )
        for k, n in enumerate(space.base)
    }
    terms = _terms(
        evidence,
        accepted,
        shapes,
        values,
        full,
        {int(u): float(np.sqrt(spread[k, k])) for k, u in enumerate(used)},
    )
    names = _distinct([*space.base, *(_name(evidence, int(u)) for u in used[len(space.base) :])])
    rows = tuple(" ".join(f"{x:.8g}" for x in row[: k + 1]) for k, row in enumerate(spread))
    changed = nominal.model_copy(
        update={
            "base": base, "term": terms, "covariance": Covariance(names=tuple(names), rows=rows),
            "source": nominal.source | {"explain": "residuum explain; findings.json says what was added"},
        }
    )  # fmt: skip
    return _geometry(changed, robot, accepted)


def _in_full(evidence: Evidence) -> Evidence:
    """Return the evidence about a prior mean that drops no coupling: the refined model is the full one."""
    setup = evidence.setup
    return replace(evidence, setup=replace(setup, lacking=tuple(x for x in setup.lacking if not x.nominal)))


def _short(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def _fit(evidence: Evidence, directions: Directions, used: NDArray[np.int64]) -> tuple[Array, Array]:
    """Fit and make physical; return the used parameters on the observed side and their covariance."""
    a, r = normal_equations(evidence.sums, directions, evidence.sums.total)
    inverse = np.linalg.inv(a + np.diag(1 / directions.std**2))
    picked = directions.vectors[used].toarray()
    theta = evidence.mean[used] + picked @ (inverse @ r)
    spread = picked @ inverse @ picked.T
    positive = [
        k for k, u in enumerate(used) if _column(evidence, int(u)) in (("coulomb", "Fc"), ("viscous", "Fv"))
    ]
    # the rest follows what is held to physics as their covariance says: columns of friction are nearly alike,
    # and a cone program of all of them is ill-conditioned
    held = [*range(len(evidence.setup.space.base)), *positive]
    own = spread[np.ix_(held, held)]
    information = np.linalg.inv(own + 1e-12 * np.diag(np.diag(own)))
    first = len(held) - len(positive)
    nearest, _ = project(
        theta[held], (information + information.T) / 2, evidence.setup.physics.map, range(first, len(held))
    )
    change = nearest - theta[held]
    theta = theta + spread[:, held] @ (information @ change)
    theta[held] = nearest
    return theta, (spread + spread.T) / 2


def _column(evidence: Evidence, index: int) -> tuple[str, str] | None:
    space = evidence.setup.space
    b, k = len(space.base), len(space.own)
    if not b <= index < b + space.dof * k:
        return None
    c = space.own[(index - b) % k]
    return c.term, c.parameter


def _distinct(names: Sequence[str]) -> list[str]:
    """Return names, numbered where they come back: a term has one entry for each of its nonlinear values."""
    seen = Counter[str]()
    found = []
    for n in names:
        seen[n] += 1
        found.append(n if seen[n] == 1 else f"{n}_{seen[n]}")
    return found


def _name(evidence: Evidence, index: int) -> str:
    space = evidence.setup.space
    b, k = len(space.base), len(space.own)
    if index < b + space.dof * k:
        c = space.own[(index - b) % k]
        return f"{c.term}{(index - b) // k + 1}_{c.parameter}"
    return space.common[index - b - space.dof * k]


def _terms(
    evidence: Evidence, accepted: Sequence[Accepted], shapes: Sequence[Candidate],
    values: Mapping[int, Mapping[str, float]], full: Array, std: Mapping[int, float],
) -> tuple[TermData, ...]:  # fmt: skip
    space = evidence.setup.space
    found = dict[object, TermData]()

    def add(
        term: str, joint: int, fixed: Mapping[str, float], linear: Mapping[str, tuple[float, float]],
        form: object = (), source: str = "explain",
    ) -> None:  # fmt: skip
        entry = CATALOGUE[term]
        numbers = {n: p.default for n, p in entry.parameters.items() if p.default is not None} | dict(fixed)
        if "width" in entry.parameters:
            numbers["width"] = _WIDTH
        numbers |= {n: _short(v) for n, (v, _) in linear.items()}
        found[term, joint, form] = TermData(
            name=term, joint=joint + 1, parameters=numbers, source=source,
            std={n: _short(s) for n, (_, s) in linear.items()},
        )  # fmt: skip

    for j in range(space.dof):
        for k, column in enumerate(space.own):
            at = space.own_index(j, k)
            if column.usual:
                add(column.term, j, {}, {column.parameter: (full[at], std[at])})
    for position, c in enumerate((*(a.score.candidate for a in accepted), *shapes)):
        if c.joint is None or not c.terms or c.terms[0] not in CATALOGUE or c.terms[0] in BASELINE:
            continue
        if (c.terms[0], c.joint, c.values) in found:  # a shape of which more was found
            continue
        mine = {
            x.parameter: space.own_index(c.joint, k)
            for k, x in enumerate(space.own)
            if x.term == c.terms[0] and x.values == c.values
        }
        fixed = {n: v for n, v in c.values if n != "width"} | dict(values.get(position, {}))
        source = "explain" if position < len(accepted) else "explain, the reference's own"
        add(c.terms[0], c.joint, fixed, {n: (full[i], std[i]) for n, i in mine.items()}, c.values, source)
        if c.effect == "cable_spring":
            at = next(space.own_index(c.joint, k) for k, x in enumerate(space.own) if x.term == "offset")
            add("offset", c.joint, {}, {"c": (full[at], std[at])})
    for a in accepted:
        for term, joint, linear in _shared_terms(evidence, a, full, std):
            add(term, joint, {}, linear)
    return tuple(sorted((*evidence.setup.known, *found.values()), key=lambda t: t.joint))


def _shared_terms(
    evidence: Evidence, a: Accepted, full: Array, std: Mapping[int, float]
) -> Iterator[tuple[str, int, dict[str, tuple[float, float]]]]:
    """Give (term, joint, parameters with std) of effects whose columns reach all joints.

    Slack has none: its blow is seen, and no term of a joint alone makes it.
    """
    space, c = evidence.setup.space, a.score.candidate
    if c.effect == "time_delay" and c.joint is not None:
        k = next(k for k, x in enumerate(space.own) if x.term == LATE and x.values == c.values)
        at = space.own_index(c.joint, k)
        yield "delay", c.joint, {"d": (full[at], std[at])}
    elif c.effect == "time_delay":
        value = dict(c.values)
        kind = "jerk" if value["jerk"] else "delay"
        at = space.common_index(f"{kind}{DELAYS.index(value['around']) + 1}")
        for j in range(space.dof):
            yield "delay", j, {"d": (full[at], std[at])}
    if c.effect == "joint_elasticity" and c.joint is not None:
        setup, q = evidence.setup, np.concatenate([r.q for r in evidence.runs if len(r)])[::50]
        inertia = float(of_links(setup.physics, setup.base, q)[c.joint])
        soft, spread = _compliance(space, c, c.joint, full, std)
        yield "elasticity", c.joint, {"c": (-inertia * soft, inertia * spread)}


def _compliance(
    space: Space, c: Candidate, joint: int, full: Array, std: Mapping[int, float]
) -> tuple[float, float]:
    """Return a soft gear's compliance, rad/Nm, and its standard deviation."""
    if not c.values:
        common = space.common_index(f"elasticity{joint + 1}")
        return float(full[common]), std[common]
    ends = np.array([v for _, v in c.values])
    own = [k for k, x in enumerate(space.own) if x.term == WINDUP and x.value["stiffness"] in ends]
    at = [space.own_index(joint, k) for k in own]
    parts = full[at] / full[at].sum()
    return float(parts @ (1 / ends)), float(np.linalg.norm([std[k] for k in at] / ends))


def _geometry(model: Model, robot: Robot, accepted: Sequence[Accepted]) -> Model:
    """Put offsets of encoders, turned gravity and drive gains where the model has them."""
    joints = list(model.joint)
    for a in accepted:
        c, size = a.score.candidate, a.score.size
        if c.effect == "encoder_offset" and c.joint is not None:
            turned = float(joints[c.joint].offset) + float(size[0])
            joints[c.joint] = joints[c.joint].model_copy(update={"offset": turned})
        if c.effect == "drive_gain" and c.joint is not None:
            gain = joints[c.joint].drive_gain / (1 - float(size[0]))
            joints[c.joint] = joints[c.joint].model_copy(update={"drive_gain": _short(gain)})
        if c.effect == "base_tilt":
            model = tilted(model, robot, float(size[0]), float(size[1]))
    return model.model_copy(update={"joint": tuple(joints)})
