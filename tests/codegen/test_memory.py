"""Models with terms that remember: NumPy, C and URScript against the SymPy updates in plain Python."""

import ctypes

import numpy as np
import pytest
from guarding import WITHOUT_LIMIT, Printer, Rows, track
from terms_by_hand import motion, parameters, torque_by_hand

from residuum.codegen.check import worst_disagreement
from residuum.codegen.generate import generate
from residuum.codegen.guard import SCRIPTS, guard_size
from residuum.codegen.load import CLibrary, c_compiler, compile_c, load_text
from residuum.robots import load_robot
from residuum.robots.model import TermData, Thresholds
from residuum.symbolic.nominal import nominal_model
from residuum.symbolic.terms import CATALOGUE
from residuum.urscript import Dialect, check
from residuum.urscript.run import Functions

DOF, DT = 3, 0.002
TERMS = tuple(
    TermData(name=name, joint=joint, parameters=parameters(name, seed=10 * joint + k))
    for joint, names in enumerate(
        (
            ("coulomb", "presliding", "delay", "ripple", "ripple"),
            ("presliding", "lag", "elasticity", "backlash", "load_dependent"),
            ("viscous", "backlash", "temperature_exponential", "tanh"),
        ),
        start=1,
    )
    for k, name in enumerate(names)
)


@pytest.fixture(scope="module")
def tree():
    return generate(nominal_model(*load_robot("ur5e"), DOF).model_copy(update={"term": TERMS}))


@pytest.fixture(scope="module")
def module(tree):
    return load_text(tree.files["observer.py"])


@pytest.fixture(scope="module")
def folder(tree, tmp_path_factory):
    if c_compiler() is None:
        pytest.skip("no C compiler")
    path = tmp_path_factory.mktemp("memory")
    for name, text in tree.files.items():
        (path / name).write_text(text)
    compile_c(path, path / "observer.so")
    return path


def by_hand(module, q, qd, hot, dt) -> np.ndarray:
    """Torque of all terms (T, N), each in a Python loop; the rigid body's values are tested elsewhere."""
    momentum, beta = module.momentum(q, qd), module.beta(q, qd)
    carried = np.diff(momentum, axis=0, prepend=momentum[:1]) / dt[:, None] - beta
    gravity = module.gravity(q)
    total = np.zeros(q.shape)
    for data in TERMS:
        j, entry = data.joint - 1, CATALOGUE[data.name]
        load = carried if entry.state else gravity
        total[:, j] += torque_by_hand(
            data.name, data.parameters, q[:, j], qd[:, j], load[:, j], hot[:, j], dt
        )
    return total


def residual_by_hand(module, friction, q, qd, current, dt, gain=25.0) -> np.ndarray:
    momentum, beta = module.momentum(q, qd), module.beta(q, qd)
    residual, rows, before = np.zeros(DOF), [], momentum[0]
    for k in range(len(q)):
        drive = module.GAINS * current[k] - friction[k] + beta[k]
        residual = (1 - gain * dt[k]) * residual + gain * (momentum[k] - before) - gain * dt[k] * drive
        before = momentum[k]
        rows.append(residual)
    return np.array(rows)


def data(samples: int = 300, jitter: bool = False):
    made = motion(samples, DOF, seed=5)
    hot = made["temperature"]
    dt = made["dt"] if jitter else np.full(samples, DT)
    current = np.random.default_rng(0).normal(0, 2, (samples, DOF))
    return made["q"], made["qd"], hot, dt, current


def close(found, expected) -> None:
    assert np.abs(found - expected).max() <= 1e-12 * max(1.0, np.abs(expected).max())


@pytest.mark.parametrize("jitter", [False, True])
def test_numpy_is_the_loop_over_sympys_updates(module, jitter) -> None:
    q, qd, hot, dt, current = data(jitter=jitter)
    friction = by_hand(module, q, qd, hot, dt)
    close(module.friction(q, qd, temperature=hot, dt=dt), friction)
    found = module.Observer().run(q, qd, current, temperature=hot, dt=dt)
    close(found, residual_by_hand(module, friction, q, qd, current, dt))


def test_numpys_steps_and_pieces_are_its_run(module) -> None:
    q, qd, hot, _, current = data(60)
    whole, single, pieces = module.Observer(), module.Observer(), module.Observer()
    expected = whole.run(q, qd, current, hot)
    rows = [(q[a:b], qd[a:b], current[a:b], hot[a:b]) for a, b in ((0, 0), (0, 1), (1, 17), (17, 60))]
    assert np.allclose(np.vstack([pieces.run(*x) for x in rows]), expected, rtol=1e-12, atol=1e-12)
    for k in range(60):
        assert np.allclose(single.step(q[k], qd[k], current[k], hot[k]), expected[k], rtol=1e-12, atol=1e-12)
    whole.reset()
    assert np.array_equal(whole.run(q, qd, current, hot), expected)


def test_friction_without_time_is_that_of_a_motion_that_goes_on(module) -> None:
    q, qd = np.full((4000, DOF), 0.3), np.full((4000, DOF), 0.4)
    steady = module.friction(q[0], qd[0])
    # The load of q that stands still while qd does not: constant, so every state settles.
    along = module.friction(q, qd, dt=DT, carried=np.full((4000, DOF), 50.0))
    assert np.abs(along[-1] - steady).max() < 1e-9
    assert np.abs(along[3] - steady).max() > 0.01


def test_leading_axes_are_motions_of_their_own(module) -> None:
    q, qd, hot, dt, _ = data(40)
    two = module.friction(np.stack([q, -q]), np.stack([qd, qd]), temperature=np.stack([hot, hot]), dt=dt)
    assert np.array_equal(two[0], module.friction(q, qd, temperature=hot, dt=dt))
    assert np.array_equal(two[1], module.friction(-q, qd, temperature=hot, dt=dt))
    with pytest.raises(ValueError, match="must be time"):
        module.friction(q[0], qd[0], dt=DT)


def test_c_is_the_loop_over_sympys_updates(tree, module, folder) -> None:
    q, qd, hot, dt, _ = data()
    library = CLibrary(folder / "observer.so", tree.model.model.name, tree.listings)
    expected, state, before = by_hand(module, q, qd, hot, dt), np.zeros(module.STATES), np.zeros(DOF)
    for k in range(len(q)):
        found = library.call("step", q[k], qd[k], hot[k], state, [dt[k], float(k > 0)], before)
        state, before = found["after"], found["momentum"]
        close(found["friction"], expected[k])


def test_cs_observer_is_numpys(tree, module, folder) -> None:
    q, qd, hot, _, current = data()
    name, vector = tree.model.model.name, ctypes.c_double * DOF

    class Observer(ctypes.Structure):
        _fields_ = (
            ("gain", vector),
            ("dt", ctypes.c_double),
            ("residual", vector),
            ("momentum", vector),
            ("state", ctypes.c_double * module.STATES),
            ("started", ctypes.c_int),
        )

    library, observer = ctypes.CDLL(str(folder / "observer.so")), Observer()
    expected = module.Observer(gain=30.0).run(q, qd, current, hot)
    for _ in range(2):
        arguments = (ctypes.byref(observer), ctypes.c_double(30.0), ctypes.c_double(DT))
        getattr(library, f"{name}_observer_init")(*arguments)
        for k in range(len(q)):
            rows = [vector(*x[k]) for x in (q, qd, current, hot)]
            getattr(library, f"{name}_observer_step")(ctypes.byref(observer), *rows)
            close(np.array(observer.residual), expected[k])


def test_urscript_is_the_loop_over_sympys_updates(tree, module) -> None:
    q, qd, hot, dt, _ = data(150)
    script = Functions(tree.files["collision_guard.script"])
    expected, state, before = by_hand(module, q, qd, hot, dt), [0.0] * module.STATES, [0.0] * DOF
    for k in range(len(q)):
        columns = (q[k].tolist(), qd[k].tolist(), hot[k].tolist())
        core = script.call("rs_core", *columns, state, [float(dt[k]), float(k > 0)], before)
        before, state = core[:DOF], core[3 * DOF :]
        close(np.array(core[2 * DOF : 3 * DOF]), expected[k])


def test_the_guard_that_is_uploaded_remembers_as_numpy_does(module) -> None:
    limits = Thresholds(static=(WITHOUT_LIMIT,) * DOF, per_speed=(0.0,) * DOF)
    cool = tuple(t for t in TERMS if "temperature" not in t.name)
    model = nominal_model(*load_robot("ur5e"), DOF).model_copy(update={"term": cool, "thresholds": limits})
    made = Printer(model)
    q, qd, _, _, _ = data(700)
    q, qd = np.hstack([q, q]), np.hstack([qd, qd])
    q[:300], qd[:300] = q[300], 0.0
    current = np.round(1000 * np.sin(np.arange(700)[:, None] / 9 + np.arange(6))) / 1000
    rows = Rows(q, qd, current, qd)
    found = track(made.guard(current_source="modbus"), rows.world(), 700, DOF)
    at = np.arange(found.frames[0], 700)
    expected = made.observer.Observer().run(q[at, :DOF], qd[at, :DOF], current[at, :DOF])
    assert len(found.frames) == len(at)
    assert np.abs(expected[: len(found.frames)] - found.residual).max() < 1e-9


def test_gen_model_checks_what_remembers(tree) -> None:
    text = tree.files["observer.py"]
    assert worst_disagreement(tree.model, text) < 1e-12
    broken = text.replace("low[0] = high[0] = np.clip(start, low[0], high[0])", "low[0] = high[0] = 0.7")
    assert broken != text
    assert worst_disagreement(tree.model, broken) > 1e-6


def test_every_script_is_free_of_remarks_and_within_a_frame(tree) -> None:
    for name in SCRIPTS:
        assert [x for x in check(tree.files[name]) if x.severity != "note"] == []
    assert guard_size(tree.files["collision_guard.script"]).operations < 0.05 * Dialect().budget


def test_a_second_term_of_the_same_name_has_numbers_of_its_own(tree, module) -> None:
    ripples = [t for t in TERMS if t.name == "ripple"]
    assert ripples[0].parameters != ripples[1].parameters
    names = {str(s) for t in tree.model.terms for s in t.symbols.values()}
    assert {"ripple1_A", "ripple1_2_A"} <= names


def test_page_shows_states_with_an_arrow(tree) -> None:
    rows = [x for x in tree.files["model.md"].splitlines() if x.startswith("| 2 | presliding")]
    assert len(rows) == 1 and r"\leftarrow" in rows[0] and r"\Delta t" in rows[0]


def test_models_without_memory_have_none_of_it(generated) -> None:
    for text in generated("ur5e", 3).files.values():
        for word in ("STATES", "rs_memory", "_recall", "_hold("):
            assert word not in text
