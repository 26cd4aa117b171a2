"""The sample rate that a time history states, in as few digits as its header leaves certain."""

from __future__ import annotations

from math import floor, isfinite, log10

from vgvt.data import InputError
from vgvt.files.describe.guesses import rate_in_few_digits_hz
from vgvt.files.uff.time_history import TimeHistory

_LAST_DIGIT = 1e-5  # of a number in the header, beside its first


def stated_rate_hz(history: TimeHistory) -> float:
    """Samples a second: 51200 where the increment is written as 1.95312E-05; InputError where none is stated."""
    if history.form.even:
        step = history.form.increment
        certain = _last_digit(step)
    else:
        time_s = history.abscissa_s()
        step = float(time_s[-1] - time_s[0]) / (time_s.size - 1) if time_s.size > 1 else 0.0
        certain = _last_digit(float(abs(time_s).max(initial=0))) / max(time_s.size - 1, 1)
    if not (step > 0 and isfinite(step)):
        raise InputError(
            history.where,
            f"states no sample rate: its abscissa has an increment of {step:g}",
            "export it with its time axis, or describe the file by hand: docs/how-to/describe-your-own-records.md",
        )
    return rate_in_few_digits_hz(step, certain)


def _last_digit(number: float) -> float:
    return _LAST_DIGIT * 10.0 ** floor(log10(number)) if 0 < number < float("inf") else 0.0
