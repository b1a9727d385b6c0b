"""Writing the cases of a trial: recordings where the answering stage looks, the truth where it does not."""

from concurrent.futures import as_completed
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

from ..virtual import Recording
from ..virtual.recording import FIELDS
from .case import Case, make
from .files import write_json
from .plan import Outline
from .pool import Report, pool

DECIMALS = 6  # as the CSV has


def generate(out: Path, outlines: list[Outline], workers: int = 1, report: Report | None = None) -> None:
    """Write every case that is not there yet: out/cases/NNN/ and, last, out/sealed/NNN.json.

    The same outlines give the same files, whatever the number of workers.
    """
    for name in ("cases", "sealed"):
        (out / name).mkdir(parents=True, exist_ok=True)
    missing = [o for o in outlines if not (out / "sealed" / f"{o.name}.json").exists()]
    done = len(outlines) - len(missing)
    with pool(workers) as executor:
        for future in as_completed([executor.submit(write_case, out, outline) for outline in missing]):
            future.result()
            done += 1
            if report:
                report(done, len(outlines))


def write_case(out: Path, outline: Outline) -> None:
    """Simulate one case and write it."""
    with threadpool_limits(1):  # so that sums do not depend on how many cores there are
        case = make(outline)
    folder = out / "cases" / outline.name
    folder.mkdir(parents=True, exist_ok=True)
    for kind, runs in (("observed", case.observed), ("reference", case.reference)):
        for k, run in enumerate(runs, 1):
            write_parquet(folder / f"{kind}_{k}.parquet", run.recording)
    write_json(folder / "case.json", _label(outline, case))
    write_json(out / "sealed" / f"{outline.name}.json", case.truth)


def write_parquet(path: Path, recording: Recording) -> None:
    """Write a recording under RTDE's column names, rounded as its CSV is."""
    columns = {"timestamp": recording["timestamp"]}
    for name in FIELDS:
        columns |= {f"{name}_{k}": column for k, column in enumerate(recording[name].T)}
    table = pa.table({name: np.round(values, DECIMALS) for name, values in columns.items()})
    pq.write_table(table, path, compression="zstd")


def _label(outline: Outline, case: Case) -> dict[str, object]:
    """Return what the answering stage may know."""
    observed = [f"observed_{k}.parquet" for k in range(1, len(case.observed) + 1)]
    reference = [f"reference_{k}.parquet" for k in range(1, len(case.reference) + 1)]
    return {"robot": outline.robot, "recordings": observed, "reference": reference}
