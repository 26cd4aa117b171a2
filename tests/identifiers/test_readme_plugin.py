"""The plugin of the README is found through its metadata, and the checks say of it what the README says."""

from __future__ import annotations

import importlib
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from vgvt.identification import available_identifiers, make_identifier, settings_of
from vgvt.identification.conformance import checks

README = Path(__file__).resolve().parents[2] / "identifiers" / "README.md"
_CODE = re.findall(r"```(?:toml|python)\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
BLOCKS = dict(zip(("project", "plugin", "test"), _CODE, strict=True))
FAILS = {
    "finds_three_separated_modes",
    "stays_inside_the_band",
    "survives_a_dead_channel",
    "survives_a_channel_that_is_not_finite",
}


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder as pip leaves it: the module and the metadata with the entry point of the README's pyproject.toml."""
    project = tomllib.loads(BLOCKS["project"])["project"]
    ((group, points),) = project["entry-points"].items()
    metadata = tmp_path / f"{project['name']}-{project['version']}.dist-info"
    metadata.mkdir()
    facts = f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n"
    (metadata / "METADATA").write_text(facts)
    (metadata / "entry_points.txt").write_text("\n".join([f"[{group}]", *(f"{k} = {v}" for k, v in points.items())]))
    (tmp_path / "peakpick.py").write_text(BLOCKS["plugin"])
    monkeypatch.syspath_prepend(tmp_path)
    importlib.invalidate_caches()
    yield tmp_path
    sys.modules.pop("peakpick", None)


def test_it_is_found_by_its_name_with_its_settings(installed: Path) -> None:
    assert "peakpick" in available_identifiers()
    made = make_identifier("peakpick", prominence_db="12")
    assert made.name == "peakpick"
    assert [s.name for s in settings_of(type(made))] == ["prominence_db"]


@pytest.mark.parametrize("check", checks(), ids=str)
def test_it_passes_and_fails_the_checks_that_the_readme_names(installed: Path, check) -> None:  # type: ignore[no-untyped-def]
    plugin = make_identifier("peakpick")
    if str(check) in FAILS:
        with pytest.raises(AssertionError):
            check(plugin)
    else:
        check(plugin)


def test_the_readme_names_every_check() -> None:
    text = README.read_text()
    assert not [str(c) for c in checks() if f"`{c}`" not in text]
    assert all(f"`{name}`" in text for name in FAILS)


def test_the_whole_test_file_is_three_lines_and_imports() -> None:
    lines = [line for line in BLOCKS["test"].splitlines() if line.strip() and "import" not in line]
    assert len(lines) == 3
