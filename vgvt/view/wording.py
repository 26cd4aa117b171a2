"""Numbers and remarks as people read them, the same in the terminal and on the page."""

from __future__ import annotations

import re

import numpy as np

from vgvt.data import ModalModel, ModeScore

_UNITS = {"hz": "Hz", "db": "dB", "percent": "%", "s": "s", "n": "N", "kg": "kg"}
_FLAG = re.compile(r"[a-z][a-z0-9_]*(=\S+)?")


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


def remark_in_words(remark: str) -> str:
    """Machine flags like ``prominence_db=28.4; runs_disagree`` as words with units; other text stays."""
    return "; ".join(_flag_in_words(part) for part in remark.split("; "))


def _flag_in_words(flag: str) -> str:
    if not _FLAG.fullmatch(flag):
        return flag
    key, _, value = flag.partition("=")
    words = key.split("_")
    unit = _UNITS.get(words[-1], "") if value and len(words) > 1 else ""
    return " ".join(filter(None, (*(words[:-1] if unit else words), value, unit)))


def _percent(value: float | None, form: str) -> str:
    return number_text(None if value is None else 100 * value, form)
