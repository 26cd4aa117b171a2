"""Modes in numbers as people read them, the same at a prompt, in the terminal and on a page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from vgvt.data.shown import cut, in_columns

if TYPE_CHECKING:
    from vgvt.data.modal import ModalModel
    from vgvt.data.scorecard import ModeScore

CLAIM_NUMBERS = ("mode", "frequency Hz", "± Hz", "damping %", "± %")
"""What :func:`claim_numbers` gives."""
SCORE_NUMBERS = (
    "true Hz", "claimed Hz", "±", "Δf %", "true ζ %", "claimed ζ %", "Δζ %", "MAC", "as tested Hz", "as tested ζ %",
)  # fmt: skip
"""What :func:`score_numbers` gives."""
# Letters of a mode's name that a line has room for.
_NAME = 40


def number_text(value: float | None, form: str) -> str:
    """A number in a format; empty for none or one that is not finite, and zero without a sign."""
    if value is None or not np.isfinite(value):
        return ""
    text = form.format(value)
    return text.lstrip("+-") if not text.strip("+-0.") else text


def score_numbers(row: ModeScore) -> tuple[str, ...]:
    """True and claimed Hz, its ±, Δf %, true and claimed ζ %, Δζ %, MAC, then Hz and ζ % as tested, of a row."""
    return (
        number_text(row.true_hz, "{:.3f}"),
        number_text(row.claimed_hz, "{:.3f}"),
        number_text(row.claimed_std_hz, "{:#.2g}"),
        number_text(row.frequency_error_percent, "{:+.2f}"),
        _percent(row.true_damping_ratio, "{:.2f}"),
        _percent(row.claimed_damping_ratio, "{:.2f}"),
        number_text(row.damping_error_percent, "{:+.1f}"),
        number_text(row.mac, "{:.3f}"),
        number_text(row.as_tested_hz, "{:.3f}"),
        _percent(row.as_tested_damping_ratio, "{:.2f}"),
    )


def claim_numbers(model: ModalModel, k: int) -> tuple[str, ...]:
    """Number, frequency in Hz, its ±, damping in % and its ± of a claimed mode."""
    frequency_std, damping_std = model.natural_frequency_std_hz, model.damping_ratio_std
    return (
        str(k + 1),
        number_text(model.natural_frequency_hz[k], "{:.3f}"),
        number_text(None if frequency_std is None else frequency_std[k], "{:#.2g}"),
        _percent(model.damping_ratio[k], "{:.2f}"),
        _percent(None if damping_std is None else damping_std[k], "{:#.2g}"),
    )


def mode_table(model: ModalModel) -> str:
    """The first modes of a model, one a line, with the names that they have."""
    names = [cut(label, _NAME) for label in model.labels] or [""] * len(model)
    rows = [(*claim_numbers(model, k), name) for k, name in enumerate(names)]
    return in_columns((*CLAIM_NUMBERS, "name"), rows, words=("name",))


def score_table(rows: Sequence[ModeScore]) -> str:
    """The first rows of a scorecard, one a line, with what became of each mode and its name."""
    table = [(*score_numbers(row), row.status.value, cut(row.label, _NAME)) for row in rows]
    return in_columns((*SCORE_NUMBERS, "status", "name"), table, words=("status", "name"))


def _percent(value: float | None, form: str) -> str:
    return number_text(None if value is None else 100 * value, form)
