"""The long table's rows: one per scenario, seed, entry and mode."""

from __future__ import annotations

from typing import Any

import numpy as np

from vgvt.bench.entry import Entry
from vgvt.data import FrfFit, Scorecard

MEASURED = ("wall_s", "peak_memory_mib")
"""Columns that no two runs share; all others are the same wherever a bench runs, unless a method ran out of time."""

COLUMNS: dict[str, str] = {
    "scenario": "VARCHAR",
    "seed_number": "BIGINT",
    "seed": "BIGINT",
    "entry": "VARCHAR",
    "identifier": "VARCHAR",
    "outcome": "VARCHAR",
    "reason": "VARCHAR",
    "true_modes": "VARCHAR",
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
    "frequency_efficiency": "DOUBLE",
    "mac": "DOUBLE",
    "scaling_error_percent": "DOUBLE",
    "as_tested_hz": "DOUBLE",
    "as_tested_damping_ratio": "DOUBLE",
    "split": "BOOLEAN",
    "remark": "VARCHAR",
    "frf_fit_percent": "DOUBLE",
    "nu_gap": "DOUBLE",
    "wall_s": "DOUBLE",
    "peak_memory_mib": "DOUBLE",
}
"""Columns of the table in order, with their types in Parquet.

``true_modes`` says what a claim was judged by: ``as_tested``, or ``coupled`` for one without the force, whose rows
have the mode as tested beside. ``frf_fit_percent`` (median NRMSE fit over the responses), ``nu_gap`` (largest over the
band), ``wall_s`` and ``peak_memory_mib`` are those of the whole claim, the same in each of its rows.
"""

FAILED = "failed"
"""Outcome of an entry that came to no claim at all; ``reason`` says why."""

OUT_OF_TIME = "took more than"
"""What the reason of an entry begins with that was stopped by the clock: the machine has a part in it."""


def score_rows(common: dict[str, Any], entry: Entry, card: Scorecard, fit: FrfFit | None) -> list[dict[str, Any]]:
    """The rows of a scorecard, at least one: nothing claimed where nothing was to be found is a row without mode.

    ``common`` are the columns of the campaign and of the cost, ``fit`` None where no responses could be compared.
    """
    stem = {
        **common,
        "entry": entry.label,
        "identifier": entry.identifier,
        "outcome": card.outcome.value,
        "true_modes": card.true_modes.value,
        "reason": "; ".join(card.advice) if not card.found + card.false else "",
    }
    if fit is not None:
        stem |= {"frf_fit_percent": float(np.median(fit.fit_percent)), "nu_gap": float(fit.nu_gap.max())}
    modes = [*card.modes, *card.unreached]
    if not modes:
        return [_complete(stem)]
    return [
        _complete(row.as_dict() | {"mode": k, "split": row.remark.startswith("split")} | stem)
        for k, row in enumerate(modes)
    ]


def failure_row(common: dict[str, Any], entry: Entry, reason: str) -> dict[str, Any]:
    """The row of an entry without a claim."""
    return _complete(
        {**common, "entry": entry.label, "identifier": entry.identifier, "outcome": FAILED, "reason": reason}
    )


def ran_out_of_time(row: dict[str, Any]) -> bool:
    """Whether the row is that of an entry that the clock stopped."""
    return row["outcome"] == FAILED and str(row["reason"]).startswith(OUT_OF_TIME)


def _complete(row: dict[str, Any]) -> dict[str, Any]:
    return {name: row.get(name) for name in COLUMNS}
