"""The reference of the keys is what the schema says, and the schema says something about every key."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

from vgvt.scenario.airframe import Airframe
from vgvt.scenario.base import Table, written_fields
from vgvt.scenario.vocabulary import unit_of


@pytest.fixture(scope="module")
def maker(repository_root: Path) -> Iterator[ModuleType]:
    """The script that writes the page."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(repository_root / "docs")
        yield importlib.import_module("make_scenario_keys")


def test_the_page_is_up_to_date(maker: ModuleType) -> None:
    """The committed page is what the script writes; renew it with python docs/make_scenario_keys.py."""
    assert maker.PAGE.read_text(encoding="utf-8") == maker.keys_page()


def test_the_page_has_every_key_of_every_table(maker: ModuleType) -> None:
    found: dict[type[Table], list[str]] = maker.tables()
    noisy = [h for hs in found.values() for h in hs if "noise" in h]
    assert sorted(noisy) == ["[accelerometers.noise]", "[hammer.noise]", "[transducer.noise]"]
    sections = maker.keys_page().split("\n## ")[1:]
    assert len(sections) == len(found) >= 18
    for (table, headings), section in zip(found.items(), sections, strict=True):
        assert all(heading in section.splitlines()[0] for heading in headings)
        rows = [line.split(" | ") for line in section.splitlines() if line.startswith("| `")]
        assert [row[0] for row in rows] == [f"| `{key}`" for key in written_fields(table)]
        assert [row[2] for row in rows] == [unit_of(key) for key in written_fields(table)]


def test_what_only_effects_set_is_on_no_page(maker: ModuleType) -> None:
    """Written in a file, ``airframe.hinged`` is refused: its mass would be thrown away."""
    assert "hinged" in Airframe.model_fields
    assert "hinged" not in maker.keys_page()


def test_every_key_says_what_it_means(maker: ModuleType) -> None:
    silent = [
        f"{table.__name__}.{key}"
        for table in maker.tables()
        for key, field in table.model_fields.items()
        if not (field.description or "").strip()
    ]
    assert not silent, "give it a docstring under its line"
