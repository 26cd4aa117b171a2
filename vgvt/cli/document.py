"""The one JSON object of --json: plain values, no NaN, no infinity."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping
from enum import Enum
from pathlib import Path
from typing import Any


def plain(value: Any) -> Any:
    """The same value in types that JSON knows; numbers that are not finite become None.

    Arrays and tuples become lists, DOFs and paths text, complex numbers
    {"real", "imag"}. TypeError for anything else.
    """
    if value is None or (isinstance(value, (bool, str)) and not isinstance(value, Enum)):
        return value
    if isinstance(value, Enum):
        return plain(value.value)
    if hasattr(value, "tolist"):  # numpy arrays and scalars, without importing numpy
        return plain(value.tolist())
    if isinstance(value, int):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, complex):
        return {"real": plain(value.real), "imag": plain(value.imag)}
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple, set, frozenset)):
        return [plain(item) for item in value]
    if isinstance(value, Path) or type(value).__name__ == "Dof":
        return str(value)
    raise TypeError(f"{type(value).__name__} has no place in a JSON document")


def document_text(document: Mapping[str, Any]) -> str:
    """The document as indented ASCII JSON with a closing newline."""
    return json.dumps(plain(document), indent=2, allow_nan=False) + "\n"


def write_document(document: Mapping[str, Any]) -> None:
    """Print the document on stdout."""
    sys.stdout.write(document_text(document))
    sys.stdout.flush()
