"""The long table's rows: one per scenario, seed, entry and mode."""

from __future__ import annotations

from typing import Any

from vgvt.bench.entry import Entry
from vgvt.data import Scorecard

MEASURED = ("wall_s", "peak_memory_mib")
"""Columns that no two runs share; all others are the same wherever and however often a bench runs."""

COLUMNS: dict[str, str] = {
    "scenario": "VARCHAR",
    "seed_number": "BIGINT",
    "seed": "BIGINT",
    "entry": "VARCHAR",
    "identifier": "VARCHAR",
    "outcome": "VARCHAR",
    "reason": "VARCHAR",
    "mode": "BIGINT",
    "status": "VARCHAR",
    "label": "VARCHAR",
    "true_hz": "DOUBLE",
    "claimed_hz": "DOUBLE",
    "frequency_error_percent": "DOUBLE",
    "frequency_std_hz": "DOUBLE",
    "frequency_bound_hz": "DOUBLE",
    "frequency_covered": "BOOLEAN",
    "true_spread_hz": "DOUBLE",
    "true_damping_ratio": "DOUBLE",
    "claimed_damping_ratio": "DOUBLE",
    "damping_error_percent": "DOUBLE",
    "damping_ratio_std": "DOUBLE",
    "damping_covered": "BOOLEAN",
    "mac": "DOUBLE",
    "scaling_error_percent": "DOUBLE",
    "remark": "VARCHAR",
    "wall_s": "DOUBLE",
    "peak_memory_mib": "DOUBLE",
}
"""Columns of the table in order, with their types in Parquet."""

FAILED = "failed"
"""Outcome of an entry that came to no claim at all; ``reason`` says why."""


def score_rows(
    common: dict[str, Any], entry: Entry, card: Scorecard, wall_s: float | None, peak_memory_mib: float | None
) -> list[dict[str, Any]]:
    """The rows of a scorecard, at least one: nothing claimed where nothing was to be found is a row without mode."""
    stem = {
        **common,
        "entry": entry.label,
        "identifier": entry.identifier,
        "outcome": card.outcome.value,
        "reason": "; ".join(card.advice) if not card.found + card.false else "",
        "wall_s": wall_s,
        "peak_memory_mib": peak_memory_mib,
    }
    modes = [*card.modes, *card.unreached]
    if not modes:
        return [_complete(stem)]
    return [_complete(row.as_dict() | {"mode": k} | stem) for k, row in enumerate(modes)]


def failure_row(
    common: dict[str, Any], entry: Entry, reason: str, wall_s: float | None, peak_memory_mib: float | None
) -> dict[str, Any]:
    """The row of an entry without a claim."""
    return _complete(
        {
            **common,
            "entry": entry.label,
            "identifier": entry.identifier,
            "outcome": FAILED,
            "reason": reason,
            "wall_s": wall_s,
            "peak_memory_mib": peak_memory_mib,
        }
    )


def _complete(row: dict[str, Any]) -> dict[str, Any]:
    return {name: row.get(name) for name in COLUMNS}
