"""Naming: forward selection of hypotheses by what they add to recordings that they have not seen.

Every step weighs the rows anew by what the model that stands leaves: scale by regime, and memory. A large
unknown effect so hides small ones until it is named, and never lends them its own certainty.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from .candidates import Candidate, Key, of_key
from .columns import BASELINE, BY_NAME, NARROW, REPEAT, Column, Space
from .evidence import Evidence, residual, weighed
from .grams import Scales, evenly, scales_of
from .grid import size_at_peak
from .lacking import widths
from .peaks import peak
from .pool import each
from .refit import observed_runs, parameters
from .repeats import coefficients
from .selection import Directions, Eliminated, eliminate, log_evidence

Array = NDArray[np.float64]

#: Base parameters of the published model may be off by this share of their wide prior before it is a finding.
TIGHT = 0.03
#: Around standstill every gear differs from Coulomb's law by a few percent of it, in one shape or another,
EVERY_GEAR = {"stribeck": 0.01, "presliding": 0.01, "lag": 0.03}
#: and by much of it where a fall is NARROW; by less and less of it where one is wider than that (speed of
#: Stribeck's bell, rad/s), or later than so many s.
MUCH, WIDE, PROMPT = 0.3, 0.04, 0.006
#: and how it passes zero speed may rise by this much of it above it, since some bends are sharper than a
#: smooth sign's.
PEAK = 0.02
#: rad; over so short a travel the whole Coulomb level may build up, over more of it less and less.
SHORTEST = 3e-4
#: Terms of which less explains as much the longer they take: on a grid, of size in steps.
SLOW = ("presliding", "lag")
#: Of a column's prior width, for columns that only describe the reference's own imperfections.
SHARES = (0.003, 0.01, 0.03, 0.1)
BARE = 1e-4
#: Nats by which one of two hypotheses leads that are told apart: odds of e^5 = 150.
APART = 5.0
#: Nats of a swing: drives and stick-slip swing as well, at some frequency; below it a soft gear may only lag.
#: And of a late sign without a reference: gears differ around standstill.
CLEAR = 100.0


@dataclass(frozen=True)
class Scored:
    """A hypothesis at its best nonlinear value. gain (F,): nats that it adds to a left-out fold's likelihood.

    evidence: what it adds on all folds at once; size (k,): its coefficients; std (k,). consistency: the
    coefficients over their spread when one fold after the other is left out (jackknife; Efron 1982). between:
    of what is late or builds up, the size where the evidence peaks between two nonlinear values (0: unknown).
    """

    candidate: Candidate
    gain: Array
    evidence: float
    size: Array
    std: Array
    consistency: float = 0.0
    between: float = 0.0

    @property
    def total(self) -> float:
        """Sum over folds."""
        return float(self.gain.sum())

    @property
    def steadiness(self) -> float:
        """Mean gain of a fold over its standard error."""
        return steadiness(self.gain)

    @property
    def improved(self) -> float:
        """Share of folds that it improves."""
        return float(np.mean(np.asarray(self.gain > 0)))


def steadiness(gain: Array) -> float:
    """Return the mean of gains (F,) over its standard error; nothing is steady that was seen once."""
    if len(gain) < 2:
        return 0.0
    spread = float(np.std(gain, ddof=1)) / np.sqrt(len(gain))
    return float(np.mean(gain) / max(spread, 1e-12))


def nuisance(evidence: Evidence, masses: float = TIGHT) -> Directions:
    """Return what is fitted whatever is found; masses: the share of their wide prior without a reference."""
    space = evidence.setup.space
    if evidence.has_reference:
        return _rich(evidence)
    keep = list(range(len(space.base)))
    std = list(masses * evidence.base_std)
    for j in range(space.dof):
        for k, c in enumerate(space.own):
            level = max(float(evidence.setup.friction[j, 0]), 1e-3)
            if c.usual:
                keep.append(space.own_index(j, k))
                std.append(float(evidence.own_std[j, k]))
            elif c.term in EVERY_GEAR:
                keep.append(space.own_index(j, k))
                std.append(level * _usual_part(c))
    return _softened(evidence, shared(space, keep, std))


def _usual_part(column: Column) -> float:
    """Return the part of the Coulomb level that a shape near standstill may have in every gear."""
    if column.term == "presliding":
        return float(max((SHORTEST / column.value["zs"]) ** 3, EVERY_GEAR["presliding"]))
    if column.term == "stribeck":
        bell = 0.5 * column.value["vs"] * 4 ** (1 / column.value["delta"])  # the one that ends as soon
        return MUCH if bell <= NARROW else EVERY_GEAR["stribeck"] * min(1.0, WIDE / bell) ** 2
    return EVERY_GEAR["lag"] * min(1.0, PROMPT / column.value["lag"]) ** 2


def shared(space: Space, keep: Sequence[int], std: Sequence[float]) -> Directions:
    """Return parameters of the space as directions that both sides share."""
    vectors = sparse.eye(space.size, format="csc")[:, list(keep)]
    return Directions(vectors, np.array(std), np.ones(len(keep), bool))


def _softened(evidence: Evidence, model: Directions) -> Directions:
    """Let each joint's Coulomb friction pass zero speed as gently as its rows ask for, if they do.

    What they ask for most comes first, so that it is not made up of what does not fit them.
    But only rising: a gentle part less a gentler one has a peak, which is Stribeck's and to be named.
    """
    space, best = evidence.setup.space, log_evidence(evidence.sums, model)
    for j in range(space.dof):
        gentle = [k for k, c in enumerate(space.own) if c.soft]
        while gentle:
            tried = {k: model + _alone(evidence, j, k) for k in gentle}
            worth = {k: log_evidence(evidence.sums, softer) for k, softer in tried.items()}
            k = max(gentle, key=lambda k: worth[k])
            if worth[k] <= best:
                break
            gentle.remove(k)
            if _rises(evidence, tried[k], j):
                best, model = worth[k], tried[k]
    return model


def _alone(evidence: Evidence, joint: int, k: int) -> Directions:
    """Return a joint's own column k as a direction that both sides share."""
    space = evidence.setup.space
    return shared(space, [space.own_index(joint, k)], [float(evidence.own_std[joint, k])])


def _rises(evidence: Evidence, model: Directions, joint: int) -> bool:
    """Return whether a joint's blend of signs has no peak in a model's fit but a narrow one."""
    space, theta = evidence.setup.space, parameters(evidence, model)
    level, blend = float(evidence.setup.friction[joint, 0]), ("coulomb",)
    wide = peak(space, theta, joint, blend, NARROW)
    return peak(space, theta, joint, blend) <= MUCH * level and wide <= PEAK * level


def _rich(evidence: Evidence) -> Directions:
    """Every column for both sides, as free as the reference recordings say by their marginal likelihood.

    First one freedom for all columns, then each term that the reference asks for gets its full prior width.
    """
    space = evidence.setup.space
    # what heat does is the reference's own only where the reference shows it; else it explains anything
    terms = ["heat" if c.parameter == "temperature" else c.term for c in space.own]
    shown = {"heat", "temperature_dependent", *BY_NAME}
    free = {*BASELINE, REPEAT}

    def model(share: float, wide: set[str]) -> Directions:
        width = np.array([1.0 if t in wide else BARE if t in shown else share for t in terms])
        common = widths(space.common, 1e-3)
        std = np.concatenate([evidence.base_std, (width * evidence.own_std).ravel(), common])
        return Directions(sparse.eye(space.size, format="csc"), std, np.ones(space.size, bool))

    def worth(share: float, wide: set[str]) -> float:
        return log_evidence(evidence.sums, model(share, wide), reference_only=True)

    share = max(SHARES, key=lambda s: worth(s, free))
    best = worth(share, free)
    for term in dict.fromkeys(t for t in terms if t not in free and t not in ("gain", *BY_NAME)):
        if (found := worth(share, free | {term})) > best:
            best, free = found, free | {term}
    return model(share, free)


def reweighed(evidence: Evidence, model: Directions, even: bool = False) -> Evidence:
    """Weigh the observed rows by what a model leaves of them: their scale by regime, and its memory.

    even: slow and fast residuals count alike.
    """
    space = evidence.setup.space
    seen = [evidence.runs[r] for r in observed_runs(evidence)]
    for _ in range(2):
        own = parameters(evidence, model)
        scales = scales_of(seen, [residual(r, space, own) for r in seen])
        if evidence.has_reference:
            own[coefficients(space)] = 0.0
            alone = scales_of(seen, [residual(r, space, own) for r in seen])
            scales = _no_less(scales, evidence.scales, scales.sigma / alone.sigma)
        evidence = weighed(evidence, evenly(scales) if even else scales)
    return evidence


def _no_less(scales: Scales, reference: Scales, new: Array) -> Scales:
    """Return scales no less than the reference's, but for what came back; new (N, 3): what did not of it."""
    new = np.minimum(new, 1.0)
    memory = 1 + new[:, 0] * (reference.inflation - 1)
    theirs = reference.correlation or scales.correlation
    longer = zip(scales.inflation >= memory, scales.correlation, theirs, strict=True)
    return Scales(
        np.maximum(scales.sigma, new * reference.sigma),
        np.maximum(scales.inflation, memory),
        np.maximum(scales.fast, reference.fast),
        tuple(own if keeps else other for keeps, own, other in longer),
    )


def scored(evidence: Evidence, model: Directions, some: Sequence[Candidate]) -> list[Scored]:
    """Score hypotheses as additions to a model, with the evidence's weights."""
    used = sorted({c for x in some for c in x.columns})
    place = {c: i for i, c in enumerate(used)}
    directions = evidence.found.directions.take(used)
    sums = evidence.sums
    folds = (*range(len(sums.observed)), None)
    *out, whole = each(lambda k: eliminate(sums, model, directions, k), folds)
    found = []
    for c in some:
        columns = [place[x] for x in c.columns]
        full = whole.evidence(columns)
        size, covariance = whole.solve(columns)
        gain = np.array([full - o.evidence(columns) for o in out])
        same = _consistency(whole, out, columns)
        found.append(Scored(c, gain, full, size, np.sqrt(np.diag(covariance)), same))
    return found


def added(evidence: Evidence, model: Directions, candidate: Candidate) -> Eliminated:
    """Return a hypothesis' columns with a model eliminated from them, on all folds at once."""
    return eliminate(evidence.sums, model, evidence.found.directions.take(candidate.columns), None)


def worth(evidence: Evidence, model: Directions, candidate: Candidate) -> float:
    """Return the nats that a hypothesis adds to a model on all folds at once: the evidence of its score."""
    return added(evidence, model, candidate).evidence(range(len(candidate.columns)))


def _consistency(whole: Eliminated, out: Sequence[Eliminated], columns: Sequence[int]) -> float:
    """Return one over the jackknife's standard error of a hypothesis' size, in its own metric."""
    if len(out) < 2:
        return 0.0
    size, _ = whole.solve(columns)
    metric = whole.schur[np.ix_(columns, columns)] @ size
    own = np.array([o.solve(columns)[0] @ metric for o in out]) / max(float(size @ metric), 1e-300)
    spread = float(np.sum((own - own.mean()) ** 2)) * (len(own) - 1) / len(own)
    return float(1 / np.sqrt(max(spread, 1e-12)))


def ranked(evidence: Evidence, model: Directions, skip: Sequence[str] = ()) -> list[Scored]:
    """Return every hypothesis at its best nonlinear value as an addition to a model, best first."""
    return at_best(evidence, model, [c for c in evidence.found.each if c.effect not in skip])


def at_best(evidence: Evidence, model: Directions, some: Sequence[Candidate]) -> list[Scored]:
    """Return the conceivable ones of some hypotheses at their best nonlinear values, best first."""
    best: dict[Key, Scored] = {}
    slow: dict[Key, list[Scored]] = {}
    for s in scored(evidence, model, some):
        c = s.candidate
        clear = not c.whole or s.evidence >= CLEAR
        if (c.key not in best or s.evidence > best[c.key].evidence) and c.conceivable(s.size) and clear:
            best[c.key] = s
        if c.terms and c.terms[0] in SLOW:
            slow.setdefault(c.key, []).append(s)
    for key in slow.keys() & best.keys():
        best[key] = replace(best[key], between=_between(slow[key]))
    return sorted(best.values(), key=lambda s: -s.evidence)


def _between(some: Sequence[Scored]) -> float:
    values = [s.candidate.values[0][1] for s in some]
    return size_at_peak(values, [s.evidence for s in some], [float(s.size[0]) for s in some])


def tested(evidence: Evidence, model: Directions, candidate: Candidate) -> tuple[Scored, Evidence]:
    """Score one hypothesis with the rows weighed by what is left once it is in; also return these rows.

    At the nonlinear value that is best by these weights: before, what it explains was taken for noise.
    """
    family = of_key(evidence.found.each, candidate.key)
    weighed = reweighed(evidence, chosen(model, evidence, candidate))
    found = at_best(weighed, model, family)
    if found and found[0].candidate != candidate:
        weighed = reweighed(evidence, chosen(model, evidence, found[0].candidate))
        found = at_best(weighed, model, family)
    return (found or scored(weighed, model, [candidate]))[0], weighed


def chosen(model: Directions, evidence: Evidence, candidate: Candidate) -> Directions:
    """Add a hypothesis to a model."""
    return model + evidence.found.directions.take(candidate.columns)
