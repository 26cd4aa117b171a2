"""Plain values as TOML text."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

_BARE_KEY = re.compile(r"^[A-Za-z0-9_-]+$")
_LINE = 110


def toml_text(table: Mapping[str, Any]) -> str:
    """A table of texts, numbers, lists and tables as TOML 1.0 text; TypeError for anything else."""
    return "\n".join(_table(table, ())).lstrip("\n") + "\n"


def _table(table: Mapping[str, Any], path: tuple[str, ...]) -> list[str]:
    """Lines of a table: plain values first, since a heading ends them; then tables and arrays of tables."""
    inner = {key: value for key, value in table.items() if isinstance(value, Mapping) or _is_array_of_tables(value)}
    lines = [f"{_key(key)} = {_value(value)}" for key, value in table.items() if key not in inner]
    for key, value in inner.items():
        here = (*path, _key(key))
        heading = ".".join(here)
        if isinstance(value, Mapping):
            lines += ["", f"[{heading}]", *_table(value, here)]
        else:
            for entry in value:
                lines += ["", f"[[{heading}]]", *_table(entry, here)]
    return lines


def _is_array_of_tables(value: Any) -> bool:
    return isinstance(value, (list, tuple)) and bool(value) and all(isinstance(v, Mapping) for v in value)


def _key(key: str) -> str:
    return key if _BARE_KEY.match(key) else _text(key)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(int(value))
    if isinstance(value, float):
        return repr(float(value))
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, (list, tuple)):
        entries = [_value(v) for v in value]
        line = f"[{', '.join(entries)}]"
        return line if len(line) <= _LINE else "[\n" + "".join(f"  {entry},\n" for entry in entries) + "]"
    raise TypeError(f"no TOML for {type(value).__name__}")


def _text(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + re.sub(r"[\x00-\x1f\x7f]", lambda m: f"\\u{ord(m[0]):04x}", escaped) + '"'
