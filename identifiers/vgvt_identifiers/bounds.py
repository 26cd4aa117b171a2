"""Settings within bounds: what lies outside is refused before any work is done, with what to give instead."""

from __future__ import annotations

from collections.abc import Mapping

from vgvt.data import InputError


def check_bounds(settings: object, bounds: Mapping[str, tuple[float, float]]) -> None:
    """InputError for a setting outside its bounds (low, high), both of which are within; NaN is outside of any."""
    for name, (low, high) in bounds.items():
        value = getattr(settings, name)
        if not low <= value <= high:
            raise InputError(str(getattr(settings, "name", "")), f"{name} = {value}", f"give {low:g} to {high:g}")
