"""The generated NumPy observer: equation 2.2.11, its sign, its interface."""

import ast

import numpy as np
import pytest

from residuum.codegen.load import load_text


@pytest.fixture(scope="module")
def module(generated):
    return load_text(generated("ur5e", 6).files["observer.py"])


def motion(dof: int, samples: int = 2000, dt: float = 0.002):
    """A smooth motion: q, qd, qdd."""
    t = np.arange(samples)[:, None] * dt
    rate = 2 * np.pi * (0.2 + 0.1 * np.arange(dof))
    return np.sin(rate * t), rate * np.cos(rate * t), -(rate**2) * np.sin(rate * t)


def test_imports_numpy_alone(generated) -> None:
    tree = ast.parse(generated("ur5e", 6).files["observer.py"])
    names = [a.name for n in ast.walk(tree) if isinstance(n, ast.Import | ast.ImportFrom) for a in n.names]
    assert names == ["numpy"]


def test_residual_is_the_external_torque_with_its_sign(module) -> None:
    q, qd, qdd = motion(6)
    external = np.array([3.0, -5.0, 2.0, -1.0, 0.5, -0.25])
    current = (module.inverse_dynamics(q, qd, qdd) - external) / module.GAINS
    residual = module.Observer(gain=50.0).run(q, qd, current)
    assert np.allclose(residual[-1], external, atol=0.05)


def test_residual_rises_as_a_first_order_low_pass(module) -> None:
    q = np.tile([0.1, -1.0, 0.5, 0.2, 0.3, 0.4], (1000, 1))
    step = np.zeros_like(q)
    step[500:, 1] = 10.0
    current = (module.gravity(q) - step) / module.GAINS
    residual = module.Observer(gain=25.0).run(q, np.zeros_like(q), current)
    after = np.arange(1, 501) * 0.002
    assert np.allclose(residual[500:, 1], 10 * (1 - np.exp(-25 * after)), atol=0.25)
    assert np.allclose(residual[:500], 0, atol=1e-9)


def test_is_equation_2_2_11(module) -> None:
    """r(n+1) = K (p(n) - p(0) - T sum [tau + beta + r]): the sum written out."""
    random = np.random.default_rng(0)
    q, qd, current = (np.cumsum(random.normal(0, 0.02, (300, 6)), axis=0) for _ in range(3))
    gain, dt = 40.0, 0.002
    p, beta, tau = module.momentum(q, qd), module.beta(q, qd), module.motor_torque(current)
    r, total = np.zeros(6), np.zeros(6)
    found = module.Observer(gain=gain, dt=dt).run(q, qd, current)
    for n in range(len(q)):
        total += dt * (tau[n] + beta[n] + r)
        r = gain * (p[n] - p[0] - total)
        assert np.allclose(found[n], r, rtol=1e-10, atol=1e-10)


def test_steps_and_runs_and_pieces_are_the_same(module) -> None:
    random = np.random.default_rng(1)
    q, qd, current = (np.cumsum(random.normal(0, 0.02, (400, 6)), axis=0) for _ in range(3))
    whole = module.Observer().run(q, qd, current)
    stepping, pieces = module.Observer(), module.Observer()
    assert np.allclose(
        [stepping.step(*x) for x in zip(q, qd, current, strict=True)], whole, rtol=1e-12, atol=1e-12
    )
    parts = [pieces.run(q[a:b], qd[a:b], current[a:b]) for a, b in ((0, 1), (1, 137), (137, 400))]
    assert np.allclose(np.vstack(parts), whole, rtol=1e-12, atol=1e-12)
    pieces.reset()
    assert np.allclose(pieces.run(q, qd, current), whole)


def test_leading_axes_and_single_states(module) -> None:
    random = np.random.default_rng(2)
    q, qd = random.normal(size=(2, 4, 5, 6)), random.normal(size=(2, 4, 5, 6))
    assert module.momentum(q, qd).shape == (2, 4, 5, 6)
    assert module.mass_matrix(q).shape == (2, 4, 5, 6, 6)
    assert np.allclose(module.mass_matrix(q)[1, 2, 3] @ qd[1, 2, 3], module.momentum(q[1, 2, 3], qd[1, 2, 3]))
    assert module.gravity(q[0, 0, 0].tolist()).shape == (6,)
    assert np.allclose(
        module.momentum(q[0, 0, 0], qd), module.momentum(np.broadcast_to(q[0, 0, 0], qd.shape), qd)
    )
    assert module.momentum(np.empty((0, 6)), np.empty((0, 6))).shape == (0, 6)
    kinetic, potential = module.energy(q, qd)
    assert kinetic.shape == potential.shape == (2, 4, 5)
    assert np.allclose(kinetic, 0.5 * np.sum(module.momentum(q, qd) * qd, axis=-1))


def test_wrong_use_is_said(module) -> None:
    with pytest.raises(ValueError, match="6 expected"):
        module.gravity(np.zeros(3))
    with pytest.raises(ValueError, match="unstable"):
        module.Observer(gain=2000.0)
    with pytest.raises(ValueError, match="positive"):
        module.Observer(dt=-1.0)
