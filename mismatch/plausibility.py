"""What is physics at the size that it would have, and what only looks like it."""

import numpy as np
from numpy.typing import NDArray

from .candidates import Candidate, of_key
from .evidence import Evidence
from .flexible import names
from .naming import APART, CLEAR, Scored, chosen, scored, worth
from .peaks import peak
from .refit import parameters
from .selection import Directions

Array = NDArray[np.float64]

#: Friction over the angle is a wave unless any curve explains so much more than it; and nats at least.
NO_WAVE = 0.5, APART
#: What turns with the drive's torque is an amplifier's where that sign explains so much more. It differs from
#: that of motion in few rows, where a joint brakes hard; forms of friction differ by less of a large change.
DRIVEN = 0.001, 2 * APART
#: What friction does around zero speed alone.
NEAR_ZERO = ("stribeck", "presliding_hysteresis", "velocity_lag")
#: What builds up with travel or late is much of the Coulomb level, or it is something else; over less travel
#: (rad) than the catalogue's, which every gear shows a little of, more of it. A reference holds what every
#: gear has: a change of what builds up may be small; what comes late is friction as a whole.
AT_REVERSALS = {"presliding_hysteresis": 0.2, "velocity_lag": 0.6}
_TRAVEL, _PART_WITHIN = 0.005, 0.35
_CHANGED = {"presliding_hysteresis": 0.1, "velocity_lag": 0.5}
#: How gears stop and start looks like a late sign, on all joints alike: a joint's own is so many times later.
_AHEAD = 1.7
#: What slack does follows from its width: the size of its column is one, or at least this.
_LEAST_GAP = 0.3
#: Nm/rad; a third of the catalogue's softest gear.
SOFTEST = 1e3
#: s; current and motion may be less than this apart without anything being wrong: a cycle and a half. A
#: reference holds what the recorder does, but for the cycle in which one began: so much is a change.
SYNCHRONOUS, SHIFTED = 0.003, 0.0015
#: Of its size, friction as a whole has to rise by this share above where it ends: else it only starts gently.
_PEAK = 0.3
#: Of a joint's friction, a degree: twice the catalogue's steepest fall; warm gears hardly rub more.
STEEPEST, RISING = 0.05, 0.01
#: A rotor is there: it may have lost this part of its published inertia.
LOST = 0.9


def implausible(evidence: Evidence, test: Scored) -> str:
    """Return in words why a hypothesis is no physics at the size that it would have, or nothing."""
    c = test.candidate
    if c.effect == "backlash" and not _LEAST_GAP < (times := float(test.size.sum())) < 1 / _LEAST_GAP:
        return f"moves the arm {times:.2g} times as much as such a gap does"
    if c.whole and not c.conceivable(test.size):
        return f"moves the arm {test.size[0]:.2g} and {test.size[1]:.2g} times as much as such gears do"
    if c.effect == "joint_elasticity" and not c.whole and test.size[0] * SOFTEST > 1:
        return f"a stiffness of {1 / test.size[0]:.0f} Nm/rad is no gear's"
    if c.effect == "time_delay" and c.joint is not None and synchronous(evidence, test):
        return f"{1e3 * test.size[0]:.1f} ms late is as recorders have it"
    if c.effect == "temperature_dependent_friction" and c.joint is not None:
        level, surely = evidence.setup.friction[c.joint], 2 * test.std[:2]
        fall, rise = (float(np.max((way * test.size[:2] - surely) / level)) for way in (-1, 1))
        if fall > STEEPEST or rise > RISING:
            return f"friction that changes by {100 * max(fall, rise):.0f} % or more a degree is no gear's"
    if c.effect == "rotor_inertia" and c.joint is not None:
        whole = evidence.setup.physics.reflected[c.joint]
        if whole > 0 and test.size[0] < -LOST * whole:
            return f"takes {-100 * test.size[0] / whole:.0f} % of the rotor's inertia away"
    if c.effect in AT_REVERSALS and c.joint is not None:
        level, size = evidence.setup.friction[c.joint, 0], test.between or abs(float(test.size[0]))
        least = _PART_WITHIN if is_short(c) else AT_REVERSALS[c.effect]
        if size < (_CHANGED[c.effect] if evidence.has_reference else least) * level:
            return f"is {100 * size / level:.0f} % of the Coulomb level: too little for it"
    return ""


def synchronous(evidence: Evidence, test: Scored) -> bool:
    """Return whether a delay is one that recorders have without anything being wrong."""
    return bool(test.size[0] < (SHIFTED if evidence.has_reference else SYNCHRONOUS))


def near_zero(c: Candidate) -> bool:
    """Return whether it is told by what happens around zero speed; of one joint's delay that is most."""
    return c.effect in NEAR_ZERO or (c.effect == "time_delay" and c.joint is not None)


def is_short(c: Candidate) -> bool:
    """Return whether it builds up over less travel than the catalogue's presliding."""
    return dict(c.values).get("zs", _TRAVEL) < _TRAVEL


def misshapen(weighed: Evidence, model: Directions, test: Scored) -> tuple[str, tuple[int, ...]]:
    """Return in words that a curve which is no physics explains it far better, and its columns; or nothing.

    Friction over the angle that is no wave is a damaged tooth's. What turns with the sign of the drive's
    torque, and not with that of motion, is the amplifier's. weighed: by what the hypothesis leaves.
    """
    c = test.candidate
    if c.joint is None:
        return "", ()
    over, (part, least) = "drive sign", DRIVEN
    if c.effect == "position_dependent_friction":
        over, (part, least) = "q sign", NO_WAVE
    curve = curve_over(weighed, over, c.joint)
    if (lead := worth(weighed, model, curve) - test.evidence) > max(least, part * test.evidence):
        what = {"q sign": "a curve over the angle that is no wave", "drive sign": "the torque's own sign"}
        return f"{what[over]} explains {lead:.0f} nats more", curve.columns
    return "", ()


def curve_over(evidence: Evidence, variable: str, joint: int) -> Candidate:
    """Return the flexible curve over one of its variables on a joint (0-based), which is no physics."""
    columns = evidence.found.curve[joint]
    return Candidate(
        "unknown", joint, tuple(columns[k] for k, (name, _) in enumerate(names()) if name == variable)
    )


def peakless(weighed: Evidence, model: Directions, test: Scored) -> str:
    """Return in words that friction beside Stribeck's has no peak, but only starts as gently; or nothing.

    With a reference it is a change, and may be one of how gently.
    """
    c = test.candidate
    if c.effect != "stribeck" or c.joint is None or weighed.has_reference:
        return ""
    theta, size = parameters(weighed, chosen(model, weighed, c)), float(test.size[0])
    if (rise := peak(weighed.setup.space, theta, c.joint)) >= _PEAK * size:
        return ""
    return f"friction rises by {100 * rise / size:.0f} % of it: it only starts gently"


def of_all_joints(weighed: Evidence, model: Directions, test: Scored) -> str:
    """Return in words that a late sign is that of the other joints as well, or nothing.

    A reference holds what is everyone's; without one, gears differ by some of it around standstill.
    """
    c, level = test.candidate, weighed.setup.friction[:, 0]
    if c.effect != "velocity_lag" or c.joint is None or weighed.has_reference:
        return ""
    if test.evidence < CLEAR:
        return f"evidence {test.evidence:.1f} nats, {CLEAR:.0f} asked of a late sign without a reference"
    lags = [x for x in weighed.found.each if x.effect == c.effect and x.joint != c.joint]
    theirs = [
        _lateness(s, level)
        for s in scored(weighed, model, lags)
        if s.evidence >= APART and s.candidate.conceivable(s.size)
    ]
    return everyones(_lateness(test, level), max(theirs, default=0.0))


def of_friction(weighed: Evidence, model: Directions, test: Scored) -> str:
    """Return in words that friction alone is late, and not the current with all it carries; or nothing.

    Without a reference that has to be told: gears differ around standstill, and currents do not.
    """
    c = test.candidate
    if c.effect != "time_delay" or c.joint is None:
        return ""
    late = Candidate("velocity_lag", c.joint, weighed.found.late_friction[c.joint])
    alone = [late, *of_key(weighed.found.each, late.key)]
    lead = max(s.evidence for s in scored(weighed, model, alone)) - test.evidence
    if lead < (APART if weighed.has_reference else -APART):
        return ""
    return f"friction alone that is late explains {abs(lead):.0f} nats {'more' if lead > 0 else 'less only'}"


def _lateness(lag: Scored, level: Array) -> float:
    """Return the time (s) by which a joint's Coulomb level as a whole is late; level (N,) Nm."""
    c = lag.candidate
    return 0.0 if c.joint is None else dict(c.values)["lag"] * float(lag.size[0] / level[c.joint])


def everyones(own: float, theirs: float) -> str:
    """Return in words that a joint's late sign does not stand out, or nothing; s."""
    if own >= _AHEAD * theirs:
        return ""
    return f"is {1e3 * own:.0f} ms late, and another joint {1e3 * theirs:.0f} ms"
