"""What makes a load that comes and goes a load: the same mass each time, and a body's pattern."""

import numpy as np
from numpy.typing import NDArray

from .grams import regime, weights
from .held import TEN, WIDTHS, Held
from .physics import fitted_force, forces
from .segments import Mask, sums_of
from .whitening import REST

Array = NDArray[np.float64]

#: s; a push is over before. What is held so long has to show it there, by EVIDENCE.
LONG = 3.0
#: So many stretches of the same mass need not be long.
MANY = 4
#: Share of the time that a load is held which comes and goes.
LEAST, MOST = 0.025, 0.9
#: kg, and mass over its standard deviation.
LIGHTEST, SURE = 0.05, 5.0
#: m from the last joint's centre to the load's: further no gripper holds it.
REACH = 0.5
#: Nats by which it beats a load that is never or always there; nats of a stretch alone.
EVIDENCE, STRETCH = 30.0, 3.0
#: Of the squared residuals in its stretches, and of what a free force at the flange explains of them.
WHOLE, FORCE = 0.9, 0.9
#: A joint shows it, or something: its median torque there over that in pauses. The load leaves less than this
#: part of it; rows in motion that tell.
SHOWS, LEFT, _ROWS = 3.0, 0.6, 20
#: Nats that joints in motion have beside the one that shows it most.
SECOND = 10.0
#: A stretch's own mass over that of all, and the share of stretches that lie between.
ALIKE, AGREE = (0.7, 1.3), 0.7


def objection(found: Held) -> str:
    """Return in words why it is no load that is picked up and put down, or nothing."""
    if not LEAST <= found.share <= MOST:
        return f"is held in {100 * found.share:.0f} % of the time"
    if all(h.all() or not h.any() for h in found.held):
        return "is never picked up or put down within a recording"
    if found.fit.evidence(TEN) < EVIDENCE:
        return f"evidence {found.fit.evidence(TEN):.1f} nats, {EVIDENCE:g} asked"
    if why := unlike_a_load(found.value, found.fit.solve(TEN)[1]):
        return why
    if _longest(found) < LONG and len(found.events) < MANY:
        return "is held no longer than a push lasts"
    if np.mean(same_load(found)) < AGREE:
        return "is not the same load in each stretch"
    if (beside := _beside_one_joint(found)) < SECOND:
        return f"would show with {beside:.1f} nats on all joints in motion but one, {SECOND:g} asked"
    force, whole = _explained(found)
    if force < FORCE or whole < WHOLE:
        return f"explains {100 * force:.0f} % of what a free force does, and {100 * whole:.0f} % of all"
    return _on_each_joint(found)


def unlike_a_load(value: Array, covariance: Array) -> str:
    """Return in words that no gripper holds a mass so small or unsure, or so far away, or nothing.

    value (10,), covariance (10, 10): as of `quantities.payload_numbers`.
    """
    mass, std = float(value[0]), float(np.sqrt(covariance[0, 0]))
    if mass < max(LIGHTEST, SURE * std):
        return f"has a mass of {mass:.2g} kg with a standard deviation of {std:.2g} kg"
    if (away := float(np.linalg.norm(value[1:4])) / mass) > REACH:
        return f"has its centre {away:.2g} m from the last joint"
    return ""


def by_free_force(columns: Array, target: Array) -> Array:
    """Return the squares of target (n, N) that a force explains which is free at each instant, (n,).

    columns (n, N, 3): of the force, as `physics.forces` has them, in the target's units.
    """
    return np.asarray(np.einsum("tj,tji,ti->t", target, columns, fitted_force(columns, target)), np.float64)


def same_load(found: Held) -> Mask:
    """Return which events (or halves, of one alone) show the load of the others."""
    return np.array([ALIKE[0] < part < ALIKE[1] and nats > STRETCH for part, nats in _each(found)])


def _longest(found: Held) -> float:
    """Return how long the longest event lasts that shows the load by itself, s."""
    lengths = [float((part.stop - part.start) * x.rows.step) for x, part, _ in found.events]
    if len(lengths) == 1:  # it is all the evidence that there is
        return lengths[0]
    shown = zip(lengths, _each(found), strict=True)
    return max((length for length, (_, nats) in shown if nats > EVIDENCE), default=0.0)


def _each(found: Held) -> list[tuple[float, float]]:
    """Return how much of the load each event shows, and the nats of it there.

    The load is that of the other events; one event alone is halved.
    """
    events = found.events
    if len(events) == 1:
        ((x, part, target),) = events
        middle = len(target) // 2
        first, second = slice(part.start, part.start + middle), slice(part.start + middle, part.stop)
        events = [(x, first, target[:middle]), (x, second, target[middle:])]
    weight = [weights(x.rows, found.evidence.noise)[part] for x, part, _ in events]
    sums = [
        sums_of(x.columns[part], w, target, len(target))
        for (x, part, target), w in zip(events, weight, strict=True)
    ]
    matrix, right = (np.sum([getattr(y, k)[0] for y in sums], axis=0) for k in ("matrix", "right"))
    values = []
    for (x, part, target), w, own in zip(events, weight, sums, strict=True):
        system = matrix - own.matrix[0] + np.diag(1 / WIDTHS**2)
        load = x.columns[part] @ np.linalg.solve(system, right - own.right[0])
        onto, size = float(np.sum(w * load * target)), float(np.sum(w * load**2))
        values.append((onto / max(size, 1e-300), onto - 0.5 * size))
    return values


def _beside_one_joint(found: Held) -> float:
    """Return the nats of a load's torque on all joints in motion but the one that shows it most.

    What one joint alone tells may be its own; at rest static friction holds as much as a load.
    """
    each = zip(found.runs, found.load, strict=True)
    nats = sum(
        np.sum(weights(x.rows, found.evidence.noise) * y**2 * (regime(x.rows) < REST), axis=0)
        for x, y in each
    )
    return 0.5 * float(np.sum(nats) - np.max(nats))


def _on_each_joint(found: Held) -> str:
    """Return in words that a joint shows something that is not the load, while that is held; or nothing.

    A push that mostly points down is much of a load, but moves joints that no load does. Medians, since
    whoever hands it over touches the arm for a moment; in motion, since static friction holds a load too.
    """
    held, left, load = np.concatenate(found.held), np.concatenate(found.left), np.concatenate(found.load)
    moving = np.concatenate([regime(x.rows) < REST for x in found.runs])
    for j, moves in enumerate(moving.T):
        away, there = moves & ~held, moves & held
        if min(away.sum(), there.sum()) < _ROWS:
            continue
        torques = left[away, j], left[there, j], (left - load)[there, j]
        usual, shown, beyond = (float(np.median(np.abs(x))) for x in torques)
        if shown > SHOWS * usual and beyond > LEFT * shown:
            return f"leaves {beyond:.2g} of {shown:.2g} Nm on joint {j + 1}"
    return ""


def _explained(found: Held) -> tuple[float, float]:
    """Return what the load explains over what a free force at the flange does, and over all that is there.

    Weighted squares in the stretches; what the pauses show, a row, is noise and is taken off.
    """
    load, rows, others = 0.0, np.zeros(2), np.zeros((2, 2))  # (pause or stretch, force or all)
    for x, e, y, h in zip(found.runs, found.left, found.load, found.held, strict=True):
        root = np.sqrt(weights(x.rows, found.evidence.noise))
        target = e * root
        columns = forces(found.evidence.setup.physics, x.rows.q, e.shape[1]) * root[:, :, None]
        each = np.stack([by_free_force(columns, target), np.sum(target**2, axis=1)], axis=1)
        load += float(np.sum((target**2 - (target - y * root) ** 2)[h]))
        for k, part in enumerate((~h, h)):
            rows[k] += part.sum()
            others[k] += each[part].sum(axis=0)
    beyond = others[1] - others[0] * rows[1] / max(rows[0], 1.0)
    force_part, whole = load / np.maximum(beyond, 1e-9)
    return float(force_part), float(whole)
