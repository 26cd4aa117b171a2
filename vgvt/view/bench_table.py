"""Tables of a bench for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas

    from vgvt.view.fitted_table import FittedTable

_SUMMARY = {
    "campaigns": ("campaigns", "{:.0f}"),
    "failed": ("failed", "{:.0f}"),
    "found": ("found", "{:.2g}"),
    "missed": ("missed", "{:.2g}"),
    "false": ("false", "{:.2g}"),
    "rms_frequency_error_percent": ("Δf %", "{:.3f}"),
    "rms_damping_error_percent": ("Δζ %", "{:.2f}"),
    "min_mac": ("MAC", "{:.3f}"),
    "rms_error_over_bound": ("÷ bound", "{:.2f}"),
    "frequency_coverage": ("cover f", "{:.2f}"),
    "damping_coverage": ("cover ζ", "{:.2f}"),
    "wall_s": ("s", "{:.2f}"),
    "peak_memory_mib": ("MiB", "{:.0f}"),
}


def bench_table(summary: pandas.DataFrame) -> FittedTable:
    """A rich renderable of a bench's summary; found, missed and false are modes per campaign."""
    from vgvt.view.fitted_table import FittedTable

    heads = tuple(head for head, _ in _SUMMARY.values())
    return FittedTable(
        columns=("scenario", "entry", *heads),
        rows=tuple(
            (row["scenario"], row["entry"], *(_text(row[name], form) for name, (_, form) in _SUMMARY.items()))
            for row in summary.to_dict("records")
        ),
        whole=frozenset(("entry", "found", "missed", "false", "Δf %")),
        expendable=("MiB", "campaigns", "cover ζ", "cover f", "s", "÷ bound", "MAC"),
        right=frozenset(heads),
        title="bench",
        caption="found, missed, false: modes a campaign; errors: root mean square; ÷ bound: 1 is the theoretical limit",
    )


def comparison_table(comparison: pandas.DataFrame) -> FittedTable:
    """A rich renderable of what changed against a baseline; what stayed the same is only counted."""
    from vgvt.view.fitted_table import FittedTable

    changed = comparison[comparison["verdict"].isin(["worse", "better"])]
    worse, same = int((comparison["verdict"] == "worse").sum()), len(comparison) - len(changed)
    numbers = ("before", "after", "effect", "p")
    return FittedTable(
        columns=("verdict", "scenario", "entry", "measure", *numbers, "seeds"),
        rows=tuple(
            (
                row["verdict"],
                row["scenario"],
                row["entry"],
                row["measure"].replace("_", " "),
                _text(row["before"], "{:.3g}"),
                _text(row["after"], "{:.3g}"),
                _text(row["effect_size"], "{:+.2f}"),
                _text(row["p_value"], "{:.1e}"),
                str(row["pairs"]),
            )
            for row in changed.to_dict("records")
        ),
        whole=frozenset(("verdict", "entry", *numbers)),
        expendable=("seeds", "p"),
        right=frozenset((*numbers, "seeds")),
        title="against the baseline",
        caption=f"{worse} worse, {len(changed) - worse} better, {same} the same within the seeds' scatter",
    )


def _text(value: Any, form: str) -> str:
    return "" if value is None or value != value else form.format(value)
