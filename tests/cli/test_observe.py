"""residuum observe: on what is known exactly, on real recordings, on bad ones."""

import numpy as np
import pytest
from commands import residuum

from residuum.codegen.generate import generate
from residuum.codegen.load import load_text
from residuum.identify.observation import observe
from residuum.recordings import Recording
from residuum.robots import load_robot
from residuum.symbolic.nominal import nominal_model


@pytest.fixture(scope="module")
def module(generated):
    return load_text(generated("ur5e", 6).files["observer.py"])


@pytest.fixture(scope="module")
def model_file(tmp_path_factory):
    from residuum.codegen.generate import model_toml

    path = tmp_path_factory.mktemp("model") / "model.toml"
    path.write_text(model_toml(nominal_model(*load_robot("ur10e"), 6)))
    return path


def smooth(module, time):
    """A motion, and the currents that it takes."""
    rate = 2 * np.pi * 0.2 * np.arange(1, 7)
    phase = rate * time[:, None]
    q, qd, qdd = np.sin(phase), rate * np.cos(phase), -(rate**2) * np.sin(phase)
    return q, qd, module.inverse_dynamics(q, qd, qdd) / module.GAINS


def test_a_motion_that_the_model_explains_leaves_little(module) -> None:
    time = np.arange(0, 10, 0.002)
    q, qd, current = smooth(module, time)
    found = observe(Recording("run", time, q, current, qd=qd), module)
    torque = np.abs(current * module.GAINS).max()
    assert found.rms()[0].max() < 0.005 * torque
    assert found.starts == (0,)


def test_a_gap_starts_the_observer_anew(module) -> None:
    time = np.arange(0, 10, 0.002)
    q, qd, current = smooth(module, time)
    keep = (time < 4.0) | (time > 5.0)
    found = observe(Recording("run", time[keep], q[keep], current[keep], qd=qd[keep]), module)
    assert found.starts == (0, int(np.flatnonzero(np.diff(time[keep]) > 0.5)[0]) + 1)
    whole = observe(Recording("run", time, q, current, qd=qd), module)
    late = time[keep] > 6.0
    assert np.allclose(found.residual[late], whole.residual[time > 6.0], atol=0.05)


def test_a_slow_recording_lowers_the_gain(module) -> None:
    time = np.arange(0, 20, 0.1)
    q, qd, current = smooth(module, time)
    found = observe(Recording("run", time, q, current, qd=qd), module)
    assert found.gain == pytest.approx(5.0)
    assert np.all(np.isfinite(found.residual))


def test_terms_are_taken_out_of_the_external_torque(generated) -> None:
    from residuum.robots.model import TermData

    model = nominal_model(*load_robot("ur5e"), 6)
    terms = tuple(TermData(name="viscous", joint=j, parameters={"Fv": 10.0}) for j in range(1, 7))
    module = load_text(generate(model.model_copy(update={"term": terms})).files["observer.py"])
    time = np.arange(0, 10, 0.002)
    q, qd, current = smooth(module, time)
    recording = Recording("run", time, q, current + 10.0 * qd / module.GAINS, qd=qd)
    residual, external = observe(recording, module).rms()
    assert np.all(residual > 5.0)
    assert np.all(external < 0.05 * residual)


@pytest.mark.parametrize("broken", [False, True])
def test_real_recording_and_the_same_with_a_broken_row(broken, real_recordings, model_file, tmp_path) -> None:
    source = real_recordings / "ur10e" / "unloaded_03.csv"
    lines = source.read_text().splitlines(keepends=True)
    if broken:
        lines[499] = lines[499].replace(",", ",x", 3)
    recording = tmp_path / "run.csv"
    recording.write_text("".join(lines))
    done = residuum(
        "observe", recording, "--model", model_file, "--out", tmp_path / "r.csv", "--plot", tmp_path / "r.png"
    )
    assert done.returncode == 0, done.stderr
    table = np.genfromtxt(tmp_path / "r.csv", delimiter=",", names=True)
    assert len(table) == 2036 - broken
    assert table.dtype.names[:3] == ("timestamp", "residual_0", "residual_1")
    rms = np.array([np.sqrt(np.mean(table[f"residual_{i}"] ** 2)) for i in range(6)])
    # Friction of a UR10e, nothing else: tens of Nm on the large joints, a few on the wrist.
    assert np.all(rms[:3] > 5)
    assert np.all(rms[:3] < 40)
    assert np.all(rms[3:] < 8)
    assert (tmp_path / "r.png").read_bytes().startswith(b"\x89PNG")
    if broken:
        assert "500" in done.stdout + done.stderr


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["missing.csv", "--out", "{out}", "--model", "{model}"], "missing.csv"),
        (["{run}", "--out", "{out}", "--model", "missing.toml"], "missing.toml"),
        (["{run}", "--out", "{out}", "--model", "{model}", "--plot", "x.bmp"], "--plot"),
        (["{run}", "--out", "{out}", "--model", "{model}", "--gain", "-3"], "--gain"),
        (["{run}", "--out", "{dir}/no/where.csv", "--model", "{model}"], "--out"),
        (["{run}", "--model", "{model}"], "--out"),
        (["{short}", "--out", "{out}", "--model", "{model}"], "short.csv"),
    ],
)
def test_bad_input_gets_one_line_and_leaves_nothing(arguments, words, module, model_file, tmp_path) -> None:
    time = np.arange(0, 2, 0.01)
    q, qd, current = smooth(module, time)
    names = ["timestamp"] + [f"actual_{k}_{i}" for k in ("q", "qd", "current") for i in range(6)]
    table = np.column_stack([time, q, qd, current])
    np.savetxt(tmp_path / "run.csv", table, delimiter=",", header=",".join(names), comments="")
    np.savetxt(tmp_path / "short.csv", table[:1], delimiter=",", header=",".join(names), comments="")
    places = {
        "run": tmp_path / "run.csv",
        "short": tmp_path / "short.csv",
        "out": tmp_path / "out.csv",
        "model": model_file,
        "dir": tmp_path,
    }
    done = residuum("observe", *(a.format(**places) for a in arguments))
    assert done.returncode == 2
    assert len(done.stderr.strip().splitlines()) == 1
    assert words in done.stderr
    assert not (tmp_path / "out.csv").exists()
    assert not [p for p in tmp_path.iterdir() if p.name.startswith(".")]


def test_a_reduced_model_says_where_the_wrist_is_not(generated, module) -> None:
    from residuum.identify.observation import wrist_note

    three = load_text(generated("ur5e", 3).files["observer.py"])
    time = np.arange(0, 2, 0.002)
    q, qd, current = smooth(module, time)
    assert "joint 4" in wrist_note(Recording("run", time, q, current, qd=qd), three)
    still = q.copy()
    still[:, 3:] = 0.0
    assert wrist_note(Recording("run", time, still, current, qd=qd), three) == ""
    assert wrist_note(Recording("run", time, q, current, qd=qd), module) == ""


def test_unknown_verb_and_help() -> None:
    done = residuum("obsreve")
    assert done.returncode == 2
    assert len(done.stderr.strip().splitlines()) == 1
    assert "observe" in residuum("--help").stdout
    assert "Example" in residuum("observe", "--help").stdout
