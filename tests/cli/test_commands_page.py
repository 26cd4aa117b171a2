"""The reference of the commands is what they print, and help prints what its texts say."""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

from vgvt.cli import main


@pytest.fixture(scope="module")
def maker(repository_root: Path) -> Iterator[ModuleType]:
    """The script that writes the page, imported from where it lies."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(repository_root / "docs"))
        yield importlib.import_module("make_commands_page")


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
