"""``import vgvt`` and ``vgvt --help`` load no heavy package; a user waits for neither."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

HEAVY = ("mujoco", "matplotlib", "pandas", "control", "plotly", "scipy")


def imported_by(*arguments: str) -> set[str]:
    """Top-level names of every module that a fresh interpreter imports for these arguments."""
    environment = {**os.environ, "PYTHONPROFILEIMPORTTIME": "1"}
    done = subprocess.run(
        [sys.executable, *arguments], capture_output=True, text=True, env=environment, timeout=120, check=False
    )
    said = "\n".join(line for line in done.stderr.splitlines() if not line.startswith("import time:"))
    assert done.returncode == 0, said[-2000:]
    rows = [line.rsplit("|", 1)[-1].strip() for line in done.stderr.splitlines() if line.startswith("import time:")]
    assert rows, "the interpreter reported no imports"
    return {row.split(".")[0] for row in rows}


@pytest.mark.parametrize(
    "arguments",
    [
        pytest.param(("-c", "import vgvt"), id="import vgvt"),
        pytest.param(("-c", "import vgvt.data, vgvt.scenario"), id="import the nouns and the scenario"),
        pytest.param(("-m", "vgvt", "--help"), id="vgvt --help"),
        pytest.param(("-m", "vgvt", "run", "--help"), id="vgvt run --help"),
    ],
)
def test_nothing_heavy_is_imported(arguments: tuple[str, ...]) -> None:
    loaded = imported_by(*arguments)
    assert "vgvt" in loaded
    heavy = loaded.intersection(HEAVY)
    assert not heavy, f"{sorted(heavy)} imported by: python {' '.join(arguments)}"


def test_the_probe_sees_what_is_imported() -> None:
    """The law above could not fail if the probe were blind."""
    assert "json" in imported_by("-c", "import json.decoder")
