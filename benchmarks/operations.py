"""Operations of momentum and beta in the generated code: which links, which parameters, which robot.

python benchmarks/operations.py [--json FILE]

Counted: every multiplication, division, addition, subtraction, negation and function call.
"""

import argparse
import json
from pathlib import Path

from residuum.codegen.functions import SymbolicModel, operation_count, symbolic_model
from residuum.robots import load_robot, robot_names
from residuum.symbolic.nominal import nominal_model

Row = tuple[str, int | None, int]


def model(robot: str, dof: int, wrist: str = "locked") -> SymbolicModel:
    """Return a robot's published model as equations."""
    data, digest = load_robot(robot)
    return symbolic_model(nominal_model(data, digest, dof, wrist=wrist))


def all_nonzero(found: SymbolicModel) -> SymbolicModel:
    """Return the model with a number in every base parameter, rotors kept."""
    bodies = found.with_all_parameters().model.base
    rotors = {k: v for k, v in found.model.base.items() if k.startswith("IA")}
    return symbolic_model(found.model.model_copy(update={"base": bodies | rotors, "term": ()}))


def both(title: str, found: SymbolicModel) -> Row:
    """Count a model without rotors and with them."""
    return title, operation_count(found.without_rotors()), operation_count(found)


def variants(robot: str) -> list[Row]:
    """Count what one robot's models may keep or drop."""
    three, six = model(robot, 3), model(robot, 6)
    return [
        both("links 1-3 alone", model(robot, 3, wrist="absent")),
        both("3 joints, wrist lumped into link 3", three),
        both("6 joints", six),
        both("3 joints, every base parameter nonzero", all_nonzero(three)),
        both("6 joints, every base parameter nonzero", all_nonzero(six)),
    ]


def robots() -> list[Row]:
    """Count every built-in robot as gen-model writes it."""
    return [
        (f"{name}, {dof} joints", None, operation_count(model(name, dof)))
        for name in robot_names()
        for dof in (3, 6)
    ]


def table(rows: list[Row]) -> str:
    """Return a Markdown table."""
    lines = ["| model | without rotors | with rotors |", "|---|---:|---:|"]
    return "\n".join(lines + [f"| {t} | {'' if a is None else a} | {b} |" for t, a, b in rows])


def main() -> None:
    """Count and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", type=Path, metavar="FILE")
    options = parser.parse_args()
    one, every = variants("ur5e"), robots()
    print(f"ur5e:\n\n{table(one)}\n\nas generated:\n\n{table(every)}")
    if options.json:
        options.json.write_text(json.dumps({"ur5e": one, "robots": every}, indent=1))


if __name__ == "__main__":
    main()
