"""What nobody said of a campaign: the axes of its places as they were given, and a band from its records' length."""

from __future__ import annotations

from collections.abc import Sequence

from vgvt.data import InputError
from vgvt.files.axes import Axes
from vgvt.files.describe.draft import DescribedRun

_USUAL_SHARE = 2.56
"""Sample rate over bandwidth of most analysers."""
_PERIODS = 10
_MOST_DECIMALS = 6


def checked_axes(unit: str, axes: tuple[str, str, str] | None) -> Axes:
    """The axes that point aft, right and up, x, y and z where nobody says; InputError where they are none."""
    aft, right, up = axes or ("x", "y", "z")
    try:
        return Axes.model_validate({"unit": unit, "aft": aft, "right": right, "up": up})
    except ValueError as error:
        raise InputError(
            "--axes",
            f"{aft} {right} {up} are not the axes that point aft, right and up",
            "write each of x, y and z once, with a minus sign where it points the other way: like --axes y -x z",
        ) from error


def guessed_band_hz(runs: Sequence[DescribedRun]) -> tuple[float, float] | None:
    """From ten periods in the shortest run to the sample rate over 2.56; None where no run states its rate."""
    known = [(run.samples, run.sample_rate_hz) for run in runs if run.sample_rate_hz is not None]
    if not known:
        return None
    shortest_s = min(samples / rate for samples, rate in known)
    high = min(rate for _, rate in known) / _USUAL_SHARE
    low = _PERIODS / shortest_s if shortest_s > 0 else high
    return float(f"{min(low, high / 10):.3g}"), float(f"{high:.3g}")


def rate_in_few_digits_hz(step_s: float, certain_s: float) -> float:
    """Samples a second: of the rates whose step (s) is this one within what is certain of it, the plainest."""
    rates = (round(1 / step_s, decimals) for decimals in range(_MOST_DECIMALS + 1))
    return next((rate for rate in rates if rate > 0 and abs(1 / rate - step_s) <= certain_s), 1 / step_s)
