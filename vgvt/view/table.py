"""Tables for the terminal: a scorecard, or the modes of a model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vgvt.data import ModalModel, ModeScore, ModeStatus, Scorecard
from vgvt.view.wording import claim_numbers, remark_in_words, score_numbers

if TYPE_CHECKING:
    from rich.text import Text

    from vgvt.view.fitted_table import FittedTable

_STYLES = {
    ModeStatus.FOUND: "green",
    ModeStatus.MISSED: "yellow",
    ModeStatus.FALSE: "magenta",
    ModeStatus.UNREACHED: "dim",
}
_SCORE_NUMBERS = ("true Hz", "claimed Hz", "±", "Δf %", "true ζ %", "claimed ζ %", "Δζ %", "MAC")
_CLAIM_NUMBERS = ("mode", "frequency Hz", "± Hz", "damping %", "± %")


def scorecard_table(card: Scorecard) -> FittedTable:
    """A rich renderable of a scorecard, one row a mode, counts in the caption; columns without content are left out.

    In a narrow terminal the true damping and the ± go first; names, status, MAC and Δf always stay.
    """
    from vgvt.view.fitted_table import FittedTable

    unreached = f", {len(card.unreached)} unreached" if card.unreached else ""
    return FittedTable(
        columns=(*_SCORE_NUMBERS, "status", "mode", "remark"),
        rows=tuple(_score_row(row) for row in (*card.modes, *card.unreached)),
        whole=frozenset((*_SCORE_NUMBERS, "status")),
        expendable=("true ζ %", "±", "claimed ζ %", "remark", "Δζ %"),
        right=frozenset(_SCORE_NUMBERS),
        title=f"{card.identifier} on {card.scenario}",
        caption=(
            f"{card.found} found, {card.missed} missed, {card.false} false{unreached}; "
            f"{card.band_hz[0]:g} to {card.band_hz[1]:g} Hz"
        ),
    )


def modal_table(model: ModalModel, title: str = "") -> FittedTable:
    """A rich renderable of the modes of a model; without modes, its caption says so and no table is drawn."""
    from vgvt.view.fitted_table import FittedTable

    return FittedTable(
        columns=(*_CLAIM_NUMBERS, "name", "remark"),
        rows=tuple(_claim_row(model, k) for k in range(len(model))),
        whole=frozenset(_CLAIM_NUMBERS),
        expendable=("± %", "± Hz", "remark"),
        right=frozenset(_CLAIM_NUMBERS),
        title=title or model.method,
        caption="" if len(model) else f"no modes: {model.outcome.value.replace('_', ' ')}",
    )


def _score_row(row: ModeScore) -> tuple[str | Text, ...]:
    from rich.text import Text

    status = Text(row.status.value, style=_STYLES[row.status])
    return (*score_numbers(row), status, row.label, remark_in_words(row.remark))


def _claim_row(model: ModalModel, k: int) -> tuple[str, ...]:
    name = model.labels[k] if model.labels else ""
    return (*claim_numbers(model, k), name, remark_in_words("; ".join(model.flags[k]) if model.flags else ""))
