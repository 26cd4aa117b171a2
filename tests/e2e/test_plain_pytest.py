"""`pytest` alone, as most people call it, ends as its tests do."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

FEW = ("benchmarks", "laws")


def test_benchmarks_that_nobody_asks_for_are_no_error(repository_root: Path) -> None:
    """They refuse to be measured beside others, which would be an error at the very end, after hours of passes."""
    left = [f"--ignore={p}" for p in (repository_root / "tests").iterdir() if p.is_dir() and p.name not in FEW]
    command = [sys.executable, "-m", "pytest", "-q", "tests", *left, "-k", "test_bench or short_reprs"]
    # Where this is one of several workers, that one is none.
    alone = {k: v for k, v in os.environ.items() if not k.startswith("PYTEST_")}
    done = subprocess.run(
        command, cwd=repository_root, env=alone, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
