"""The answering stage: it sees recordings and the robot's name, nothing else."""

import time
from collections.abc import Callable
from concurrent.futures import as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import InputError
from .files import read_json, write_json, write_text
from .pool import Report, pool


@dataclass(frozen=True)
class CaseFiles:
    """What may be known of a case: files of the observed and of the healthy robot, and its name."""

    recordings: tuple[Path, ...]
    reference: tuple[Path, ...]
    robot: str


Answer = Callable[[CaseFiles], dict[str, Any]]  # -> the content of findings.json


def case_files(folder: Path) -> CaseFiles:
    """Return the files of one case folder. Raises InputError when its label cannot be read."""
    label = read_json(folder / "case.json")
    recordings, reference = (tuple(folder / n for n in label[k]) for k in ("recordings", "reference"))
    return CaseFiles(recordings, reference, label["robot"])


def answer_all(
    out: Path, answer: Answer, workers: int = 1, report: Report | None = None, answers: str = "answers"
) -> None:
    """Answer every case of out/cases that has no answer yet: out/answers/NNN.json, seconds beside it.

    answer must be a function of a module when there are several workers. A case that fails gets
    an answer without findings that says so; it is scored like any other.
    """
    folders = sorted(f for f in (out / "cases").iterdir() if (f / "case.json").exists())
    missing = [f for f in folders if not (out / answers / f"{f.name}.json").exists()]
    done = len(folders) - len(missing)
    with pool(workers) as executor:
        jobs = [executor.submit(answer_one, out / answers, f, answer) for f in missing]
        for job in as_completed(jobs):
            job.result()
            done += 1
            if report:
                report(done, len(folders))


def answer_one(out: Path, folder: Path, answer: Answer) -> None:
    """Answer the case in a folder and write out/NNN.json."""
    start = time.perf_counter()
    try:
        found = answer(case_files(folder))
    except ImportError:  # the program is not whole: no case's fault
        raise
    except InputError as error:
        found = _failed(str(error))
    except Exception as error:
        found = _failed(f"{type(error).__name__}: {error}")
    write_text(out / f"{folder.name}.seconds", f"{time.perf_counter() - start:.1f}\n")
    write_json(out / f"{folder.name}.json", found)


def _failed(why: str) -> dict[str, Any]:
    return {"schema": 1, "verdict": "bad_data", "findings": [], "where": [], "error": why}
