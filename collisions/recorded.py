"""Real collisions of one joint with a contact sensor: delay of detectors, false alarms in free motion.

Made for recordings of a UR10 (Nguyen and Case): joint 1 alone runs into a soft forearm that counts drops of
an independent force sensor. That robot is a CB3, of which no data are published here: the rigid body is the
UR10e's, friction and offset are fitted to the free sweeps. At constant speed the rigid body hardly matters.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ..codegen.generate import observer_text
from ..codegen.guard import CUSUM_DRIFT, CUSUM_TIME
from ..codegen.load import load_text
from ..errors import InputError
from ..identify.baseline import Options
from ..identify.observation import observe
from ..identify.workflow import Task, run
from ..recordings import read
from ..recordings.audit import clean
from ..robots import load_robot
from ..robots.model import Model
from .tables import markdown, show

Array = npt.NDArray[np.float64]

SENSOR = "contact_sensor_counts"
ROBOT = "ur10e"
#: s: width over which a drop of the sensor is looked for; of the baseline before it, and what is left out.
DROP, BASELINE, GUARD = 0.3, 3.0, 0.4
#: The contact begins where the sensor last was within FOOT sigma of its trend before it left CERTAIN sigma.
FOOT, CERTAIN = 2.0, 5.0
#: Samples that a speed is taken from where none is recorded: host stamps are up to 6 ms off, and the slope of
#: two of them is that much wrong. Only past ones, so that no detection sees the future.
SLOPE = 9
#: s: alarms closer than this are one.
APART = 1.0


@dataclass(frozen=True)
class Seen:
    """A recording as the observer sees it: time (T,) s, external torque of joint 1 (T,) Nm; settled (T,).

    counts: of the contact sensor (T,), None in free motion.
    """

    name: str
    time: Array
    torque: Array
    settled: npt.NDArray[np.bool_]
    counts: Array | None


@dataclass(frozen=True)
class Result:
    """One recording: seconds watched without contact; for each limit: false alarms there, and delay in s.

    onset: s, NaN in free motion; delays NaN where nothing was detected within 1 s or there is no contact.
    """

    name: str
    watched: float
    onset: float
    limits: tuple[float, float]
    false_alarms: dict[str, int]
    delays: dict[str, float]


def evaluate(files: Sequence[Path]) -> list[Result]:
    """Return a result for every recording; a free one is judged by a model that has not seen it.

    Raises InputError when free recordings or such with a contact sensor are missing.
    """
    counts = {f: sensor(f) for f in files}
    free = [f for f in files if counts[f] is None]
    hit = [f for f in files if counts[f] is not None]
    if len(free) < 2 or not hit:
        raise InputError(
            f"--recordings: found {len(free)} free ones and {len(hit)} with {SENSOR};"
            " give at least two free ones, and one with contact"
        )
    results = []
    for left in free:
        others = [f for f in free if f != left]
        results.append(_judge(_see(left, _fit(others), None), _limits(others, _fit(others))))
    model = _fit(free)
    limits = _limits(free, model)
    return results + [_judge(_see(f, model, counts[f]), limits) for f in hit]


def sensor(file: Path) -> Array | None:
    """Return the sensor's counts (T,) of a recording, None when it has no such column."""
    with file.open(encoding="utf-8", errors="replace") as lines:
        names = lines.readline().strip().split(",")
    if SENSOR not in names:
        return None
    return np.loadtxt(file, delimiter=",", skiprows=1, usecols=names.index(SENSOR), dtype=np.float64)


def onset(time: Array, counts: Array) -> int:
    """Return the sample at which the contact begins: the foot of the sensor's largest drop.

    The baseline is a straight line through the seconds before the drop. Raises InputError without a drop.
    """
    width = max(2, round(DROP / float(np.median(np.diff(time)))))
    level = np.lib.stride_tricks.sliding_window_view(counts, width)
    middle = np.median(level, axis=1)
    fall = middle[width:] - middle[:-width]
    at = int(np.argmin(fall)) + width
    before = (time > time[at] - GUARD - BASELINE) & (time < time[at] - GUARD)
    if before.sum() < 10:
        raise InputError(f"{SENSOR}: the largest drop stands too near the beginning to have a baseline")
    trend = np.polyfit(time[before] - time[at], counts[before], 1)
    rest = counts - np.polyval(trend, time - time[at])
    sigma = float(np.std(rest[before]))
    far = np.flatnonzero((rest < -CERTAIN * sigma) & (time > time[at] - GUARD))
    if not len(far):
        raise InputError(f"{SENSOR}: no drop of {CERTAIN:g} sigma; was there a contact?")
    near = np.flatnonzero(rest[: far[0]] > -FOOT * sigma)
    return int(near[-1]) + 1


def _fit(free: Sequence[Path]) -> Model:
    robot, digest = load_robot(ROBOT)
    _, model = run(Task(tuple(free), robot, digest, 1, Options(), false_alarms=1.0, workers=1))
    return model


def _see(file: Path, model: Model, counts: Array | None) -> Seen:
    good, report = clean(read(file))
    report.require()
    if good.qd is None:
        good = replace(good, qd=past_slope(good.timestamp, good.q))
    found = observe(good, load_text(observer_text(model)))
    if counts is not None and len(counts) != len(found.timestamp):
        raise InputError(f"{file}: rows were dropped, so {SENSOR} no longer fits; repair the file")
    return Seen(file.name, found.timestamp, found.external_torque[:, 0], found.settled, counts)


def past_slope(time: Array, q: Array) -> Array:
    """Return speeds (T, N) rad/s: the straight line through each sample and the eight before it."""
    window = np.lib.stride_tricks.sliding_window_view
    t = window(time, SLOPE) - window(time, SLOPE).mean(axis=1, keepdims=True)
    slope = np.einsum("tk,tnk->tn", t, window(q, SLOPE, axis=0)) / np.sum(t * t, axis=1)[:, None]
    return np.vstack([np.repeat(slope[:1], SLOPE - 1, axis=0), slope])


def _limits(free: Sequence[Path], model: Model) -> tuple[float, float]:
    """Return the largest |torque| of free motion (the thesis' way), and the fitted limit (Nm)."""
    assert model.thresholds is not None
    seen = [_see(f, model, None) for f in free]
    return max(float(np.abs(s.torque[s.settled]).max()) for s in seen), model.thresholds.static[0]


def scores(seen: Seen, limits: tuple[float, float]) -> dict[str, Array]:
    """Return detector -> score (T,): both limits, and CUSUM on the first."""
    extreme, fitted = limits
    step = np.diff(seen.time, prepend=seen.time[0])
    sums = np.zeros(len(step))
    for sign in (1.0, -1.0):
        total = 0.0
        for k, (share, dt) in enumerate(zip(sign * seen.torque / extreme, step, strict=True)):
            total = max(0.0, total + (share - CUSUM_DRIFT) * dt) if seen.settled[k] else 0.0
            sums[k] = max(sums[k], total)
    size = np.abs(seen.torque) * seen.settled
    return {"extremes": size / extreme, "fitted": size / fitted, "cusum": sums / CUSUM_TIME}


def _judge(seen: Seen, limits: tuple[float, float]) -> Result:
    start = len(seen.time) if seen.counts is None else onset(seen.time, seen.counts)
    touched = float("nan") if seen.counts is None else float(seen.time[start])
    false, delays = {}, {}
    for name, score in scores(seen, limits).items():
        above = seen.time[np.flatnonzero(score >= 1.0)]
        before = above[above < touched] if seen.counts is not None else above
        false[name] = int(len(before) > 0) + int((np.diff(before) > APART).sum())
        after = above[(above >= touched) & (above < touched + 1.0)] if seen.counts is not None else above[:0]
        delays[name] = float(after[0] - touched) if len(after) else float("nan")
    watched = seen.settled[:start]
    seconds = float(np.sum(np.diff(seen.time, prepend=seen.time[0])[:start][watched]))
    return Result(seen.name, seconds, touched, limits, false, delays)


def table(results: Sequence[Result]) -> str:
    """Return the table, and its sums, as Markdown."""
    names = list(results[0].delays)
    header = ["recording", "free, s", *(f"false alarms, {n}" for n in names), "contact at, s",
              *(f"delay {n}, ms" for n in names)]  # fmt: skip
    cells = [
        [
            r.name,
            f"{r.watched:.1f}",
            *(str(r.false_alarms[n]) for n in names),
            show(r.onset, ".3f"),
            *(show(1e3 * r.delays[n]) for n in names),
        ]
        for r in results
    ]
    hits = [r for r in results if not np.isnan(r.onset)]
    line = ["all", f"{sum(r.watched for r in results):.1f}"]
    line += [str(sum(r.false_alarms[n] for r in results)) for n in names]
    line.append(f"{len(hits)} contacts")
    for n in names:
        values = np.array([r.delays[n] for r in hits])
        found = values[~np.isnan(values)]
        line.append(f"{show(1e3 * float(found.mean()) if len(found) else np.nan)} ({len(found)} found)")
    extreme, fitted = hits[0].limits
    note = (
        f"\nLimits for the contacts: extremes of free motion {extreme:.2f} Nm, fitted {fitted:.2f} Nm"
        " (1 false alarm an hour, extrapolated); free sweeps are judged by fits to the others.\n"
    )
    return markdown(header, [*cells, line]) + note
