"""An aircraft hangs on one spring: what to write for several bungees."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from vgvt.scenario.base import MisfitError

_LIMIT = (
    "Springs apart also hold the aircraft in roll and pitch, which one does not: keep what they make of these far "
    "below the first mode."
)


def one_suspension(given: Any) -> Any:
    """The table, as it is; MisfitError for an array of tables, with the one spring that several amount to."""
    if not isinstance(given, list | tuple):
        return given
    tables = [table for table in given if isinstance(table, Mapping)]
    if len(given) == 1 and tables:
        raise MisfitError((), "is an array of tables, but must be one table", "Write its heading as [suspension].")
    if not given:
        raise MisfitError((), "is an empty array, but must be one table", "Write [suspension] with hook_m.")
    together = f" with {_together(tables)}" if len(tables) == len(given) and _complete(tables) else ""
    raise MisfitError(
        (),
        f"is {len(given)} tables, but the aircraft hangs on one spring",
        f"Write one [suspension]{together}: the sum of stiffness and damping, at the mean of the hooks weighted by "
        f"stiffness. {_LIMIT}",
    )


def _complete(tables: list[Mapping[str, Any]]) -> bool:
    """Whether every table has a stiffness above zero and a hook of three numbers, all finite."""
    return all(
        _number(table.get("stiffness_n_per_m"))
        and table["stiffness_n_per_m"] > 0
        and isinstance(hook := table.get("hook_m"), list | tuple)
        and len(hook) == 3
        and all(_number(value) for value in hook)
        for table in tables
    )


def _together(tables: list[Mapping[str, Any]]) -> str:
    """Stiffness and hook of the spring that parallel ones amount to in heave."""
    total = sum(table["stiffness_n_per_m"] for table in tables)
    hook = [sum(t["stiffness_n_per_m"] * t["hook_m"][k] for t in tables) / total for k in range(3)]
    return f"stiffness_n_per_m = {total:g} and hook_m = [{', '.join(f'{round(x, 4) + 0.0:g}' for x in hook)}]"


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
