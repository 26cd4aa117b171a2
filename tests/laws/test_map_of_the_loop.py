"""The page that says how the loop is closed names every file of it, in its package, in the order of the import law."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import vgvt.reconcile

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/explanation/how-the-loop-is-closed.md").read_text(encoding="utf-8")
SOURCE = ROOT / "vgvt/reconcile"


def rows() -> dict[str, set[str]]:
    """Package to its files, by the page's table; those of no package under an empty name."""
    table = PAGE[PAGE.index("## Where is what") :]
    cells = re.findall(r"^\| (?:`(\w+)`|\*itself\*) \|[^|]*\| ([^|]*) \|$", table, flags=re.MULTILINE)
    return {package: set(re.findall(r"`(\w+)`", files)) for package, files in cells}


def test_every_file_is_in_the_row_of_its_package() -> None:
    there: dict[str, set[str]] = {}
    for file in SOURCE.rglob("*.py"):
        if file.stem != "__init__":
            there.setdefault(file.parent.relative_to(SOURCE).as_posix().removeprefix("."), set()).add(file.stem)
    assert rows() == there


def test_packages_stand_in_the_order_of_the_import_law() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    layers = next(c["layers"] for c in contracts if c.get("containers") == ["vgvt.reconcile"])
    inside = [name for layer in layers for name in layer.split(" | ") if (SOURCE / name).is_dir()]
    assert [package for package in rows() if package] == inside


def test_steps_are_where_the_page_says_and_can_be_had_from_python() -> None:
    steps = re.findall(r"^\| [^|]* \| `(\w+)\(.*`\s\| `([\w/]+\.py)` \|$", PAGE, flags=re.MULTILINE)
    assert len(steps) == 9
    for name, file in steps:
        assert name in vgvt.reconcile.__all__
        assert f"def {name}(" in (SOURCE / file).read_text(encoding="utf-8"), (name, file)
