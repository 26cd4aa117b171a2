"""TOML from disk as plain tables; what is no TOML is told with its line, its column and what stands there."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from vgvt.data import InputError

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
    "Unterminated string": "Close the text with a quotation mark; if the file has been cut off here, copy it again.",
}


def parsed_toml(path: Path, raw: bytes) -> dict[str, Any]:
    """The tables that the bytes of a file say; InputError, with the line, where they are not UTF-8 or not TOML."""
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise InputError(
            f"{path}, line {line}",
            f"byte 0x{raw[error.start]:02x} is not UTF-8 text",
            "Save the file as UTF-8; TOML is text.",
        ) from None
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise _syntax_error(path, text, error) from None


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
