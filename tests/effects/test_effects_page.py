"""The catalogue page and the list on the command line say what the registry says."""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from types import ModuleType

import pytest

from vgvt.cli import main
from vgvt.effects import available_effects, parameters_of


@pytest.fixture
def maker(repository_root: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The script that writes the page, as a module."""
    monkeypatch.syspath_prepend(repository_root / "docs")
    return importlib.import_module("make_effects_page")


def test_the_catalogue_page_is_up_to_date(maker: ModuleType, repository_root: Path) -> None:
    """The committed page is what the script writes; renew it with python docs/make_effects_page.py."""
    page = (repository_root / "docs" / "reference" / "effects.md").read_text(encoding="utf-8")
    assert page == maker.effects_page()


def test_the_catalogue_page_has_a_section_for_every_effect(maker: ModuleType) -> None:
    """Every effect with every parameter, so that the comparison above compares something."""
    page = maker.effects_page()
    assert {"run-drift", "root-friction"} <= set(maker.own_effects())
    for name, effect in maker.own_effects().items():
        assert f"### {name}\n" in page
        for parameter in parameters_of(effect):
            assert f"| `{parameter.name}` | {parameter.unit or '1'} |" in page


def test_list_effects_prints_the_registry(capsys: pytest.CaptureFixture[str]) -> None:
    """One item an effect, with ranges that a program can draw from."""
    assert main(["list", "effects", "--json"]) == 0
    items = {item["name"]: item for item in json.loads(capsys.readouterr().out)["items"]}
    assert set(items) == set(available_effects())
    friction = items["root-friction"]
    assert friction["family"] == "nonlinear"
    assert friction["linear"] is False
    (size,) = [p for p in friction["parameters"] if p["name"] == "friction_n_m"]
    assert (size["unit"], size["neutral"], size["plausible_range"]) == ("N m", 0.0, [0.02, 2.0])
    assert {s["name"] for s in friction["settings"]} == {"kind", "side", "beam"}
