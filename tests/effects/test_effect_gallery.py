"""The page of small multiples shows every effect, and its pictures can be drawn again."""

from __future__ import annotations

import importlib
from pathlib import Path
from types import ModuleType

import pytest

from vgvt.effects import available_effects


@pytest.fixture
def maker(repository_root: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The script that draws the page, as a module."""
    monkeypatch.syspath_prepend(repository_root / "docs")
    return importlib.import_module("make_effect_figures")


def own_effects() -> set[str]:
    return {name for name, cls in available_effects().items() if cls.__module__.startswith("vgvt.effects.")}


def test_the_page_shows_every_effect_with_its_signature(repository_root: Path) -> None:
    """One heading, one picture that exists, and the signature; renew with python docs/make_effect_figures.py."""
    page = repository_root / "docs" / "reference" / "effect-gallery.md"
    text = page.read_text(encoding="utf-8")
    for name in own_effects():
        assert f"### [{name}](effects.md#{name})" in text
        assert f"![{name}](../images/effects/{name}.png)" in text
        signature: str = available_effects()[name].signature
        assert f"{signature[0].upper()}{signature[1:]}." in text
    pictures = page.parent.parent / "images" / "effects"
    assert {path.stem for path in pictures.glob("*.png")} == own_effects()
    assert sum(path.stat().st_size for path in pictures.glob("*.png")) < 3e6


def test_every_effect_has_a_spoiled_scenario(maker: ModuleType) -> None:
    assert set(maker.spoiled_scenarios()) == own_effects()


def test_one_effect_is_drawn(maker: ModuleType, tmp_path: Path) -> None:
    """A delay changes the response by about the phase that it turns: a picture and a caption come out."""
    change = maker.draw("channel-delay", maker.spoiled_scenarios()["channel-delay"], tmp_path)
    assert 0.01 < change < 0.5
    assert (tmp_path / "channel-delay.png").read_bytes()[:4] == b"\x89PNG"
    captions = maker.gallery({"channel-delay": change, "gain-drift": 0.001})
    assert "No trace in A/F" in captions.split("### [gain-drift]")[1]
    assert "No trace in A/F" not in captions.split("### [channel-delay]")[1].split("###")[0]
