"""The generated C: no warnings, no allocation, clean under the sanitizers, the observer as in NumPy."""

import ctypes
import subprocess

import numpy as np
import pytest

from residuum.codegen.load import STRICT_FLAGS, c_compiler, compile_c, load_text

pytestmark = pytest.mark.skipif(c_compiler() is None, reason="no C compiler")

DRIVER = """
#include "observer.h"
#include <stdio.h>
int main(void) {
    @_observer o;
    double q[@U_DOF], qd[@U_DOF], i[@U_DOF], hot[@U_DOF];
    double m[@U_DOF * @U_DOF], p[@U_DOF], b[@U_DOF], k[1], v[1];
    @_observer_init(&o, 20.0, 0.002);
    for (int n = 0; n < 1000; ++n) {
        for (int j = 0; j < @U_DOF; ++j) {
            q[j] = 0.01 * n + j; qd[j] = 0.3 * j - 0.001 * n; i[j] = 0.1 * j; hot[j] = 40.0;
        }
        @_observer_step(&o, q, qd, i, n % 2 ? hot : 0);
        @_mass_matrix(q, m); @_momentum(q, qd, p); @_beta(q, qd, b); @_energy(q, qd, k, v);
        @_inverse_dynamics(q, qd, i, p); @_gravity(q, b); @_friction(q, qd, p, hot, b);
    }
    printf("%.17g\\n", o.residual[@U_DOF - 1]);
    return 0;
}
"""


def write(folder, tree):
    for name, text in tree.files.items():
        (folder / name).write_text(text)
    return folder


@pytest.mark.parametrize(("dof", "variant"), [(1, "full"), (3, "full"), (3, "thesis"), (6, "full")])
def test_compiles_without_a_warning_and_runs_clean_under_sanitizers(
    dof, variant, generated, tmp_path
) -> None:
    tree = generated("ur5e", dof, variant)
    write(tmp_path, tree)
    name = tree.model.model.name
    (tmp_path / "main.c").write_text(DRIVER.replace("@U", name.upper()).replace("@", name))
    flags = [f for f in STRICT_FLAGS if f != "-Wconversion"]  # the driver's own index arithmetic
    sanitizers = ["-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    compile_c(tmp_path, tmp_path / "strict.so")
    command = [c_compiler(), *flags, *sanitizers, "main.c", "observer.c", "-lm", "-o", "main"]
    built = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr
    done = subprocess.run([tmp_path / "main"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert np.isfinite(float(done.stdout))


def test_allocates_nothing(generated, tmp_path) -> None:
    write(tmp_path, generated("ur5e", 6))
    compile_c(tmp_path, tmp_path / "observer.so")
    symbols = subprocess.run(["nm", "-D", tmp_path / "observer.so"], capture_output=True, text=True).stdout
    assert " U sin" in symbols or " U sincos" in symbols
    assert not any(word in symbols for word in ("malloc", "calloc", "realloc", "free"))


@pytest.mark.parametrize("dof", [3, 6])
def test_observer_equals_numpys(dof, generated, tmp_path) -> None:
    tree = generated("ur5e", dof)
    name = tree.model.model.name
    write(tmp_path, tree)
    compile_c(tmp_path, tmp_path / "observer.so")
    library = ctypes.CDLL(str(tmp_path / "observer.so"))

    class State(ctypes.Structure):
        _fields_ = (
            ("gain", ctypes.c_double * dof),
            ("dt", ctypes.c_double),
            ("residual", ctypes.c_double * dof),
            ("momentum", ctypes.c_double * dof),
            ("started", ctypes.c_int),
        )

    state = State()
    getattr(library, f"{name}_observer_init")(
        ctypes.byref(state), ctypes.c_double(30.0), ctypes.c_double(0.002)
    )
    random = np.random.default_rng(0)
    q, qd, current = (np.cumsum(random.normal(0, 0.01, (500, dof)), axis=0) for _ in range(3))
    module = load_text(tree.files["observer.py"])
    expected = module.Observer(gain=30.0).run(q, qd, current)
    vector = ctypes.c_double * dof
    for n in range(len(q)):
        arguments = (vector(*x[n]) for x in (q, qd, current))
        getattr(library, f"{name}_observer_step")(ctypes.byref(state), *arguments, None)
        assert np.allclose(list(state.residual), expected[n], rtol=1e-11, atol=1e-12)
