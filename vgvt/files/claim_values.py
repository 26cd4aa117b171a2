"""The values of a claim's document, each checked as it is read and told by its key where it is wrong."""

from __future__ import annotations

import math
from typing import Any

from vgvt.data import Dof


class BadKeyError(Exception):
    """A key of a claim whose value is missing or cannot be meant."""

    def __init__(self, key: str, problem: str) -> None:
        self.key = key
        self.problem = problem
        super().__init__(key)


def value_of(document: dict[str, Any], key: str, where: str = "") -> Any:
    """The value of a key that must be there."""
    if key not in document:
        raise BadKeyError(_path(where, key), "this key is missing")
    return document[key]


def number(document: dict[str, Any], key: str, where: str, least: float = -math.inf) -> float:
    """A finite number, ``least`` or more."""
    value = value_of(document, key, where)
    found = _finite(value)
    if found is None:
        raise BadKeyError(_path(where, key), f"expected a number, got {_shown(value)}")
    if found < least:
        raise BadKeyError(_path(where, key), f"expected a number of at least {least:g}, got {_shown(value)}")
    return found


def number_or_nan(document: dict[str, Any], key: str, where: str, least: float = -math.inf) -> float:
    """A number as above; NaN where it is null or left out, which is how a claim says that it does not know."""
    return math.nan if document.get(key) is None else number(document, key, where, least)


def damping_ratio(document: dict[str, Any], where: str) -> float:
    """A damping ratio; NaN where none is stated.

    A method may claim an unstable pole, and then is scored on it. At 1 and beyond nothing swings: no mode has that.
    """
    ratio = number_or_nan(document, "damping_ratio", where)
    if abs(ratio) >= 1:
        problem = f"expected a fraction of critical damping between -1 and 1 (not per cent), got {ratio:g}"
        raise BadKeyError(_path(where, "damping_ratio"), problem)
    return ratio


def text(document: dict[str, Any], key: str, where: str = "", needed: bool = False) -> str:
    """Words; where they are not ``needed``, empty for a key that is null or left out."""
    value = value_of(document, key, where) if needed else document.get(key)
    if value is None and not needed:
        return ""
    if not isinstance(value, str):
        raise BadKeyError(_path(where, key), f"expected text, got {_shown(value)}")
    return value


def texts(document: dict[str, Any], key: str, where: str = "") -> tuple[str, ...]:
    """A list of words; empty where the key is null or left out."""
    value = document.get(key)
    if value is None:
        return ()
    if not isinstance(value, list) or not all(isinstance(entry, str) for entry in value):
        raise BadKeyError(_path(where, key), f"expected a list of texts, got {_shown(value)}")
    return tuple(value)


def yes_or_no(document: dict[str, Any], key: str) -> bool:
    """True or false; false where the key is null or left out."""
    value = document.get(key)
    if value is None:
        return False
    if not isinstance(value, bool):
        raise BadKeyError(key, f"expected true or false, got {_shown(value)}")
    return value


def settings(document: dict[str, Any]) -> dict[str, str]:
    """Settings by name, as text; none where the key is null or left out."""
    value = document.get("settings")
    if value is None:
        return {}
    if not isinstance(value, dict):
        raise BadKeyError("settings", f"expected an object, got {_shown(value)}")
    return {key: str(entry) for key, entry in value.items()}


def band(value: Any) -> tuple[float, float]:
    """A band in Hz."""
    ends = [_finite(end) for end in value] if isinstance(value, list) and len(value) == 2 else [None, None]
    low, high = ends
    if low is None or high is None or not 0 <= low < high:
        raise BadKeyError("band_hz", f"expected [low, high] with 0 <= low < high, got {_shown(value)}")
    return low, high


def degree_of_freedom(point: dict[str, Any], where: str) -> Dof:
    """The DOF of a point of a shape."""
    try:
        return Dof.from_label(str(value_of(point, "dof", where)))
    except ValueError as error:
        raise BadKeyError(_path(where, "dof"), str(error)) from None


def check_once(dofs: tuple[Dof, ...], where: str) -> None:
    """BadKeyError where a DOF is listed twice; opposite directions are one DOF with its sign changed."""
    seen: dict[Dof, Dof] = {}
    for dof in dofs:
        if dof.unsigned in seen:
            raise BadKeyError(where, f"{seen[dof.unsigned]} and {dof} are one DOF; list every DOF once")
        seen[dof.unsigned] = dof


def _finite(value: Any) -> float | None:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        found = float(value)
    except OverflowError:  # JSON knows whole numbers of any length.
        return None
    return found if math.isfinite(found) else None


def _shown(value: Any) -> str:
    said = repr(value)
    return said if len(said) <= 60 else f"{said[:57]}..."


def _path(where: str, key: str) -> str:
    return f"{where}.{key}" if where else key
