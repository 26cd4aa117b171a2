"""Tables for the terminal: a scorecard, or the modes of a model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vgvt.data import CandidateGroup, ModalModel, ModeScore, ModeStatus, Scorecard, TrueModes, grouped_candidates
from vgvt.data.mode_numbers import CLAIM_NUMBERS, SCORE_NUMBERS, claim_numbers, score_numbers
from vgvt.view.true_modes import TRUTH_IN_WORDS
from vgvt.view.wording import remark_in_words

if TYPE_CHECKING:
    from rich.text import Text

    from vgvt.view.fitted_table import FittedTable

_STYLES = {
    ModeStatus.FOUND: "green",
    ModeStatus.MISSED: "yellow",
    ModeStatus.FALSE: "magenta",
    ModeStatus.UNREACHED: "dim",
}
_CANDIDATE_NUMBERS = ("poles", "frequency Hz", "damping %", "orders")


def scorecard_table(card: Scorecard) -> FittedTable:
    """A rich renderable of a scorecard, one row a mode, counts in the caption; columns without content are left out.

    Of a claim without the force the true modes are those with the shaker, and the last numbers those as tested.
    In a narrow terminal the true damping and the ± go first; names, status, MAC and Δf always stay.
    """
    from vgvt.view.fitted_table import FittedTable

    against = "" if card.true_modes is TrueModes.AS_TESTED else f", the truth {TRUTH_IN_WORDS[card.true_modes]}"
    unreached = f", {len(card.unreached)} unreached" if card.unreached else ""
    return FittedTable(
        columns=(*SCORE_NUMBERS, "status", "mode", "remark"),
        rows=tuple(_score_row(row) for row in (*card.modes, *card.unreached)),
        whole=frozenset((*SCORE_NUMBERS, "status")),
        expendable=("as tested ζ %", "true ζ %", "±", "claimed ζ %", "remark", "Δζ %", "as tested Hz"),
        right=frozenset(SCORE_NUMBERS),
        title=f"{card.identifier} on {card.scenario}",
        caption=(
            f"{card.found} found, {card.missed} missed, {card.false} false{unreached}; "
            f"{card.band_hz[0]:g} to {card.band_hz[1]:g} Hz{against}"
        ),
    )


def modal_table(model: ModalModel, title: str = "") -> FittedTable:
    """A rich renderable of the modes of a model; without modes, its caption says so and no table is drawn."""
    from vgvt.view.fitted_table import FittedTable

    return FittedTable(
        columns=(*CLAIM_NUMBERS, "name", "remark"),
        rows=tuple(_claim_row(model, k) for k in range(len(model))),
        whole=frozenset(CLAIM_NUMBERS),
        expendable=("± %", "± Hz", "remark"),
        right=frozenset(CLAIM_NUMBERS),
        title=title or model.method,
        caption="" if len(model) else f"no modes: {model.outcome.value.replace('_', ' ')}",
    )


def candidates_table(model: ModalModel, title: str = "") -> FittedTable:
    """A rich renderable of the poles that a method considered, one row for those that share their fate and reason."""
    from vgvt.view.fitted_table import FittedTable

    kept = sum(c.kept for c in model.candidates)
    return FittedTable(
        columns=(*_CANDIDATE_NUMBERS, "fate", "why"),
        rows=tuple(_candidate_row(group) for group in grouped_candidates(model.candidates)),
        whole=frozenset((*_CANDIDATE_NUMBERS, "fate")),
        expendable=("damping %", "orders"),
        right=frozenset(_CANDIDATE_NUMBERS),
        title=title or model.method,
        caption=f"{kept} of {len(model.candidates)} poles stand behind the modes",
    )


def _candidate_row(group: CandidateGroup) -> tuple[str | Text, ...]:
    from rich.text import Text

    fate = Text("kept", style="green") if group.kept else Text("dropped", style="dim")
    low, high = group.damping_ratio
    numbers = (
        str(group.poles),
        _range(*group.frequency_hz, ".2f"),
        _range(100 * low, 100 * high, ".2f"),
        _range(*group.order, "d"),
    )
    return (*numbers, fate, group.reason)


def _range(low: float, high: float, form: str) -> str:
    """One number, or two with "to" between them where they differ in print."""
    first, last = f"{low:{form}}", f"{high:{form}}"
    return first if first == last else f"{first} to {last}"


def _score_row(row: ModeScore) -> tuple[str | Text, ...]:
    from rich.text import Text

    status = Text(row.status.value, style=_STYLES[row.status])
    return (*score_numbers(row), status, row.label, remark_in_words(row.remark))


def _claim_row(model: ModalModel, k: int) -> tuple[str, ...]:
    name = model.labels[k] if model.labels else ""
    return (*claim_numbers(model, k), name, remark_in_words("; ".join(model.flags[k]) if model.flags else ""))
