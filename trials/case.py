"""One case: a robot, motions, perhaps something hidden, and the recordings that come of it."""

from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import InputError
from ..robots import Robot, load_robot
from ..virtual import Motion, Plant, Run, simulate
from ..virtual.plant import Thermal
from . import catalogue, healthy, paths, sizing
from .plan import Outline
from .scene import Drawn, Scene, add

Array = npt.NDArray[np.float64]
SMALLEST = 0.15  # of the residual's rms; what stays below is drawn anew
SHORT = 0.4  # part of each recording that is simulated to find a size
CLOSE = 0.15  # relative error of the size that is good enough
STEPS = 2  # corrections at most
TRIES = 12
PLANNED = 3  # tries with the effect that the outline names, before it may be any


@dataclass(frozen=True)
class Case:
    """The runs of a case, and its truth as it is sealed."""

    observed: list[Run]
    reference: list[Run]
    truth: dict[str, Any]


@dataclass(frozen=True)
class Bench:
    """What one case is simulated with: robot, healthy plant, motions, heat and seeds of each recording."""

    robot: Robot
    rate: int
    plant: Plant
    motions: tuple[Motion, ...]
    heat: tuple[Thermal, ...]
    seeds: tuple[int, ...]

    def run(self, effects: tuple[tuple[Drawn, float], ...] = (), part: float = 1.0) -> list[Run]:
        """Simulate all recordings (their first part) with effects of given sizes."""
        return [
            simulate(
                self.robot,
                self.with_effects(k, effects),
                paths.cut(motion, part * motion.duration) if part < 1.0 else motion,
                self.rate,
                self.seeds[k],
            )
            for k, motion in enumerate(self.motions)
        ]

    def with_effects(self, k: int, effects: tuple[tuple[Drawn, float], ...]) -> Plant:
        """Return the plant of recording k."""
        plant = add(self.plant, {"thermal": self.heat[k]})
        for drawn, size in effects:
            plant = add(plant, drawn.build(size, k))
        return plant


def make(outline: Outline) -> Case:
    """Simulate a case; everything random comes from the outline's seed and number."""
    rng = np.random.default_rng([outline.seed, 1, outline.number])
    robot, _ = load_robot(outline.robot)
    plant = (healthy.rich if outline.reference else healthy.plain)(robot, rng)
    bench = _bench(robot, outline, plant, rng, None)
    same_path = bool(rng.random() < 1 / 3)
    before = _bench(robot, outline, plant, rng, bench.motions if same_path else None)
    well = bench.run()
    scale = sizing.scale_of(robot, well, outline.rate)
    scene = Scene(robot, bench.motions, healthy.factory(robot), rng, outline.reference)
    hidden, observed, rejected = _shown(outline, bench, scene, well, scale)
    ratio = sizing.ratios(robot, scale, observed.runs, well, outline.rate)
    survives = sizing.survives(robot, observed.runs, well, outline.rate)
    truth = {
        "case": outline.name, "kind": outline.kind, "robot": outline.robot, "rate": outline.rate,
        "reference": outline.reference, "same_path": same_path and outline.reference,
        "effects": observed.effects, "size": float(ratio.max()) if hidden else 0.0,
        "ratio": _numbers(ratio) if hidden else [0.0] * len(ratio),
        "beside_friction": _numbers(survives) if hidden else [],
        "residual": {"noise": _numbers(scale.noise), "misfit": _numbers(scale.misfit)},
        "start_temperatures": [list(heat.start) for heat in bench.heat],
        "rejected": rejected, "healthy": plant.model_dump(mode="json", exclude_defaults=True),
    }  # fmt: skip
    return Case(observed.runs, before.run() if outline.reference else [], truth)


@dataclass(frozen=True)
class Hidden:
    """An effect with the size that should reach its target."""

    drawn: Drawn
    target: float
    size: float


@dataclass(frozen=True)
class Observed:
    """The runs with everything hidden in them, and what it was."""

    runs: list[Run]
    effects: list[dict[str, Any]]


def _bench(
    robot: Robot, outline: Outline, plant: Plant, rng: np.random.Generator, same: tuple[Motion, ...] | None
) -> Bench:
    count = len(same) if same else int(rng.integers(2, 4))
    path = same or tuple(paths.recording(robot, rng, outline.seconds) for _ in range(count))
    heat = tuple(healthy.temperatures(rng, count))
    seeds = tuple(int(s) for s in rng.integers(2**31, size=count))
    return Bench(robot, outline.rate, plant, path, heat, seeds)


def _shown(
    outline: Outline, bench: Bench, scene: Scene, well: list[Run], scale: sizing.Scale
) -> tuple[list[Hidden], Observed, list[str]]:
    """Hide something and simulate it; what the simulator cannot bear is drawn anew."""
    rejected: list[str] = []
    for _ in range(TRIES):
        hidden, unseen = _hide(outline, bench, scene, well, scale)
        rejected += unseen
        if not hidden and outline.kind != "clean":
            continue
        with suppress(FloatingPointError, InputError):
            observed = _final(bench, hidden, well, scale)
            if all(effect["size"] >= SMALLEST for effect in observed.effects):
                return hidden, observed, rejected
        rejected += [h.drawn.name for h in hidden]
    raise FloatingPointError(f"case {outline.name}: nothing that was drawn can be simulated: {rejected}")


def _hide(
    outline: Outline, bench: Bench, scene: Scene, well: list[Run], scale: sizing.Scale
) -> tuple[list[Hidden], list[str]]:
    """Draw what the case hides, and its sizes; return also what was drawn and could not be seen."""
    if outline.kind == "clean":
        return [], []
    outside = outline.kind == "outside"
    kinds = list(catalogue.OUTSIDE) if outside else catalogue.names(outline.reference)
    hidden: list[Hidden] = []
    rejected: list[str] = []
    for k in range(TRIES):
        planned = outline.first and k < PLANNED and not hidden
        name = outline.first if planned else str(scene.rng.choice(kinds))
        target = float(scene.rng.choice(catalogue.OUTSIDE_SIZES if outside else catalogue.SIZES))
        drawn = (catalogue.OUTSIDE if outside else catalogue.CATALOGUE)[name](scene)
        found = _sized(drawn, target, bench, well, scale) if _goes_with(drawn, hidden) else None
        if found is None:
            rejected.append(name)
            continue
        hidden.append(found)
        if len(hidden) == 1 + outline.two:
            break
    return hidden, rejected


def _goes_with(drawn: Drawn, hidden: list[Hidden]) -> bool:
    """Say whether an effect may stand beside others: another name, and one gear to a joint."""
    gears = {"joint_elasticity", "backlash"}
    return not any(
        h.drawn.name == drawn.name
        or ({h.drawn.name, drawn.name} <= gears and set(h.drawn.joints) & set(drawn.joints))
        for h in hidden
    )


def _sized(drawn: Drawn, target: float, bench: Bench, well: list[Run], scale: sizing.Scale) -> Hidden | None:
    """Return the effect at the size that its first simulation promises, or None when it cannot be shown."""
    part = 1.0 if drawn.episodic else SHORT
    try:
        runs = bench.run(((drawn, drawn.start),), part)
    except (FloatingPointError, InputError):
        return None
    ratio = float(sizing.ratios(bench.robot, scale, runs, well, bench.rate).max())
    size = drawn.bound(drawn.start * target / ratio) if ratio > 0.0 else drawn.start
    if ratio * size / drawn.start < SMALLEST:
        return None
    return Hidden(drawn, target, size)


def _final(bench: Bench, hidden: list[Hidden], well: list[Run], scale: sizing.Scale) -> Observed:
    """Simulate what is recorded; a single effect far off its target is corrected."""
    if not hidden:
        return Observed(well, [])
    runs = bench.run(tuple((h.drawn, h.size) for h in hidden))
    if len(hidden) > 1:
        alone = [bench.run(((h.drawn, h.size),), 1.0 if h.drawn.episodic else SHORT) for h in hidden]
        sizes = [sizing.ratios(bench.robot, scale, a, well, bench.rate) for a in alone]
        return Observed(runs, [_describe(h, h.size, r) for h, r in zip(hidden, sizes, strict=True)])
    (only,) = hidden
    ratio = sizing.ratios(bench.robot, scale, runs, well, bench.rate)
    points = [(only.size, float(ratio.max()))]
    for _ in range(STEPS):
        better = _corrected(only, points)
        if better == points[-1][0]:
            break
        try:
            again = bench.run(((only.drawn, better),))
        except (FloatingPointError, InputError):  # the size at hand is good enough then
            break
        runs, ratio = again, sizing.ratios(bench.robot, scale, again, well, bench.rate)
        points.append((better, float(ratio.max())))
    return Observed(runs, [_describe(only, points[-1][0], ratio)])


def _corrected(hidden: Hidden, points: list[tuple[float, float]]) -> float:
    """Return the size that reaches the target, by a power law through the last two (size, ratio)."""
    size, ratio = points[-1]
    if ratio <= 0.0 or abs(ratio / hidden.target - 1.0) < CLOSE:
        return size
    power = 1.0
    if len(points) > 1:
        first, was = points[-2]
        power = float(np.clip(np.log(ratio / was) / np.log(size / first), 0.4, 2.5))
    return hidden.drawn.bound(size * float((hidden.target / ratio) ** (1.0 / power)))


def _describe(hidden: Hidden, size: float, ratio: Array) -> dict[str, Any]:
    drawn = hidden.drawn
    return {
        "effect": drawn.name, "joints": list(drawn.joints), "target": hidden.target,
        "size": float(ratio.max()), "joint": int(ratio.argmax()) + 1,
        "limited": bool(size in (drawn.low, drawn.high)),
        "parameters": drawn.truth(size), **drawn.notes,
    }  # fmt: skip


def _numbers(values: Array) -> list[float]:
    return [float(f"{v:.4g}") for v in values]
