"""Words for what a validator finds in a file: the value that was given, and the limit that it does not keep."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

BOUNDS = {
    "greater_than": ("gt", "more than"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "at most"),
}
"""By kind of a finding: where the validator holds the limit, and the words for it."""


def bound(kind: str, limits: Mapping[str, Any]) -> str:
    """``more than 0``: the limit of a finding of one of the kinds in :data:`BOUNDS`."""
    limit, words = BOUNDS[kind]
    return f"{words} {limits[limit]:g}"


def miscounted(detail: Mapping[str, Any]) -> bool:
    """Whether a list is called short although it is not: the validator counts the entries that it found right."""
    value = detail["input"]
    return (
        detail["type"] == "too_short" and isinstance(value, list | tuple) and len(value) >= detail["ctx"]["min_length"]
    )


def shown(value: Any) -> str:
    """A value as TOML has it, cut where it is long."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f'"{value}"' if len(value) <= 40 else f'"{value[:37]}…"'
    if isinstance(value, (list, tuple)):
        inside = ", ".join(shown(v) for v in value[:4])
        return f"[{inside}{', …' if len(value) > 4 else ''}]"
    if isinstance(value, dict):
        return "a table"
    return str(value)
