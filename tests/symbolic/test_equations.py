"""The SymPy side: energies, gradient, base parameters, M, C, g, checked by what physics demands."""

import numpy as np
import pytest
import sympy as sp
from peers import PinocchioArm

from residuum.robots import load_robot
from residuum.symbolic.arm import symbolic_arm
from residuum.symbolic.base_parameters import base_energies, base_parameters, inherited_part
from residuum.symbolic.chain import Chain, gradient
from residuum.symbolic.equations import coriolis_matrix, dynamics, gravity_vector, mass_matrix
from residuum.symbolic.inertia import PARAMETER_NAMES, Inertia
from residuum.symbolic.nominal import nominal_model, robot_arm


def published(dof: int, robot_name: str = "ur5e"):
    """Dynamics, and every constant's number."""
    model = nominal_model(*load_robot(robot_name), dof)
    arm = robot_arm(model)
    values = {sp.Symbol(k): v.value for k, v in model.base.items() if v.value}
    return dynamics(base_energies(arm, values)), dict(arm.values) | values


def number(expression, d, values, q, qd):
    at = dict(values) | dict(zip(d.q, q, strict=True)) | dict(zip(d.qd, qd, strict=True))
    return np.array(sp.lambdify(list(at), expression, cse=True)(*map(float, at.values())), dtype=float)


@pytest.mark.parametrize("dof", [1, 2, 3, 4, 6])
def test_matrices_agree_with_pinocchio_and_with_one_another(dof) -> None:
    d, values = published(dof)
    robot, _ = load_robot("ur5e")
    peer = PinocchioArm(robot, dof)
    mass, gravity = mass_matrix(d), gravity_vector(d)
    coriolis = coriolis_matrix(mass, d.q, d.qd)
    random = np.random.default_rng(dof)
    for _ in range(3):
        q, qd = random.uniform(-3, 3, dof), random.uniform(-2, 2, dof)
        M, C, g = (number(x, d, values, q, qd) for x in (mass, coriolis, gravity))
        assert np.allclose(M, peer.mass_matrix(q), rtol=1e-10, atol=1e-11)
        assert np.allclose(g.ravel(), peer.gravity(q), rtol=1e-10, atol=1e-10)
        assert np.allclose(C.T @ qd - g.ravel(), peer.beta(q, qd), rtol=1e-10, atol=1e-10)
        assert np.allclose(C @ qd, peer.inverse_dynamics(q, qd, 0 * q) - g.ravel(), rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize("dof", [2, 3])
def test_rate_of_the_mass_matrix_is_c_plus_its_transpose(dof) -> None:
    d, _ = published(dof)
    mass = mass_matrix(d)
    coriolis = coriolis_matrix(mass, d.q, d.qd)
    rate = sum((mass.diff(q) * qd for q, qd in zip(d.q, d.qd, strict=True)), sp.zeros(dof))
    assert (rate - coriolis - coriolis.T).applyfunc(sp.expand).is_zero_matrix
    assert (mass - mass.T).applyfunc(lambda x: sp.expand(x, trig=True)).applyfunc(sp.simplify).is_zero_matrix


def test_expressions_can_be_printed_substituted_and_differentiated() -> None:
    d, _ = published(3)
    gravity = gravity_vector(d)
    assert str(sp.expand(gravity[2])).count("cos(q2 + q3)") == 1
    flat = gravity.subs({d.q[1]: 0, d.q[2]: 0})
    assert flat.free_symbols.isdisjoint(d.q)
    assert gravity[1].diff(d.q[0]) == 0


def test_gradient_of_a_rotation_finds_the_other_component() -> None:
    chain = Chain()
    angle, x, y = sp.symbols("angle x y")
    c, s = chain.rotation("1", angle)
    u = chain.define("u", c * x + s * y)
    v = chain.define("v", c * y - s * x)
    grown, (slope,) = gradient(chain, [u**2 / 2], [angle])
    assert slope == u * v
    assert len(list(grown)) == len(list(chain))


def test_gradient_equals_sympys_own() -> None:
    chain = Chain()
    a, b = sp.symbols("a b")
    c, s = chain.rotation("1", a)
    inner = chain.define("inner", c * b + s)
    outer = chain.define("outer", inner**2 + b * inner)
    term = outer * s + inner
    grown, slopes = gradient(chain, [term], [a, b])
    plain = chain.inline(term)
    for slope, x in zip(slopes, (a, b), strict=True):
        assert sp.expand(grown.inline(slope) - plain.diff(x)) == 0


def test_a_revolute_joint_passes_on_three_parameters() -> None:
    """Mass, first moment along the axis, and equal inertias across it: solved for, not assumed."""
    names = [{n for n, x in zip(PARAMETER_NAMES, v, strict=True) if x} for v in inherited_part()]
    assert sorted(map(sorted, names)) == [["M"], ["MZ"], ["XX", "YY"]]


@pytest.mark.parametrize(("dof", "gravity", "links", "rotors"), [
    (3, (0, 0, -9.81), 15, 1),
    (6, (0, 0, -9.81), 36, 4),
    (6, (1.0, 0.5, -9.7), 38, 4),
])  # fmt: skip
def test_number_of_base_parameters_is_the_rank_of_the_regressor(dof, gravity, links, rotors) -> None:
    """The rank of Pinocchio's regressor, with a column a rotor, is how many there can be."""
    import pinocchio as pin

    robot, _ = load_robot("ur5e")
    robot = robot.model_copy(update={"gravity": gravity})
    found = base_parameters(symbolic_arm([(j.a, j.d, j.alpha, j.offset) for j in robot.joint[:dof]], gravity))
    assert sum(not k.name.startswith("IA") for k in found) == links
    assert sum(k.name.startswith("IA") for k in found) == rotors
    peer = PinocchioArm(robot.model_copy(update={"joint": robot.joint[:dof]}), dof)
    random = np.random.default_rng(0)
    rows = []
    for _ in range(60):
        q, qd, qdd = (random.uniform(-3, 3, dof) for _ in range(3))
        regressor = pin.computeJointTorqueRegressor(peer.model, peer.data, q, qd, qdd)
        rows.append(np.hstack([regressor, np.diag(qdd)]))
    assert np.linalg.matrix_rank(np.vstack(rows), tol=1e-8) == links + rotors


def test_moving_an_inertia_there_and_back() -> None:
    symbols = sp.symbols(" ".join(PARAMETER_NAMES))
    body = Inertia.from_parameters(symbols)
    turn = sp.Matrix([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    shift = sp.Matrix(sp.symbols("x y z"))
    back = body.moved(turn, shift).moved(turn.T, -turn.T * shift)
    assert all(sp.expand(a - b) == 0 for a, b in zip(back.parameters, symbols, strict=True))
