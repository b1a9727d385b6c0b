"""How fast the interpreter runs the six-joint guard, and what a step of it costs.

python benchmarks/guard.py [SECONDS]: controller time, 10 s unless given; goal: under twice that on the clock.
"""

import sys
import time

import numpy as np

from residuum.codegen.functions import listings, symbolic_model
from residuum.codegen.generate import urscripts
from residuum.codegen.guard import guard_size
from residuum.codegen.options import DETECTORS, Options
from residuum.robots import load_robot
from residuum.robots.model import TermData, Thresholds
from residuum.symbolic.nominal import nominal_model
from residuum.urscript import Machine, RecordedWorld

FRICTION = (("coulomb", {"Fc": 7.25}), ("viscous", {"Fv": 9.125}))


def swing(seconds: float) -> RecordedWorld:
    """All joints at rest for a second, then swinging, with currents too small for a detection."""
    t = np.arange(0.0, seconds, 0.002)[:, None]
    t = np.maximum(t - 1.0, 0.0)
    noise = np.random.default_rng(0).normal(0.0, 0.02, (len(t), 6))
    start = np.array([0.3, -np.pi / 2, 0.0, -np.pi / 2, 0.0, 0.0])
    q = start + 0.05 * (1 - np.cos(t))
    return RecordedWorld(q, np.gradient(q, 0.002, axis=0), noise)


def main(seconds: float = 10.0) -> None:
    """Print a table: one row a detector."""
    model = nominal_model(*load_robot("ur5e"), 6)
    terms = [TermData(name=n, joint=j, parameters=p) for j in range(1, 7) for n, p in FRICTION]
    limits = Thresholds(static=(1e6,) * 6)
    symbolic = symbolic_model(model.model_copy(update={"term": tuple(terms), "thresholds": limits}))
    found = listings(symbolic)
    print(f"six joints, Coulomb and viscous friction, {seconds:g} s of controller time")
    print("detector    bytes  assignments  operations/step  time/s")
    for detector in DETECTORS:
        text = urscripts(symbolic, found, Options(detector=detector))["collision_guard.script"]
        world = swing(seconds)
        begin = time.perf_counter()
        machine = Machine(text, world)
        frames = machine.run(round(seconds / 0.002))
        spent = time.perf_counter() - begin
        size = guard_size(text)
        print(
            f"{detector:10} {size.size_in_bytes:6} {size.assignments:12} {size.operations:16} {spent:7.2f}"
            f"   {frames} steps, state {world.outputs['integer', 24]}, reason {world.outputs.get(('integer', 25))}"
        )


if __name__ == "__main__":
    main(*map(float, sys.argv[1:]))
