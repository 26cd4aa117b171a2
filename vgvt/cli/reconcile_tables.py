"""The verdict of a reconciliation in the terminal, from its document."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vgvt.view.fitted_table import FittedTable
    from vgvt.view.power_account import PowerRow

_SETS = {"train": "fitted", "held_out": "held out", "held_runs": "  whole runs", "held_channels": "  single channels"}
# Longer names of parameters fold: beside the longest effect's they would be cut in 80 columns.
_PARAMETER = 20


def error_table(document: Mapping[str, Any]) -> FittedTable:
    """How far models are from the data, fitted and held out: calibrated, with what was named, simulated again."""
    from vgvt.view.fitted_table import FittedTable
    from vgvt.view.reconcile_wording import held_once

    models = {"calibrated": document["before"]}
    if document["effects"]:
        models["with what was named"] = document["after"]
    again = document.get("resimulated") or {}
    if again.get("train"):
        models["simulated again"] = again
    rows = []
    for key, words in held_once(_SETS, document["before"]).items():
        found = {name: sets[key] for name, sets in models.items() if sets.get(key)}
        for k, (name, merit) in enumerate(found.items()):
            numbers = f"{merit['chi2_per_dof']:.2f}", f"{merit['nrmse_percent']:.2f}", f"{merit['mean_abs_db']:.3f}"
            rows.append((words if k == 0 else "", name, *numbers))
    columns = ("data", "model", "χ² per dof", "NRMSE fit %", "dB off")
    return FittedTable(
        columns=columns,
        rows=tuple(rows),
        whole=frozenset(columns),
        expendable=columns[-1:],
        right=frozenset(columns[2:]),
        title="predicted responses against measured ones; an NRMSE fit of 100 % is perfect",
        caption=again.get("remark") or "",
    )


def effects_table(effects: Sequence[Mapping[str, Any]]) -> FittedTable:
    """What was named, or comes nearest, with its parameters, evidence and equals."""
    from vgvt.view.fitted_table import FittedTable
    from vgvt.view.reconcile_wording import as_well, fitted_text, settings_texts

    rows = []
    for e in effects:
        values = [
            fitted_text(k, p["value"], p["std"], p["unit"], (p["low"], p["high"]) if "low" in p else None)
            for k, p in e["parameters"].items()
        ]
        values += settings_texts(e["name"], e["settings"], e.get("run_numbers", {}))
        alike = ", ".join(as_well(e["equivalent"], [there["where"] for there in e.get("elsewhere", ())]))
        rows.append((e["name"], ", ".join(values), f"{e['evidence_nats']:.0f}", alike))
    return FittedTable(
        columns=("effect", "parameters", "nats", "explains it as well"),
        rows=tuple(rows),
        whole=frozenset(("effect", "nats")),
        right=frozenset(("nats",)),
    )


def power_table(rows: Sequence[PowerRow]) -> FittedTable:
    """The sizes of each effect that could be seen, and that would get its name."""
    from vgvt.view.fitted_table import FittedTable

    cells, several = [], any(p.variants > 1 for p in rows)
    for p in rows:
        smallest, named, worst = p.sizes
        likes = [f"{name} {cosine:.2f}" for name, cosine in p.alike[:3]]
        likes += [f"itself at {place} {cosine:.2f}" for place, cosine in p.other_places[:1]]
        alike = ", ".join(likes)
        plausible = f"{p.low:g} to {p.high:g}"
        cells.append((p.effect, p.parameter, smallest, named, worst, p.unit, plausible, p.shows, alike))
    longest = max((len(p.parameter) for p in rows), default=0)
    columns = (
        "effect", "parameter", "just visible", "named from", "at worst", "unit", "plausible", "visible",
        "hard to tell from",
    )  # fmt: skip
    return FittedTable(
        columns=columns,
        rows=tuple(cells),
        whole=frozenset(columns) - {"hard to tell from", *(() if longest <= _PARAMETER else ("parameter",))},
        # Never the parameter: rows of one effect may differ in nothing else, and its name ends in its unit.
        expendable=("hard to tell from", "plausible", "at worst", "unit"),
        right=frozenset(("just visible", "named from", "at worst")),
        title="where it shows best; just visible: five standard deviations beyond the tolerances; "
        "named from: 95 of 100",
        caption="; ".join(
            (
                f"{sum(p.visible for p in rows)} of {len(rows)} show within their plausible range",
                *(("at worst: just visible at the place, side or channel that shows it least",) if several else ()),
                "whatever else an effect has (a frequency, an angle) is at its default",
                *dict.fromkeys(p.reason for p in rows if ":" in p.reason),
            )
        ),
    )
