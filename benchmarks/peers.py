"""Other ways to name what is missing, on the cases of a trial, beside ours.

residuum trial --cases 200 --seed 7 --out trial --workers 2
python benchmarks/peers.py trial [--workers 2] [--only bic sindy correlations attempt9 attempt10]

bic: stepwise BIC over candidate columns. sindy: PySINDy's discrepancy model (pip install pysindy).
correlations: the candidate that correlates best. attempt9, attempt10: earlier attempts of this project, from
their description. All get the same files; the scorer is that of the trial. Writes TRIAL/answers_NAME/,
TRIAL/answers_NAME_score.md and TRIAL/peers.md. Like the trial it goes on where it stopped.
"""

import argparse
import sys
from pathlib import Path

from naming.peers import PEERS

from residuum.trials.answering import answer_all
from residuum.trials.scoring import score
from residuum.trials.tables import compare


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("trial", type=Path)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--only", nargs="+", choices=list(PEERS), default=list(PEERS))
    chosen = parser.parse_args()
    scores = {}
    if (chosen.trial / "answers").is_dir():
        scores["residuum"] = score(chosen.trial)
    for name in chosen.only:
        try:
            answer_all(chosen.trial, PEERS[name], chosen.workers, progress(name), answers=f"answers_{name}")
        finally:
            print(file=sys.stderr)
        scores[name] = score(chosen.trial, f"answers_{name}")
    table = compare(scores)
    (chosen.trial / "peers.md").write_text(table)
    print(table)


def progress(name: str):
    return lambda done, of: print(f"\r{name} {done}/{of} ", end="", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
