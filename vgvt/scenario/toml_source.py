"""TOML text from disk as plain tables, with every way in which that goes wrong told in words."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from vgvt.data.errors import InputError

_POSITION = re.compile(
    r"^(?P<what>.*) \(at (?:line (?P<line>\d+), column (?P<column>\d+)|end of document)\)$", re.DOTALL
)
_ADVICE = {
    "Cannot overwrite a value": "This key or table is there twice; keep one of them.",
    "Cannot declare": "This table is there twice; keep one of them.",
    "Invalid value": 'Write numbers like 0.5 (not .5 or 0,5), text in "quotes", lists in [1, 2], and true or false.',
    "Unclosed array": "Close the list with ] and put a comma between its entries.",
    "Expected '=' after a key": "Write key = value; a table's heading stands in [brackets].",
    "Illegal character": "Close the text with a quotation mark on the same line.",
}


def read_toml(path: Path) -> dict[str, Any]:
    """The tables of a TOML file; InputError for a file that is missing, a folder, empty, not UTF-8 or not TOML."""
    try:
        raw = path.read_bytes()
    except FileNotFoundError:
        raise InputError(str(path), "there is no such file", _nearby(path)) from None
    except IsADirectoryError:
        raise InputError(str(path), "this is a folder", "Name the scenario's TOML file inside it.") from None
    except OSError as error:
        raise InputError(
            str(path), f"cannot be read ({error.strerror})", "Check the path and its permissions."
        ) from None
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise InputError(
            f"{path}, line {line}",
            f"byte 0x{raw[error.start]:02x} is not UTF-8 text",
            "Save the file as UTF-8; a scenario is a TOML text file.",
        ) from None
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise _syntax_error(path, text, error) from None
    if not tables:
        raise InputError(
            str(path),
            "the file is empty",
            'Write at least name, summary and extends = "hati-unsymmetric", then the tables that differ from it.',
        )
    return tables


def _syntax_error(path: Path, text: str, error: tomllib.TOMLDecodeError) -> InputError:
    match = _POSITION.match(str(error))
    what = match["what"] if match else str(error)
    if match and match["line"]:
        line, column = int(match["line"]), int(match["column"])
    else:
        line = max(text.rstrip().count("\n") + 1, 1)
        column = len(text.rstrip().rsplit("\n", 1)[-1]) + 1
    advice = next((words for start, words in _ADVICE.items() if what.startswith(start)), "Check the line against TOML.")
    lines = text.splitlines()
    shown = f" The line reads: {lines[line - 1].strip()}" if line <= len(lines) and lines[line - 1].strip() else ""
    return InputError(f"{path}, line {line}, column {column}", f"not TOML: {what[0].lower()}{what[1:]}", advice + shown)


def _nearby(path: Path) -> str:
    if not path.parent.is_dir():
        return f"The folder {path.parent} does not exist either."
    others = sorted(p.name for p in path.parent.glob("*.toml"))[:8]
    return f"That folder holds {', '.join(others)}." if others else "Check the path; that folder holds no TOML file."
