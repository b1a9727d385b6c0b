"""The fit on simulated recordings: robust, physical, gains, nonlinear terms, order of files, cluster."""

from dataclasses import replace

import numpy as np
import pytest

from residuum.errors import InputError
from residuum.identify import physical
from residuum.identify.baseline import Options, fit_files
from residuum.identify.physical import LinkMap, link_map, project
from residuum.identify.requests import TermRequest, parse_request
from residuum.identify.schedule import scheduler
from residuum.identify.workflow import Task, run
from residuum.robots.model import TermData
from residuum.symbolic.inertia import Inertia


@pytest.fixture(scope="module")
def small(tools):
    return tools.make_twin(tools.ur5e()[0], dof=3)


def files(tools, tmp_path, recordings):
    return [tools.write_csv(tmp_path / f"run_{k}.csv", r) for k, r in enumerate(recordings)]


def fit_three(paths, tools, options=None, workers=1):
    with scheduler(workers=workers) as at:
        return fit_files(paths, *tools.ur5e(), 3, options or Options(), at)


def test_one_percent_of_gross_outliers_change_little(small, tools, tmp_path):
    clean = [small.recording(40.0, seed=k) for k in range(3)]
    rng = np.random.default_rng(0)
    dirty = []
    for r in clean:
        current = r.current.copy()
        hit = rng.choice(len(r), len(r) // 100, replace=False)
        current[hit] += rng.choice([-1, 1], (len(hit), r.joints)) * rng.uniform(10, 30, (len(hit), r.joints))
        dirty.append(replace(r, current=current))
    a = fit_three(files(tools, tmp_path, clean), tools)
    (tmp_path / "d").mkdir()
    b = fit_three(files(tools, tmp_path / "d", dirty), tools)
    assert np.median(np.abs(a.fitted.estimate.theta - b.fitted.estimate.theta) / a.std) < 1.0
    assert sum(j.outliers for j in b.fitted.sums) > sum(j.outliers for j in a.fitted.sums)


def test_the_order_of_files_does_not_matter(small, tools, tmp_path):
    paths = files(tools, tmp_path, [small.recording(20.0, seed=k) for k in range(3)])
    a, b = fit_three(paths, tools), fit_three(paths[::-1], tools)
    np.testing.assert_allclose(a.fitted.estimate.theta, b.fitted.estimate.theta, rtol=1e-10)


def test_processes_and_this_one_agree(small, tools, tmp_path):
    paths = files(tools, tmp_path, [small.recording(20.0, seed=k) for k in range(2)])
    a, b = fit_three(paths, tools), fit_three(paths, tools, workers=2)
    np.testing.assert_allclose(a.fitted.estimate.theta, b.fitted.estimate.theta, rtol=1e-10)


def test_stribeck_speed_is_found(tools, tmp_path):
    extra = tuple(TermData(name="stribeck", joint=j, parameters={"Fs": 4.0, "vs": 0.12}) for j in (1, 2, 3))
    twin = tools.make_twin(tools.ur5e()[0], 3, extra=extra)
    paths = files(tools, tmp_path, [twin.recording(60.0, seed=k, noise=0.2) for k in range(2)])
    found = fit_three(paths, tools, Options((TermRequest("stribeck", (1, 2, 3)),)))
    assert [dict(s.request.values)["vs"] for s in found.searched] == pytest.approx([0.12] * 3, rel=0.25)
    assert not any(s.at_bound for s in found.searched)


def test_load_dependent_friction_uses_the_fitted_gravity(tools, tmp_path):
    extra = (TermData(name="load_dependent", joint=2, parameters={"mu": 0.06}),)
    twin = tools.make_twin(tools.ur5e()[0], 3, extra=extra)
    paths = files(tools, tmp_path, [twin.recording(60.0, seed=k, noise=0.2) for k in range(2)])
    found = fit_three(paths, tools, Options((TermRequest("load_dependent", (2,)),)))
    k = found.names.index("load_dependent2_mu")
    assert found.fitted.estimate.theta[k] == pytest.approx(0.06, abs=4 * found.std[k])


def test_friction_never_feeds_energy(small, tools, tmp_path):
    """A recording whose friction has the wrong sign still gives a model that dissipates."""
    r = small.recording(40.0, seed=1)
    wrong = r.current - 2.5 * small.observer.friction(r.q, r.qd) / small.observer.GAINS
    found = fit_three(files(tools, tmp_path, [replace(r, current=wrong)]), tools)
    assert (found.fitted.estimate.theta[list(found.problem.positive)] >= 0).all()
    assert found.fitted.estimate.moved > 1


def test_physical_links_stay_and_impossible_ones_move(small):
    mapping = link_map(small.model)
    theta = np.array([v.value for v in small.model.base.values()])
    information = np.diag(1 / np.maximum(0.05 * np.abs(theta), 0.01) ** 2)
    same, distance = project(theta, information, mapping, ())
    assert distance == 0.0
    np.testing.assert_array_equal(same, theta)
    k = list(small.model.base).index("IA3")
    impossible = theta.copy()
    impossible[k] = -1.0  # a rotor that weighs less than nothing
    moved, distance = project(impossible, information, mapping, ())
    assert distance > 1
    assert moved[k] > -1e-6


def test_splitting_stands_in_for_interior_points(small, monkeypatch):
    """Coarser, but the same arm: what is impossible moves as far."""
    mapping, found = link_map(small.model), []
    theta = np.array([v.value for v in small.model.base.values()])
    std = np.maximum(0.05 * np.abs(theta), 0.01)
    theta[list(small.model.base).index("IA3")] = -1.0
    for solver in ("CLARABEL", "SCS"):
        monkeypatch.setattr(physical, "_SOLVERS", (solver,))
        found.append(project(theta, np.diag(1 / std**2), mapping, ())[0])
    np.testing.assert_allclose(found[1] / std, found[0] / std, atol=0.05)


def test_the_map_of_links_is_the_published_model(small, tools):
    from residuum.symbolic.nominal import with_wrist_locked

    robot = tools.ur5e()[0]
    mapping: LinkMap = link_map(small.model)
    bodies = with_wrist_locked(robot, 3, (0.0, 0.0, 0.0))
    full = np.array([float(x) for body in bodies for x in body.parameters])
    assert isinstance(bodies[0], Inertia)
    rotors = np.array([j.reflected_inertia for j in robot.joint[:3]])
    expected = [v.value for v in small.model.base.values()]
    np.testing.assert_allclose(mapping.links @ full + mapping.rotors @ rotors, expected, atol=1e-9)


def test_a_known_load_shows_the_drive_gains(tools, tmp_path):
    """Currents of a robot whose true gains are 20 % off the file's; a 2.6 kg load shows them."""
    robot, digest = tools.ur5e()
    true = np.array([12.2, 8.5, 11.5, 7.0, 9.5, 7.6])
    twin = tools.make_twin(robot)
    heavier = robot.joint[5].model_copy(update=_with_load(robot.joint[5], 2.6))
    loaded_twin = tools.make_twin(robot.model_copy(update={"joint": (*robot.joint[:5], heavier)}))
    paths = []
    for name, source, seed in (("a", twin, 1), ("b", twin, 2), ("loaded", loaded_twin, 3)):
        r = source.recording(60.0, seed=seed, noise=0.2)
        paths.append(
            tools.write_csv(
                tmp_path / f"{name}.csv", replace(r, current=r.current * source.observer.GAINS / true)
            )
        )
    _, model = run(Task(tuple(paths[:2]), robot, digest, 6, loaded=(paths[2],), payload=2.6))
    gains = np.array([j.drive_gain for j in model.joint])
    std = np.array([j.drive_gain_std for j in model.joint])
    assert (np.abs(gains - true) < 4 * std).all()
    assert (std[1:4] < 0.05 * true[1:4]).all()
    assert "known load of 2.6 kg" in model.fit.gains


def _with_load(joint, mass: float):
    """The last link with a point-like load 5 cm in front of the flange."""
    total = joint.mass + mass
    centre = np.array(joint.centre_of_mass)
    place = np.array([0.01, -0.02, 0.05])
    middle = (joint.mass * centre + mass * place) / total
    J = np.diag(joint.inertia[:3])
    for m, at in ((joint.mass, centre - middle), (mass, place - middle)):
        J = J + m * (at @ at * np.eye(3) - np.outer(at, at))
    inertia = (J[0, 0] + 0.003, J[1, 1] + 0.003, J[2, 2] + 0.003, J[0, 1], J[0, 2], J[1, 2])
    return {"mass": total, "centre_of_mass": tuple(middle), "inertia": inertia}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("stribek", "did you mean stribeck"), ("stribeck:7", "numbers from 1 to 3"), ("stribeck:2:vx=1", "known: vs, delta, width"),
        ("stribeck:2:vs=x", "give a number"), ("viscous:Fv=1", "no such parameter"),
    ],
)  # fmt: skip
def test_a_wrong_term_is_named(text, message):
    with pytest.raises(InputError, match=message):
        parse_request(text, 3)


def test_a_recording_without_motion_is_refused(small, tools, tmp_path):
    r = small.recording(20.0, seed=1)
    rng = np.random.default_rng(0)
    still = replace(r, q=r.q[:1] + 1e-6 * rng.normal(size=r.q.shape), qd=1e-5 * rng.normal(size=r.q.shape))
    with pytest.raises(InputError, match="moves for long enough"):
        fit_three(files(tools, tmp_path, [still]), tools)


@pytest.mark.slow
def test_a_dask_cluster_gives_the_same_model_file(small, tools, tmp_path):
    distributed = pytest.importorskip("dask.distributed")
    from residuum.codegen.generate import model_toml

    paths = tuple(files(tools, tmp_path, [small.recording(30.0, seed=k) for k in range(3)]))
    task = Task(paths, *tools.ur5e(), 3, false_alarms=2.0)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        remote = run(replace(task, scheduler=cluster.scheduler_address))[1]
    alone = run(replace(task, workers=1))[1]
    assert model_toml(remote) == model_toml(alone)
