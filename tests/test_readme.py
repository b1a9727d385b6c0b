"""The README is true: every command in it runs, and what it says they print is what they print."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text()


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def test_make_targets_exist() -> None:
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    used = set(re.findall(r"`make ([a-z]+)`", README)) | {
        c.split()[1] for b in blocks("sh") for c in b.splitlines() if c.startswith("make")
    }
    assert {"model", "test"} <= used <= targets


def test_every_link_leads_somewhere() -> None:
    for page in (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md")):
        for link in re.findall(r"\]\((?!https?:)([^)#]+)\)", page.read_text()):
            assert (page.parent / link).exists(), f"{page.name}: {link}"


@pytest.mark.slow
def test_commands_run_and_print_what_it_says(tmp_path) -> None:
    """In a folder of its own; `make model` and `make test` are CI's own first and last step."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    scripts = Path(sys.executable).parent
    printed = ""
    for command in (line for block in blocks("sh") for line in block.splitlines()):
        if command == "make test":
            continue
        command = command.replace("make model", "gen-model --dof 3")
        name, *arguments = command.split()
        done = subprocess.run([scripts / name, *arguments], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, f"{command}\n{done.stderr}"
        printed += done.stdout
    for block in blocks("text"):
        for line in block.splitlines():
            assert line.strip() in printed, line


@pytest.mark.parametrize("number", range(len(blocks("python"))))
def test_python_examples_run(number) -> None:
    done = subprocess.run([sys.executable, "-c", blocks("python")[number]], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
