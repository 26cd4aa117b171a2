"""The reference of the commands is what they print, and help prints what its texts say."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import pytest

from vgvt.cli import main


@pytest.fixture(scope="module")
def maker(repository_root: Path) -> ModuleType:
    """The script that writes the page."""
    place = repository_root / "docs" / "make_commands_page.py"
    spec = importlib.util.spec_from_file_location("make_commands_page", place)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_page_is_up_to_date(maker: ModuleType) -> None:
    """The committed page is what the script writes; renew it with python docs/make_commands_page.py."""
    assert maker.PAGE.read_text(encoding="utf-8") == maker.commands_page()


def test_every_option_of_every_help_is_on_the_page(
    maker: ModuleType, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    sections = dict(re.findall(r"^## (vgvt [a-z ]+)\n(.*?)(?=^## |\Z)", maker.commands_page(), re.M | re.S))
    assert len(sections) == len(list(maker.commands())) >= 20
    for words, section in sections.items():
        assert main([*words.split()[1:], "--help"]) == 0
        printed = capsys.readouterr().out
        said, written = (set(re.findall(r"(?<![\w-])--[a-z][a-z-]+", text)) for text in (printed, section))
        assert said - written <= {"--help", "--json"}, words
        assert written <= said, words


def test_help_prints_its_texts_with_what_stands_in_brackets(
    maker: ModuleType, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Rich takes a word in brackets for a style and leaves it out, as the beam's name in a key of a sweep."""
    monkeypatch.setenv("COLUMNS", "200")
    for words, command in maker.commands():
        assert main([*words.split()[1:], "--help"]) == 0
        printed = capsys.readouterr().out
        for word in re.findall(r"\S*\[\S*", maker.plain(command.help or "")):
            assert word.rstrip(".,") in printed, words
