"""Physics as oracle: generated code, integrated, keeps its energy and never gains any from friction."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from residuum.codegen.generate import generate
from residuum.codegen.load import load_text
from residuum.robots import load_robot
from residuum.robots.model import TermData
from residuum.symbolic.nominal import nominal_model


def simulate(module, seconds, friction, rtol):
    n = module.DOF
    rest = np.zeros(n)

    def slope(_, y):
        q, qd = y[:n], y[n:]
        torque = -module.inverse_dynamics(q, qd, rest) - (module.friction(q, qd) if friction else 0)
        return np.concatenate([qd, np.linalg.solve(module.mass_matrix(q), torque)])

    # Away from hanging or standing upright, all joints moving.
    start = np.concatenate([np.full(n, 0.3), np.full(n, 0.5)])
    done = solve_ivp(slope, (0, seconds), start, method="DOP853", rtol=rtol, atol=1e-12)
    kinetic, potential = module.energy(done.y[:n].T, done.y[n:].T)
    return kinetic, kinetic + potential


@pytest.mark.slow
@pytest.mark.parametrize("dof", [1, 2, 3, 4, 5, 6])
def test_energy_is_kept_for_20_seconds(dof, generated, capsys) -> None:
    module = load_text(generated("ur5e", dof).files["observer.py"])
    kinetic, total = simulate(module, 20.0, friction=False, rtol=3e-13)
    drift = np.abs(total - total[0]).max() / kinetic.max()
    with capsys.disabled():
        print(f"\n{dof} joints, 20 s: energy drift {drift:.1e} of {kinetic.max():.0f} J")
    assert drift <= 1e-8


def test_friction_never_gains_energy() -> None:
    model = nominal_model(*load_robot("ur5e"), 3)
    terms = [TermData(name="coulomb", joint=j, parameters={"Fc": 5.0, "width": 0.05}) for j in (1, 2, 3)] + [
        TermData(name="viscous", joint=j, parameters={"Fv": 6.0}) for j in (1, 2, 3)
    ]
    module = load_text(generate(model.model_copy(update={"term": tuple(terms)})).files["observer.py"])
    _, total = simulate(module, 3.0, friction=True, rtol=1e-9)
    assert np.all(np.diff(total) <= 1e-6)
    assert total[-1] < total[0] - 10


@pytest.mark.parametrize("dof", range(1, 7))
def test_mass_matrix_is_symmetric_and_positive(dof, generated) -> None:
    module = load_text(generated("ur5e", dof).files["observer.py"])
    mass = module.mass_matrix(np.random.default_rng(0).uniform(-3, 3, (200, dof)))
    assert np.allclose(mass, np.swapaxes(mass, -1, -2), rtol=0, atol=1e-13)
    assert np.linalg.eigvalsh(mass).min() > 0


def test_gravity_is_the_slope_of_the_potential(generated) -> None:
    module = load_text(generated("ur10e", 6).files["observer.py"])
    q = np.random.default_rng(0).uniform(-3, 3, (20, 6))
    for i in range(6):
        step = np.zeros(6)
        step[i] = 1e-5
        difference = (module.energy(q + step, 0 * q)[1] - module.energy(q - step, 0 * q)[1]) / 2e-5
        assert np.allclose(difference, module.gravity(q)[:, i], atol=1e-6)
