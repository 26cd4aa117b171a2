"""Tables for people."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

if TYPE_CHECKING:
    from vgvt.cli.claim import Claim
    from vgvt.data import ModalModel, ModeScore, Scorecard, Truth

_NOTHING = "-"


def score_table(card: Scorecard) -> Table:
    """True against claimed, one row a mode, with the verdict below."""
    table = Table(title=f"{card.scenario}: {card.identifier}, {card.band_hz[0]:g} to {card.band_hz[1]:g} Hz")
    table.add_column("mode")
    for heading in ("true Hz", "claimed Hz", "error %", "true damping %", "claimed %", "error %", "MAC"):
        table.add_column(heading, justify="right")
    table.add_column("verdict")
    rows = sorted((*card.modes, *card.unreached), key=lambda row: row.true_hz or row.claimed_hz or 0.0)
    for row in rows:
        table.add_row(*_score_cells(row))
    summary = card.summary()
    table.caption = f"{card.found} of {summary['true_modes']} modes found, {card.missed} missed, {card.false} false" + (
        f", {len(card.unreached)} out of the shaker's reach" if card.unreached else ""
    )
    return table


def _score_cells(row: ModeScore) -> tuple[str | Text, ...]:
    colour = {"found": "green", "missed": "red", "false": "red"}.get(row.status.value, "dim")
    return (
        row.label or _NOTHING,
        _number(row.true_hz, ".3f"),
        _number(row.claimed_hz, ".3f"),
        _number(row.frequency_error_percent, "+.2f"),
        _number(row.true_damping_ratio, ".2f", 100),
        _number(row.claimed_damping_ratio, ".2f", 100),
        _number(row.damping_error_percent, "+.1f"),
        _number(row.mac, ".3f"),
        Text(row.status.value, style=colour),
    )


def claim_table(claim: Claim) -> Table:
    """Frequencies, damping ratios and remarks of a claim."""
    model = claim.model
    table = Table(title=f"{claim.identifier}, {claim.band_hz[0]:g} to {claim.band_hz[1]:g} Hz: {model.outcome.value}")
    table.add_column("mode", justify="right")
    for heading in ("Hz", "std Hz", "damping %", "std %"):
        table.add_column(heading, justify="right")
    table.add_column("shape (largest first)")
    table.add_column("remarks")
    for k in range(len(model)):
        frequency_std = None if model.natural_frequency_std_hz is None else model.natural_frequency_std_hz[k]
        damping_std = None if model.damping_ratio_std is None else model.damping_ratio_std[k]
        table.add_row(
            str(k + 1),
            _number(model.natural_frequency_hz[k], ".3f"),
            _number(frequency_std, ".4f"),
            _number(model.damping_ratio[k], ".2f", 100),
            _number(damping_std, ".2f", 100),
            _largest(model, k),
            ", ".join((*model.labels[k : k + 1], *(model.flags[k] if model.flags else ()))),
        )
    return table


def _largest(model: ModalModel, mode: int, count: int = 3) -> str:
    shape = model.shapes[mode]
    order = sorted(range(shape.size), key=lambda i: -abs(shape[i]))[:count]
    if not order or abs(shape[order[0]]) == 0:
        return _NOTHING
    reference = shape[order[0]]
    return "  ".join(f"{model.dofs[i]} {(shape[i] / reference).real:+.2f}" for i in order)


def truth_table(truth: Truth, band_hz: tuple[float, float]) -> Table:
    """Modes of the bare airframe, and of the aircraft as tested in the first run."""
    table = Table(title=f"{truth.scenario}: true modes up to {band_hz[1]:g} Hz")
    table.add_column("state")
    table.add_column("mode")
    table.add_column("Hz", justify="right")
    table.add_column("damping %", justify="right")
    states: Sequence[tuple[str, ModalModel]] = (
        ("bare airframe", truth.bare.band(0.0, band_hz[1])),
        (f"as tested, run {truth.runs[0]}", truth.as_tested[0].band(0.0, band_hz[1])),
    )
    for state, model in states:
        for k in range(len(model)):
            label = model.labels[k] if model.labels else str(k + 1)
            frequency, damping = model.natural_frequency_hz[k], model.damping_ratio[k]
            table.add_row(state, label, _number(frequency, ".3f"), _number(damping, ".2f", 100))
        table.add_section()
    return table


def items_table(items: Sequence[dict[str, object]], columns: Sequence[str]) -> Table:
    """A plain table of named things."""
    table = Table()
    for column in columns:
        table.add_column(column.replace("_hz", "_Hz").replace("_", " "))
    for item in items:
        table.add_row(*(str(item.get(column, "")) for column in columns))
    return table


def _number(value: float | None, form: str, factor: float = 1.0) -> str:
    if value is None or value != value:
        return _NOTHING
    return format(factor * value, form)
