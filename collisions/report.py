"""The text of a campaign's tables, in one piece."""

from collections.abc import Mapping, Sequence

from ..robots import Robot
from . import tables
from .campaign import Row
from .cells import scene
from .free_hour import Quiet
from .in_script import REACTIONS, Guarded
from .models import Known


def text(
    robot: Robot,
    known: Sequence[Known],
    detector: str,
    gain: float,
    campaign: Sequence[Row],
    late: Sequence[Row],
    guarded: Sequence[tuple[Row, Guarded]],
    further: Sequence[Row],
    hours: Mapping[tuple[str, str], Quiet],
) -> str:
    """Return all tables as Markdown; parts that were not run are left out."""
    parts = ["# Collision experiments on the virtual arm\n", _about(robot, known, detector, gain, campaign)]
    parts += ["## The thesis' campaign\n", tables.verdict(campaign)]
    parts.append("Ours, and in brackets those of Gylling 2019 (tables 5 to 8; UR: tables 9 and 10).\n")
    parts += [tables.thesis_tables(campaign), "### Order of the strategies\n", tables.ordering(campaign)]
    if late:
        parts += ["## The same robot and foam, detected as late as in the thesis\n"]
        parts += [tables.thesis_tables(late), tables.ordering(late)]
    if guarded:
        parts += ["## The generated URScript guard in closed loop\n", _guarded(guarded)]
    if further:
        parts += ["## Beyond the thesis\n", tables.beyond_table(further)]
    if hours:
        parts += ["## Collision-free motion\n", tables.hour_table(hours)]
    return "\n".join(parts)


def _about(robot: Robot, known: Sequence[Known], detector: str, gain: float, campaign: Sequence[Row]) -> str:
    face = scene(robot, campaign[0].cell).obstacle
    lines = [
        f"Robot: {robot.name}, simulated. Detector: {detector}; gain of the thesis' detector {gain:g} 1/s.",
        f"Into {campaign[0].cell.obstacle}: {face.stiffness:g} N/m, {face.damping:g} N s/m (assumed; the",
        "thesis gives none). Impulse over 1 s after contact; stop time from contact until the joint",
        "stays below 0.01 rad/s for 50 ms. Limits in Nm, one a joint:\n",
    ]
    cells = []
    for each in known:
        limits = each.model.thresholds
        if limits is None:
            continue
        rows = {"constant": limits.static_only or limits.static, "current difference": each.current}
        cells += [[each.name, what, *(f"{x:.2f}" for x in row)] for what, row in rows.items()]
    joints = [str(k) for k in range(1, len(robot.joint) + 1)]
    return "\n".join(lines) + "\n" + tables.markdown(["knows", "limit", *joints], cells)


def _guarded(found: Sequence[tuple[Row, Guarded]]) -> str:
    header = ["joint", "strategy", "states told", "delay, ms", "impulse, Ns", "stop, ms", "peak, N"]
    cells = []
    for row, run in found:
        x = run.figures
        cells.append([
            f"{row.cell.joint} {row.cell.pace}", REACTIONS[row.strategy], " ".join(map(str, run.states)),
            tables.show(1e3 * x.delay), tables.show(x.impulse, ".2f"), tables.show(1e3 * x.stop_time),
            tables.show(x.peak),
        ])  # fmt: skip
    return tables.markdown(header, cells)
