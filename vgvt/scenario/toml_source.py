"""TOML text from disk as plain tables, with every way in which that goes wrong told in words."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from vgvt.data.errors import InputError
from vgvt.files.toml_syntax import parsed_toml


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
    tables = parsed_toml(path, raw)
    if not tables:
        raise InputError(
            str(path),
            "the file is empty",
            'Write at least name, summary and extends = "hati-unsymmetric", then the tables that differ from it.',
        )
    return tables


def _nearby(path: Path) -> str:
    if not path.parent.is_dir():
        return f"The folder {path.parent} does not exist either."
    others = sorted(p.name for p in path.parent.glob("*.toml"))[:8]
    return f"That folder holds {', '.join(others)}." if others else "Check the path; that folder holds no TOML file."
