"""The small JSON files in which a study keeps what is done: whole or not there, and told by their path if cut."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from vgvt.data import InputError
from vgvt.files.atomically import replacing


def keep(file: Path, document: Any, indent: int | None = 1, default: Callable[[Any], Any] | None = None) -> None:
    """Write a document down; what stood there stays until all of it is on the disk."""
    with replacing(file) as part:
        part.write_text(json.dumps(document, indent=indent, default=default), encoding="utf-8")


def read_kept(file: Path, advice: str) -> Any:
    """What a file holds; InputError with its path and ``advice`` where it is cut off, or no JSON at all."""
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(str(file), f"cannot be read: {error.strerror or error}", "make it readable") from error
    except ValueError as error:
        raise cut_off(file, advice) from error


def cut_off(file: Path, advice: str) -> InputError:
    """What is said of a file that does not hold the whole of what a study keeps in it."""
    return InputError(str(file), "is cut off, or not what the study keeps there", advice)
