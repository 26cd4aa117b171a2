"""Write the reference of the commands from what ``--help`` prints: ``python docs/make_commands_page.py``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import typer
from studies.command_line import BEGIN_AGAIN, parser_of, worked_off

from vgvt.cli.app import app
from vgvt.files.atomically import replacing

PAGE = Path(__file__).parent / "reference" / "commands.md"

_HEAD = """# The commands

Written by `python docs/make_commands_page.py` from what `vgvt COMMAND --help` prints; edit the texts in `vgvt/cli/`,
not this page.

Every command has `--help` (`-h`) and `--json`, which prints exactly one object on stdout
([its keys](json-contract.md)); they are left out below. `vgvt --version` prints the version.
Where no default stands, the meaning says what counts without the option.
"""
_EVERYWHERE = {"--help", "--json"}


def commands() -> Iterator[tuple[str, Any]]:
    """Every command by the words that call it, in the order of ``vgvt --help``."""

    def walk(command: Any, words: str) -> Iterator[tuple[str, Any]]:
        inner = getattr(command, "commands", None)
        if inner is None:
            yield words, command
            return
        for name, child in inner.items():
            yield from walk(child, f"{words} {name}")

    yield from walk(typer.main.get_command(app), "vgvt")


def commands_page() -> str:
    """The whole page as Markdown: one section a command, one row an argument or option."""
    lines = [_HEAD]
    for words, command in commands():
        lines += [f"## {words}", "", " ".join(_cell(plain(command.help or "")).split()), ""]
        rows = [_row(parameter) for parameter in command.params if not _EVERYWHERE & set(parameter.opts)]
        if rows:
            lines += ["| argument or option | default | meaning |", "|---|---|---|", *rows, ""]
    return "\n".join(lines).rstrip() + "\n"


def plain(text: str) -> str:
    """A text of the help as a terminal shows it: a backslash keeps brackets from being taken for a style."""
    return text.replace(r"\[", "[")


def _row(parameter: Any) -> str:
    default = parameter.default
    if parameter.required:
        shown = "*required*"
    elif parameter.secondary_opts:
        shown = f"`{(parameter.opts if default else parameter.secondary_opts)[0]}`"
    else:
        shown = "" if default is None or default is False or default == "" else f"`{_cell(_number(default))}`"
    return f"| `{_cell(_written(parameter))}` | {shown} | {_cell(plain(parameter.help or ''))} |"


def _written(parameter: Any) -> str:
    """An argument or option as it is typed, with a word for what it takes."""
    if not parameter.opts[0].startswith("-"):
        return str(parameter.metavar or parameter.name.upper())
    names = ", ".join((*parameter.opts, *parameter.secondary_opts))
    return names if parameter.is_flag else f"{names} {parameter.metavar or 'N'}"


def _number(default: Any) -> str:
    return f"{default:g}" if isinstance(default, float) else str(default)


def _cell(text: str) -> str:
    return text.replace("|", r"\|")


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line, on which there is nothing to choose."""
    return parser_of(__doc__).parse_args(words)


def fill() -> None:
    """Write the page."""
    with replacing(PAGE) as part:
        part.write_text(commands_page(), encoding="utf-8")


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    arguments(words)
    return worked_off(fill, BEGIN_AGAIN)


if __name__ == "__main__":
    sys.exit(main())
