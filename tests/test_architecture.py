"""The house's rules: who may import whom, what the wheel installs, what the README promises."""

import ast
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

#: Package -> packages that it may import from, besides `errors` and itself.
ALLOWED = {
    "robots": set(),
    "symbolic": {"robots"},
    "codegen": {"robots", "symbolic", "templates", "urscript"},
    "recordings": {"robots"},
    "urscript": set(),
    "identify": {"codegen", "recordings", "robots", "symbolic", "urscript"},
    "virtual": {"codegen", "recordings", "robots", "urscript"},
    "driver": {"identify", "recordings", "robots", "templates", "urscript"},
    "collisions": {"codegen", "identify", "recordings", "robots", "symbolic", "urscript", "virtual"},
    "cli": {
        "codegen",
        "collisions",
        "driver",
        "identify",
        "mismatch",
        "recordings",
        "robots",
        "symbolic",
        "urscript",
        "virtual",
        "trials",
    },
    "mismatch": {"codegen", "identify", "recordings", "robots", "symbolic", "templates", "urscript"},
    "trials": {"mismatch", "recordings", "robots", "virtual"},
    "generated": set(),
    "templates": set(),
}


def imports(path: Path):
    """Yield (level, module, names) of every import statement of a file."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom):
            yield node.level, node.module or "", [a.name for a in node.names]
        elif isinstance(node, ast.Import):
            for alias in node.names:
                yield 0, alias.name, []


@pytest.mark.parametrize("package", sorted(ALLOWED))
def test_imports_go_one_way(package) -> None:
    for path in sorted((ROOT / package).rglob("*.py")):
        depth = len(path.relative_to(ROOT).parts) - 1
        for level, module, names in imports(path):
            assert not module.startswith("residuum"), f"{path}: import relatively"
            if level <= depth:
                continue
            targets = {module.split(".")[0]} if module else set(names)
            allowed = ALLOWED[package] | {package, "errors", "__version__"}
            assert targets <= allowed, f"{path.relative_to(ROOT)} imports {targets - allowed}"


def test_generated_code_imports_numpy_alone() -> None:
    for path in (ROOT / "generated").rglob("*.py"):
        assert {m for _, m, _ in imports(path)} <= {"numpy"}


def test_symbolic_knows_no_casadi_and_no_files() -> None:
    for path in (ROOT / "symbolic").rglob("*.py"):
        found = {m.split(".")[0] for _, m, _ in imports(path)}
        assert found.isdisjoint({"casadi", "pathlib", "io", "os", "jinja2"}), path


def test_physics_is_checked_by_strangers_only() -> None:
    """Pinocchio and MuJoCo are used neither in deriving nor in generating."""
    for package in ("robots", "symbolic", "codegen", "templates"):
        for path in (ROOT / package).rglob("*.py"):
            found = {m.split(".")[0] for _, m, _ in imports(path)}
            assert found.isdisjoint({"pinocchio", "mujoco"}), path


def test_every_package_is_declared() -> None:
    declared = set(tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"])
    skipped = {"tests", "benchmarks", "examples", "build", ".venv", "docs"}
    there = {
        ".".join(("residuum", *p.parent.relative_to(ROOT).parts))
        for p in ROOT.rglob("__init__.py")
        if not skipped & set(p.relative_to(ROOT).parts)
    }
    assert there == declared


@pytest.mark.slow
def test_the_wheel_installs_the_name_residuum_and_no_other(tmp_path) -> None:
    command = [
        sys.executable,
        "-m",
        "build",
        "--wheel",
        "--no-isolation",
        "--outdir",
        str(tmp_path),
        str(ROOT),
    ]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    (wheel,) = tmp_path.glob("*.whl")
    names = zipfile.ZipFile(wheel).namelist()
    assert {n.split("/")[0].split("-")[0] for n in names} == {"residuum"}
    for needed in (
        "templates/model/observer.py.jinja",
        "robots/ur5e.toml",
        "generated/ur5e_dof3/observer.c",
        "py.typed",
        "urscript/grammar.lark",
    ):
        assert f"residuum/{needed}" in names
    root_files = {n.split("/")[1] for n in names if n.startswith("residuum/") and n.count("/") == 1}
    assert {n for n in root_files if n.endswith(".py")} == {"__init__.py", "errors.py"}


def test_no_place_or_tool_of_a_session_is_named() -> None:
    words = ["/" + "work/", "/" + "root/", "/" + "farm/"]
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode:
        pytest.skip("not a git checkout")
    for name in listed.stdout.split():
        path = ROOT / name
        if (
            path.suffix in (".py", ".md", ".toml", ".jinja", ".c", ".h", ".script", ".txt", "")
            and path.is_file()
        ):
            text = path.read_text(errors="replace")
            assert not [w for w in words if w in text], name
