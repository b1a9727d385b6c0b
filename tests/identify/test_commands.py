"""`residuum fit` and `residuum predict` as a user calls them."""

import csv

import numpy as np
import pytest
from click.testing import CliRunner

from residuum.cli.fit import fit
from residuum.cli.predict import predict
from residuum.errors import InputError
from residuum.robots.model import Model
from residuum.robots.toml import read


@pytest.fixture(scope="module")
def fitted(tools, tmp_path_factory):
    folder = tmp_path_factory.mktemp("fit")
    twin = tools.make_twin(tools.ur5e()[0])
    paths = [tools.write_csv(folder / f"run_{k}.csv", twin.recording(25.0, seed=k)) for k in range(3)]
    out = folder / "model.toml"
    result = call(fit, *paths[:2], "--robot", "ur5e", "--out", out, "--plot", folder / "plot.png")
    return folder, paths, out, result


def call(command, *arguments):
    result = CliRunner().invoke(command, [str(a) for a in arguments])
    if result.exception and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result


def test_fit_writes_a_model_with_uncertainty_and_provenance(fitted):
    folder, _, out, result = fitted
    model, _ = read(Model, out)
    assert all(v.std is not None for v in model.base.values())
    assert [i.name for i in model.inputs] == ["ur5e.toml", "run_0.csv", "run_1.csv"]
    assert model.fit is not None
    assert model.covariance is not None
    assert np.linalg.eigvalsh(model.covariance.matrix()).min() > 0
    assert model.thresholds.false_alarms_per_hour == 1.0
    assert (folder / "plot.png").stat().st_size > 1000
    assert "left out: error, %" in result.output
    assert "not fitted" in model.fit.gains


def test_gen_model_generates_it(fitted, tmp_path):
    from residuum.cli.gen_model import gen_model

    call(gen_model, "--model", fitted[2], "--out", tmp_path)
    assert (tmp_path / "ur5e_dof6" / "observer.c").is_file()


def test_predict_is_the_same_without_the_current_column(fitted, tools, tmp_path):
    _, paths, out, _ = fitted
    with paths[2].open() as file:
        rows = list(csv.reader(file))
    keep = [k for k, name in enumerate(rows[0]) if not name.startswith("actual_current")]
    without = tmp_path / "run_2.csv"
    with without.open("w") as file:
        file.writelines(",".join(row[k] for k in keep) + "\n" for row in rows)
    call(predict, paths[2], "--model", out, "--out", tmp_path / "a.csv")
    call(predict, without, "--model", out, "--out", tmp_path / "b.csv")
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    found = np.genfromtxt(tmp_path / "a.csv", delimiter=",", names=True)
    assert found.dtype.names == ("timestamp", *(f"predicted_current_{i}" for i in range(6)))
    assert found["timestamp"][0] == float(rows[1][0])
    assert len(found) == len(rows) - 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--payload", "2"], "--loaded and --payload go together"),
        (["--plot", "x.txt"], "--plot x.txt"),
        (["--robot", "ur7"], "no such robot"),
        (["--term", "stribek"], "did you mean stribeck"),
        (["--scheduler", "127.0.0.1:1"], "no Dask scheduler answers"),
    ],
)
def test_bad_options_are_one_line(fitted, tmp_path, arguments, message):
    with pytest.raises(InputError, match=message) as caught:
        call(fit, fitted[1][0], "--out", tmp_path / "m.toml", *arguments)
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_the_same_recording_twice_is_refused(fitted, tmp_path):
    with pytest.raises(InputError, match="given twice"):
        call(fit, fitted[1][0], fitted[1][0], "--out", tmp_path / "m.toml")
