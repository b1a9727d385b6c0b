"""`explain` from files to answer: read, gather evidence, judge, locate, prove, refine."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

from ..errors import InputError
from ..recordings import Recording, read
from ..recordings.audit import clean
from ..recordings.report import AuditReport
from ..robots import Robot
from ..robots.model import Input, Model
from ..symbolic.nominal import nominal_model
from .amplifier import hidden_amplifiers
from .answer import compose
from .carried import Carried, carried, handled, unloaded
from .coverage import cannot_show
from .episodes import episodes
from .evidence import Evidence, evenly_weighed, gather, residual
from .handed import handed, shapes_of, unnamed
from .judging import Judged, judge
from .lacking import full_of
from .limits import with_thresholds
from .masses import concealed
from .naming import reweighed
from .next_motion import next_motion
from .parts import Parts
from .placebo import placebo_rate
from .pool import each
from .proof import motion, prove, rms_where
from .pushes import Pushed, pushed, released, with_pushes
from .refine import refined
from .refit import LeftOut, left_out, observed_runs, parameters
from .refusal import bad_data
from .regions import regions
from .result import Explanation, NextMotion, Proof, Source
from .selection import Directions
from .sharpen import settled, sharpened, without
from .unknown import unknowns

Array = NDArray[np.float64]
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Task:
    """What to explain. model: the nominal one instead of the robot's published links.

    propose: look for the motion that would tell apart what these recordings cannot. thresholds: run the
    refined model's observer along the recordings for its detection thresholds.
    """

    recordings: tuple[Path, ...]
    reference: tuple[Path, ...]
    robot: Robot
    robot_hash: str
    dof: int
    model: Model | None = None
    propose: bool = True
    thresholds: bool = True


def explain(task: Task, progress: Progress = lambda _: None) -> Explanation:
    """Say where recordings and model differ, what physics is missing, and prove it.

    Raises InputError for files that cannot be read or that hold fewer joints than asked.
    """
    with threadpool_limits(1):  # matrices are small: recordings and blocks run side by side instead
        return _answered(task, progress)


def _answered(task: Task, progress: Progress) -> Explanation:
    progress("reading and auditing")
    given = [(p, r) for r, some in ((False, task.recordings), (True, task.reference)) for p in some]
    taken = each(lambda x: _read(*x), given)
    _distinct(taken)
    sources = tuple(_source(rec, report, ref) for rec, report, ref in taken)
    nominal, simplified = _nominal(task, taken)
    nominal = nominal.model_copy(update={"inputs": (*nominal.inputs, *_inputs(taken))})
    refusals = [(rec, report) for rec, report, _ in taken if report.verdict == "refuse"]
    if refusals:
        return bad_data(task.robot, nominal, sources, refusals)
    for rec, _, _ in taken:
        if rec.joints < nominal.dof:
            raise InputError(
                f"{rec.name}: has {rec.joints} joints, the model {nominal.dof}; give --dof {rec.joints}"
            )
    recordings = [rec for rec, _, _ in taken]
    observed = [not ref for _, _, ref in taken]
    evidence = gather(recordings, observed, nominal, task.robot, progress, simplified)
    lacks = cannot_show(evidence, recordings)
    if lacks.hopeless:
        return bad_data(task.robot, nominal, sources, [], lacks.texts)
    return _explained(task, nominal, evidence, recordings, sources, lacks.texts, progress)


@dataclass(frozen=True)
class _Told:
    """What was named, and from which rows.

    recorded; every: a load that comes and goes taken off; evidence: rows of pushes left out as well; weighed:
    that by what the names leave.
    """

    recorded: Evidence
    every: Evidence
    evidence: Evidence
    load: Carried | None
    push: Pushed | None
    judged: Judged
    weighed: Evidence


def _told(recorded: Evidence, progress: Progress) -> _Told:
    progress("a load that comes and goes")
    load = carried(recorded)
    every = unloaded(recorded, load) if load else recorded
    judged = judge(every, progress)
    progress("pushes")
    weighed = reweighed(every, judged.model)
    if not (push := pushed(every, judged, weighed, handled(recorded, load) if load else {})):
        return _Told(recorded, every, every, load, None, judged, weighed)
    evidence = released(every, push)
    judged = judge(evidence, progress)
    return _Told(recorded, every, evidence, load, push, judged, reweighed(evidence, judged.model))


def _explained(
    task: Task, nominal: Model, recorded: Evidence, recordings: Sequence[Recording],
    sources: tuple[Source, ...], lacks: tuple[str, ...], progress: Progress,
) -> Explanation:  # fmt: skip
    t = _told(recorded, progress)
    evidence, weighed = t.evidence, t.weighed
    judged = settled(weighed, t.judged)
    progress("what is left")
    which = observed_runs(evidence)
    names, runs = [recordings[r].name for r in which], [t.every.runs[r] for r in which]
    left = _left(weighed, judged.model, weighed)
    found = episodes(evidence.runs, which, left, evidence.scales, evidence.setup.friction[:, 0])
    if t.push:
        left = with_pushes(left, _left(weighed, judged.model, t.every), t.push)
    strange = unknowns(evidence, weighed, judged)
    progress("sharpening")
    sharp = sharpened(weighed, judged)
    progress("proof on left-out blocks")
    kept = [a for a in judged.accepted if a.is_finding or not evidence.has_reference]
    shapes = shapes_of(evidence, kept)
    whole = handed(evidence, kept, shapes)
    bare = whole if evidence.has_reference else unnamed(evidence, kept)
    # what is handed over has no freedom of its own around zero speed: its errors there are its noise
    fair = reweighed(evenly_weighed(evidence), whole, even=True)
    proof, before, after = _proved(t, fair, bare, whole)
    moving = motion(fair)
    lighter = None
    if t.load:
        lighter = rms_where(left_out(fair, bare, fair.has_reference).residual, moving)
    gear = float(task.robot.joint[0].gear)
    places = regions(runs, names, before.residual, gear)
    progress("placebos")
    rate = placebo_rate(weighed, judged)
    progress("refined model")
    values = {k: s.value for k, s in sharp.items()}
    model = refined(fair, nominal, task.robot, judged.accepted, shapes, values)
    if task.thresholds:
        progress("thresholds")
        fitted = rms_where(_left(fair, whole, fair), moving)
        inflate = np.maximum(1.0, proof.after / np.maximum(fitted, 1e-12))
        pushes = t.push.contact.pushes if t.push else ()
        touched = [e.span for e in (*found, *pushes)] + list(t.load.intervals if t.load else ())
        model = with_thresholds(model, [recordings[r] for r in which], inflate, touched)
    parts = Parts(
        task.robot, nominal, sources, evidence, judged, sharp, found, runs, left, t.push, strange, proof,
        before, after, rate, tuple(places), names,
        (*lacks, *concealed(judged.masses_off), *hidden_amplifiers(weighed, judged)), model,
        _proposal(task, weighed, judged, progress), t.load, lighter,
    )  # fmt: skip
    return compose(parts)


def _proved(
    t: _Told, fair: Evidence, baseline: Directions, whole: Directions
) -> tuple[Proof, LeftOut, LeftOut]:
    """Prove on the rows without pushes; what both models leave is of all rows."""
    first = fair
    if t.load:
        # a load that comes and goes is slow: it would hide what is as slow from the fit without it
        loaded = evenly_weighed(released(t.recorded, t.push) if t.push else t.recorded)
        first = reweighed(loaded, baseline, even=True)
    proof, before, after = prove(fair, baseline, whole, first)
    if t.push is None:
        return proof, before, after
    early = _left(first, baseline, t.recorded, fair.has_reference)
    late = _left(fair, whole, t.every)
    return (
        proof,
        replace(before, residual=with_pushes(before.residual, early, t.push)),
        replace(after, residual=with_pushes(after.residual, late, t.push)),
    )


def _left(fitted: Evidence, model: Directions, of: Evidence, healthy: bool = False) -> Sequence[Array]:
    """Return what a model that is fitted to some rows leaves of each observed run of others (n, N), Nm."""
    own = parameters(fitted, model, healthy=healthy)
    return [residual(of.runs[r], of.setup.space, own) for r in observed_runs(of)]


def _proposal(task: Task, evidence: Evidence, judged: Judged, progress: Progress) -> NextMotion | None:
    """Return the motion that parts the first class of names that cannot be told apart."""
    classes = [k for k, a in enumerate(judged.accepted) if a.alike and a.is_finding]
    if not classes or not task.propose:
        return None
    progress("the next motion")
    k = classes[0]
    rivals = [judged.accepted[k].score.candidate, *judged.accepted[k].alike]
    speeds = np.array([j.max_speed for j in task.robot.joint[: evidence.setup.space.dof]])
    return next_motion(evidence, without(judged, k), rivals, speeds)


def _distinct(taken: Sequence[tuple[Recording, AuditReport, bool]]) -> None:
    """Refuse a recording that is given twice: what is left out would be seen after all."""
    seen: dict[str, str] = {}
    for recording, _, _ in taken:
        key = recording.source.sha256 if recording.source else recording.name
        if key in seen:
            raise InputError(f"{recording.name}: is the same recording as {seen[key]}; leave one out")
        seen[key] = recording.name


def _read(path: Path, reference: bool) -> tuple[Recording, AuditReport, bool]:
    recording, report = clean(read(path))
    return recording.lean(), report, reference


def _source(recording: Recording, report: AuditReport, reference: bool) -> Source:
    notes = tuple(f.text for f in report.findings)
    return Source(recording.name, recording.duration, recording.rate, reference, notes)


def _inputs(taken: Sequence[tuple[Recording, AuditReport, bool]]) -> tuple[Input, ...]:
    return tuple(
        Input(name=rec.name, sha256=rec.source.sha256) for rec, _, _ in taken if rec.source is not None
    )


def _nominal(task: Task, taken: Sequence[tuple[Recording, AuditReport, bool]]) -> tuple[Model, Model | None]:
    """Return the nominal model in its full form, and the task's own where that one is a simplified one."""
    if task.model is None:
        return nominal_model(task.robot, task.robot_hash, task.dof, _locked(taken, task)), None
    if task.model.variant == "full":
        return task.model, None
    return full_of(task.model, task.robot, task.robot_hash), task.model


def _locked(taken: Sequence[tuple[Recording, AuditReport, bool]], task: Task) -> tuple[float, ...]:
    """Angles (rad) of the joints that are left out: where they stood on the whole."""
    beyond = len(task.robot.joint) - task.dof
    wide = [
        rec.q[:, task.dof : len(task.robot.joint)]
        for rec, _, _ in taken
        if rec.joints >= len(task.robot.joint)
    ]
    if beyond <= 0:
        return ()
    return tuple(float(x) for x in np.median(np.concatenate(wide), axis=0)) if wide else (0.0,) * beyond
