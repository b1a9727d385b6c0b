"""From a model to its output tree: values in, {path: text} out; nothing is written here."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import tomli_w
from jinja2 import Environment

from ..robots.model import Model
from ..templates import renderer
from .functions import listings
from .guard import guard_scripts
from .inplace import in_place
from .languages import NUMPY, URSCRIPT, C, body
from .listing import Listing
from .memory import RECALL, STEP, for_numpy, maps, states
from .options import Options
from .page import UNFITTED_THRESHOLD, page_context
from .printed import CFunction, NumpyFunction
from .symbolic_model import SymbolicModel, symbolic_model


@dataclass(frozen=True)
class Generated:
    """The output tree (relative path -> text) and the functions it was printed from."""

    files: Mapping[str, str]
    listings: Mapping[str, Listing]
    model: SymbolicModel


def model_hash(model: Model) -> str:
    """Return 16 hexadecimal digits that name everything that the generated code depends on."""
    return hashlib.sha256(model.model_dump_json().encode()).hexdigest()[:16]


def model_toml(model: Model) -> str:
    """Return model.toml: the model, with its inputs by hash."""
    data = model.model_dump(mode="python", exclude_none=True, exclude_defaults=False)
    text = tomli_w.dumps(_plain(data), multiline_strings=False)
    return (
        f"# {model.title}, {model.dof} joints. Written by residuum; read it with gen-model --model.\n{text}"
    )


def _plain(value: object) -> dict[str, object]:
    def convert(x: object) -> object:
        if isinstance(x, Mapping):
            return {k: convert(v) for k, v in x.items()}
        if isinstance(x, list | tuple):
            return [convert(v) for v in x]
        return x

    return convert(value)  # type: ignore[return-value]


def generate(model: Model, options: Options | None = None) -> Generated:
    """Return the whole output tree of a model."""
    symbolic = symbolic_model(model)
    return render(symbolic, listings(symbolic), options or Options())


def render(
    symbolic: SymbolicModel,
    found: Mapping[str, Listing],
    options: Options,
    further_counts: Sequence[tuple[str, int]] = (),
) -> Generated:
    """Print the functions of a model in every language and write its page.

    further_counts: (what, operations) rows for the page, of models that this one is compared with.
    """
    model = symbolic.model
    environment = _environment()
    shared = _shared_context(symbolic)
    scripts = guard_scripts(environment, shared, symbolic, found, options)
    in_c = [CFunction(n, body(x, C), x, model.name.upper()) for n, x in found.items() if not for_numpy(n)]
    files = {
        "__init__.py": f'"""{model.title}, {model.dof} joints: written by gen-model; do not edit."""\n',
        "observer.py": _numpy(environment, shared, symbolic, found),
        "observer.h": environment.get_template("model/observer.h.jinja").render(**shared, functions=in_c),
        "observer.c": environment.get_template("model/observer.c.jinja").render(**shared, functions=in_c),
        **scripts,
        "model.md": environment.get_template("model/model.md.jinja").render(
            **shared, **page_context(symbolic, found, scripts["collision_guard.script"], further_counts)
        ),
        "model.toml": model_toml(model),
    }
    return Generated(files, found, symbolic)


def observer_text(model: Model) -> str:
    """Return observer.py alone, for running a model at once."""
    symbolic = symbolic_model(model)
    return _numpy(_environment(), _shared_context(symbolic), symbolic, listings(symbolic))


def _numpy(
    environment: Environment,
    shared: Mapping[str, object],
    symbolic: SymbolicModel,
    found: Mapping[str, Listing],
) -> str:
    remembers = bool(symbolic.memory)
    functions = {
        n: NumpyFunction(n, body(x, NUMPY), x, remembers)
        for n, x in found.items()
        if n not in ("momentum_and_beta", STEP)
    }
    return environment.get_template("model/observer.py.jinja").render(
        **shared,
        functions=functions.values(),
        core=functions["core"],
        block=in_place(found["core"]),
        maps=[(functions[m.name], m) for m in maps(symbolic)],
        recall=functions[RECALL].used if remembers else "",
        term_notes=_term_notes(symbolic),
    )


def urscripts(symbolic: SymbolicModel, found: Mapping[str, Listing], options: Options) -> dict[str, str]:
    """Print the URScript programs alone: file name -> text."""
    return guard_scripts(_environment(), _shared_context(symbolic), symbolic, found, options)


def _environment() -> Environment:
    return renderer(
        {
            "float_py": NUMPY.number,
            "float_c": C.number,
            "float_ur": URSCRIPT.number,
            "float_md": lambda x: f"{x:.6g}",
        }
    )


def _shared_context(symbolic: SymbolicModel) -> dict[str, object]:
    model = symbolic.model
    fitted = model.thresholds
    reference = [30.0] * model.dof
    for term in symbolic.terms:
        if "T0" in term.values:
            reference[term.data.joint - 1] = term.values["T0"]
    return {
        "title": model.title,
        "name": model.name,
        "upper": model.name.upper(),
        "hash": model_hash(model),
        "dof": model.dof,
        "locked_angles": list(model.locked_angles),
        "thesis": model.variant == "thesis",
        "gain": model.observer_gain,
        "gains": [j.drive_gain for j in model.joint],
        "thresholds": list(fitted.static)
        if fitted
        else [UNFITTED_THRESHOLD * j.max_torque for j in model.joint],
        "thresholds_per_speed": list(fitted.per_speed) if fitted and fitted.per_speed else [0.0] * model.dof,
        "reference_temperature": reference,
        "memory": len(states(symbolic)),
    }


def _term_notes(symbolic: SymbolicModel) -> list[tuple[str, str]]:
    """Say which terms are in, and how wide the smooth sign is."""
    if not symbolic.terms:
        return [("Friction", "none in this model; friction() returns zeros")]
    names = ", ".join(dict.fromkeys(t.data.name for t in symbolic.terms))
    remembering = ", ".join(dict.fromkeys(t.data.name for t in symbolic.memory))
    widths = sorted({t.values["width"] for t in symbolic.terms if "width" in t.values})
    notes = [("Terms", names)]
    if widths:
        text = ", ".join(f"{w:g}" for w in widths)
        notes.append(("Smooth sign", f"v / (|v| + w) with w = {text} rad/s"))
    if remembering:
        notes.append(("Memory", f"{remembering}; they depend on the samples before"))
    return notes
