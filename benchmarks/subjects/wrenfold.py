"""wrenfold: energies, their gradient and the C++ that its generator writes."""

import importlib
import importlib.metadata
import re
from pathlib import Path

from residuum.robots import Robot

from .native import Loop, compile_library
from .subject import Subject, Unavailable
from .symbolic_arm import ABOUT, About, Symbols, energies, links

WRAPPER = """
#include <array>
#include <cmath>
#include <cstddef>
#include <wrenfold/span.h>

struct Column {{ double *data; }};
struct ConstColumn {{ const double *data; }};

namespace wf {{
template <typename Dimensions> struct convert_to_span<Dimensions, Column> {{
    constexpr auto convert(const Column &x) const noexcept {{
        return make_span(x.data, make_constant_value_pack<{dof}, 1>(), make_constant_value_pack<1, {dof}>());
    }}
}};
template <typename Dimensions> struct convert_to_span<Dimensions, ConstColumn> {{
    constexpr auto convert(const ConstColumn &x) const noexcept {{
        return make_span(x.data, make_constant_value_pack<{dof}, 1>(), make_constant_value_pack<1, {dof}>());
    }}
}};
}}

{code}

extern "C" void momentum_and_beta_of(const double *q, const double *qd, double *momentum, double *beta)
{{
    const Column p{{momentum}}, b{{beta}};
    momentum_and_beta<double>(ConstColumn{{q}}, ConstColumn{{qd}}, p, b);
}}
"""


def native(robot: Robot, dof: int, folder: Path, loop: Loop) -> list[Subject]:
    """Return wrenfold's C++ of p = dT/dqd and beta = d(T - V)/dq."""
    code, operations = min((generate(robot, dof, about) for about in ABOUT), key=lambda way: way[1])
    source = folder / f"wrenfold_{dof}.cpp"
    source.write_text(WRAPPER.format(code=code, dof=dof))
    library = compile_library(
        source, folder / f"wrenfold_{dof}.so", ["-std=c++17", "-DNDEBUG", f"-I{headers()}"]
    )
    return [loop.subject("wrenfold C++", library, "momentum_and_beta_of", operations=operations)]


def headers() -> Path:
    """Return the folder that holds wrenfold/span.h."""
    for file in importlib.metadata.files("wrenfold") or ():
        if file.name == "span.h":
            return Path(file.locate()).resolve().parent.parent
    raise Unavailable("the installed wrenfold carries no span.h")


def generate(robot: Robot, dof: int, about: About) -> tuple[str, int]:
    """Return the C++ function and the operations that wrenfold counts in it."""
    try:
        sym = importlib.import_module("wrenfold.sym")
        generation = importlib.import_module("wrenfold.code_generation")
        annotations = importlib.import_module("wrenfold.type_annotations")
    except ImportError:
        raise Unavailable("wrenfold is not installed: pip install wrenfold") from None
    arm = links(robot, dof, about)
    vector = getattr(annotations, f"Vector{dof}")

    def momentum_and_beta(q, qd):
        symbols = Symbols(q.to_flat_list(), qd.to_flat_list(), sym.sin, sym.cos)
        kinetic, potential = energies(arm, about, robot.gravity, symbols)
        momentum = [kinetic.diff(x) for x in symbols.qd]
        beta = [(kinetic - potential).diff(x) for x in symbols.q]
        return [
            generation.OutputArg(sym.vector(*momentum), "momentum"),
            generation.OutputArg(sym.vector(*beta), "beta"),
        ]

    momentum_and_beta.__annotations__ = {"q": vector, "qd": vector}
    code = generation.generate_function(momentum_and_beta, generation.CppGenerator())
    (operations,) = re.findall(r"total: (\d+)", code)
    return code, int(operations)
