"""What structures are made by, as a hash: derivatives on disk belong to the program that took them."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.metadata import version
from pathlib import Path

import vgvt

# From a scenario to matrices, and what moves in it.
_MAKERS = ("data", "scenario", "effects", "simulation", "reconcile/question")


@cache
def structure_code() -> str:
    """Hash of the versions, and of all source that a structure of a scenario follows from."""
    found = hashlib.sha256(repr((vgvt.__version__, version("mujoco"), version("numpy"))).encode())
    root = Path(vgvt.__file__).parent
    for file in sorted(file for maker in _MAKERS for file in (root / maker).glob("*.py")):
        found.update(file.relative_to(root).as_posix().encode())
        found.update(file.read_bytes())
    return found.hexdigest()
