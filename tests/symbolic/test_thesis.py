"""The thesis' model: its rows (eq. 3.1.9-3.1.10), and what they leave out."""

import numpy as np
import sympy as sp

from residuum.codegen.load import load_text
from residuum.symbolic.equations import gravity_vector, mass_matrix
from residuum.symbolic.thesis import thesis_dynamics

m1, m2, m3, L2, l2, l3, I1, I2, I3, Im, rho, g = sp.symbols("m1 m2 m3 L2 l2 l3 I1 I2 I3 Im rho g")
d1, d2, d3 = sp.symbols("d1 d2 d3")
q = sp.symbols("q1:4")


def same(found, expected) -> bool:
    return sp.simplify(sp.expand(found - expected, trig=True)) == 0


def test_mass_matrix_is_the_thesis() -> None:
    mass = mass_matrix(thesis_dynamics())
    reach = L2 * sp.cos(q[1]) + l3 * sp.cos(q[1] + q[2])
    across, along = m2 * l2 * sp.cos(q[1]) + m3 * reach, m1 * d1 + m2 * d2 + m3 * d3
    assert same(mass[0, 0], (along**2 + across**2) / (m1 + m2 + m3) + I1 + Im * rho**2)
    coupling = m3 * L2 * l3 * sp.cos(q[2])
    assert same(mass[1, 1], m2 * l2**2 + m3 * (L2**2 + l3**2) + 2 * coupling + I2 + Im * rho**2)
    assert same(mass[1, 2], m3 * l3**2 + coupling)
    assert same(mass[2, 2], m3 * l3**2 + I3 + Im * rho**2)
    assert mass[0, 1] == mass[0, 2] == 0


def test_gravity_is_the_thesis() -> None:
    found = gravity_vector(thesis_dynamics())
    outer = m3 * l3 * sp.cos(q[1] + q[2])
    assert found[0] == 0
    assert same(found[1], -g * (m2 * l2 * sp.cos(q[1]) + m3 * L2 * sp.cos(q[1]) + outer))
    assert same(found[2], -g * outer)


def test_joint_one_knows_no_velocity_torque(generated) -> None:
    """tau1 = M11 q1'' (eq. 3.1.9), although M11 changes with the pose."""
    module = load_text(generated("ur5e", 3, "thesis").files["observer.py"])
    at, speed, still = np.array([0.1, -1.0, 0.7]), np.array([0.5, -0.4, 0.9]), np.zeros(3)
    assert module.inverse_dynamics(at, speed, still)[0] == 0
    assert module.beta(at, speed)[0] == 0
    full = load_text(generated("ur5e", 3).files["observer.py"])
    assert abs(full.inverse_dynamics(at, speed, still)[0]) > 0.1


def test_absent_wrist_shows_in_gravity(generated) -> None:
    """3.035 kg beyond the elbow are absent, so the thesis' elbow carries less."""
    at = np.zeros(3)
    thesis, full = (
        load_text(generated("ur5e", 3, v).files["observer.py"]).gravity(at) for v in ("thesis", "full")
    )
    assert abs(thesis[2]) < abs(full[2])
    assert abs(thesis[1]) < abs(full[1])
