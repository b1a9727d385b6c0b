"""The installed commands as processes of their own, as a user runs them."""

import subprocess
import sys
from typing import Any

RESIDUUM = [sys.executable, "-c", "from residuum.cli.main import main; main()"]
GEN_MODEL = [sys.executable, "-c", "from residuum.cli.gen_model import main; main()"]


def residuum(*arguments: object, **options: Any) -> subprocess.CompletedProcess[str]:
    """Run a verb to its end; options: of subprocess.run."""
    return subprocess.run([*RESIDUUM, *map(str, arguments)], capture_output=True, text=True, **options)


def gen_model(*arguments: object, **options: Any) -> subprocess.CompletedProcess[str]:
    """Run gen-model to its end; options: of subprocess.run."""
    return subprocess.run([*GEN_MODEL, *map(str, arguments)], capture_output=True, text=True, **options)
