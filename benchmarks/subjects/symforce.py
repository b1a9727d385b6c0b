"""SymForce: energies, their gradient and the C++ that `Codegen.function` writes."""

import importlib
import re
from pathlib import Path

from residuum.robots import Robot

from .native import Loop, compile_library, eigen_folder
from .subject import Subject, Unavailable
from .symbolic_arm import ABOUT, About, Symbols, energies, links

WRAPPER = """
#include "{header}"
extern "C" void momentum_and_beta(const double *q, const double *qd, double *momentum, double *beta)
{{
    using Vector = Eigen::Matrix<double, {dof}, 1>;
    Vector p, b;
    sym::MomentumAndBeta<double>(Eigen::Map<const Vector>(q), Eigen::Map<const Vector>(qd), &p, &b);
    Eigen::Map<Vector>{{momentum}} = p;
    Eigen::Map<Vector>{{beta}} = b;
}}
"""


def native(robot: Robot, dof: int, folder: Path, loop: Loop) -> list[Subject]:
    """Return SymForce's C++ of p = dT/dqd and beta = d(T - V)/dq."""
    ways = [generate(robot, dof, about, folder) for about in ABOUT]
    header, operations = min(ways, key=lambda way: way[1])
    source = folder / f"symforce_{dof}.cpp"
    source.write_text(WRAPPER.format(header=header, dof=dof))
    include = [f"-I{eigen_folder()}"]
    library = compile_library(source, folder / f"symforce_{dof}.so", ["-std=c++17", "-DNDEBUG", *include])
    return [loop.subject("SymForce C++", library, "momentum_and_beta", operations=operations)]


def generate(robot: Robot, dof: int, about: About, folder: Path) -> tuple[Path, int]:
    """Write the header; return it and the operations that SymForce counts in it."""
    try:
        symforce = importlib.import_module("symforce")
        symforce.set_epsilon_to_number()
        sf = importlib.import_module("symforce.symbolic")
        codegen = importlib.import_module("symforce.codegen")
    except ImportError:
        raise Unavailable("SymForce is not installed: pip install symforce") from None
    vector = getattr(sf, f"V{dof}")
    arm = links(robot, dof, about)

    def momentum_and_beta(q, qd):
        kinetic, potential = energies(arm, about, robot.gravity, Symbols(list(q), list(qd), sf.sin, sf.cos))
        return vector([kinetic.diff(x) for x in qd]), vector([(kinetic - potential).diff(x) for x in q])

    written = codegen.Codegen.function(
        momentum_and_beta,
        codegen.CppConfig(),
        input_types=[vector, vector],
        output_names=["momentum", "beta"],
    ).generate_function(folder / f"symforce_{dof}_{about}", skip_directory_nesting=True)
    (header,) = (f for f in written.generated_files if f.suffix == ".h")
    (operations,) = re.findall(r"Total ops: (\d+)", header.read_text())
    return header, int(operations)
