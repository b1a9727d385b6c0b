"""The stages of a trial in order; each can be run alone and goes on where it stopped."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ..errors import InputError
from .answering import Answer, answer_all
from .files import read_json, write_json
from .generate import generate
from .plan import outlines
from .pool import Report
from .scoring import score
from .sealing import seal


@dataclass(frozen=True)
class Trial:
    """How many cases, drawn from which seed, with recordings of how many seconds (from, to)."""

    cases: int
    seed: int
    seconds: tuple[float, float] = (30.0, 60.0)


def generate_stage(out: Path, trial: Trial, workers: int = 1, report: Report | None = None) -> None:
    """Simulate all cases and seal them.

    Raises InputError when out holds another trial.
    """
    _same(out, trial)
    generate(out, outlines(trial.cases, trial.seed, trial.seconds), workers, report)
    seal(out)


def answer_stage(out: Path, answer: Answer, workers: int = 1, report: Report | None = None) -> None:
    """Answer all sealed cases without their truths. Raises InputError when they are not sealed."""
    if not (out / "seal.txt").exists():
        raise InputError(f"{out}: no seal.txt: generate the cases first")
    answer_all(out, answer, workers, report)


def score_stage(out: Path) -> dict[str, Any]:
    """Reveal and score; see score."""
    return score(out)


def _same(out: Path, trial: Trial) -> None:
    path, data = out / "trial.json", asdict(trial) | {"seconds": list(trial.seconds)}
    if not path.exists():
        write_json(path, data)
    elif read_json(path) != data:
        raise InputError(f"{path}: another trial is here ({read_json(path)}); give another --out")
