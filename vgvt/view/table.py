"""Tables for the terminal: a scorecard, or the modes of a model."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vgvt.data import ModalModel, ModeScore, ModeStatus, Scorecard

if TYPE_CHECKING:
    from rich.table import Table

_LOOK = {
    ModeStatus.FOUND: "[green]found[/green]",
    ModeStatus.MISSED: "[yellow]missed[/yellow]",
    ModeStatus.FALSE: "[magenta]false[/magenta]",
    ModeStatus.UNREACHED: "[dim]unreached[/dim]",
}


def scorecard_table(card: Scorecard) -> Table:
    """A rich table of a scorecard, one row a mode, counts in the caption; columns without content are left out."""
    names = ("true Hz", "claimed Hz", "±", "Δf %", "true ζ %", "claimed ζ %", "Δζ %", "MAC", "status", "mode", "remark")
    table = _filled(
        f"{card.identifier} on {card.scenario}", names, [_score_cells(row) for row in (*card.modes, *card.unreached)]
    )
    unreached = f", {len(card.unreached)} unreached" if card.unreached else ""
    table.caption = (
        f"{card.found} found, {card.missed} missed, {card.false} false{unreached}; "
        f"{card.band_hz[0]:g} to {card.band_hz[1]:g} Hz"
    )
    return table


def modal_table(model: ModalModel, title: str = "") -> Table:
    """A rich table of the modes of a model; without modes, its caption says why."""
    names = ("mode", "frequency Hz", "±", "damping %", "±", "name", "remark")
    table = _filled(title or model.method, names, [_modal_cells(model, k) for k in range(len(model))])
    if not len(model):
        table.caption = _plain("; ".join((model.outcome.value.replace("_", " "), *model.advice)))
    return table


def _filled(title: str, names: tuple[str, ...], rows: list[tuple[str, ...]]) -> Table:
    """A table with the columns that say something (all of them when there is no row)."""
    table = _new_table(title)
    shown = [k for k in range(len(names)) if not rows or any(row[k] for row in rows)]
    for k in shown:
        if names[k] in ("status", "mode", "name", "remark"):
            table.add_column(names[k], overflow="fold")
        else:
            table.add_column(names[k], justify="right", no_wrap=True)
    for row in rows:
        table.add_row(*(row[k] for k in shown))
    return table


def _modal_cells(model: ModalModel, k: int) -> tuple[str, ...]:
    frequency_std, damping_std = model.natural_frequency_std_hz, model.damping_ratio_std
    return (
        str(k + 1),
        _number(model.natural_frequency_hz[k], "{:.3f}"),
        _number(None if frequency_std is None else frequency_std[k], "{:#.2g}"),
        _number(100 * model.damping_ratio[k], "{:.2f}"),
        _number(None if damping_std is None else 100 * damping_std[k], "{:#.2g}"),
        _plain(model.labels[k] if model.labels else ""),
        _plain("; ".join(model.flags[k]) if model.flags else ""),
    )


def _new_table(title: str) -> Table:
    from rich import box
    from rich.table import Table

    return Table(title=_plain(title) or None, box=box.SIMPLE_HEAD, title_justify="left", caption_justify="left")


def _score_cells(row: ModeScore) -> tuple[str, ...]:
    return (
        _number(row.true_hz, "{:.3f}"),
        _number(row.claimed_hz, "{:.3f}"),
        _number(row.claimed_std_hz, "{:#.2g}"),
        _number(row.frequency_error_percent, "{:+.2f}"),
        _number(None if row.true_damping_ratio is None else 100 * row.true_damping_ratio, "{:.2f}"),
        _number(None if row.claimed_damping_ratio is None else 100 * row.claimed_damping_ratio, "{:.2f}"),
        _number(row.damping_error_percent, "{:+.1f}"),
        _number(row.mac, "{:.3f}"),
        _LOOK[row.status],
        _plain(row.label),
        _plain(row.remark),
    )


def _number(value: float | None, form: str) -> str:
    return form.format(value) if value is not None and np.isfinite(value) else ""


def _plain(text: str) -> str:
    """Text without rich markup of its own."""
    from rich.markup import escape

    return escape(text)
