"""Peaks of the sigma plot that noise cannot explain.

A peak of a plot of 2000 noisy lines has to be judged twice: it must stand out
of its surroundings, and the scatter between neighbours must not be able to make
it. Both are judged at several widths of smoothing, so that a resonance a line
wide and one a hundred lines wide are found by the same rule: the raw ratio for
the narrow ones, the local polynomial estimate, which is free of leakage but
blurs what is narrower than its window, for the wide ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.spectra import FEWEST_LINES, CampaignSpectra

_RAW_WIDTHS = (1, 3, 5, 9)
_LOCAL_WIDTHS = (9, 17, 33, 65, 129)
_LOCAL_HALF_WIDTH = 6
_LEVEL_UNCERTAINTY = 0.15
_CHI_SQUARE_30 = 0.1485  # 30th percentile of chi-square with one degree of freedom


@dataclass(frozen=True, slots=True)
class SigmaPeak:
    """A peak: the raw line where the sigma plot is largest, and how it was judged.

    ``significance`` is the prominence of the smoothed power in its standard
    deviations, ``smoothing_lines`` the width at which the peak first passed,
    ``width_hz`` its width at half prominence.
    """

    frequency_hz: float
    line: int
    prominence_db: float
    significance: float
    smoothing_lines: int
    width_hz: float


@dataclass(frozen=True, slots=True, eq=False)
class SigmaPlot:
    """Square of a sigma plot, its noise floor and its variance, all (K,); errors reach over ``correlated_lines``."""

    power: NDArray[np.float64]
    noise: NDArray[np.float64]
    variance: NDArray[np.float64]
    correlated_lines: int = 1

    @classmethod
    def of(
        cls,
        ratios: Sequence[NDArray[np.complex128]],
        variances: Sequence[NDArray[np.float64]],
        correlated_lines: int = 1,
    ) -> SigmaPlot:
        """From frequency responses (R, K) of every run and their variance E|e|^2 (R, K)."""
        power = np.asarray(sum((np.abs(h) ** 2).sum(axis=0) for h in ratios))
        noise = np.asarray(sum(v.sum(axis=0) for v in variances))
        # |H + e|^2 has the variance 2 |H|^2 v + v^2 for a circular error of variance v.
        signal = (np.maximum(np.abs(h) ** 2 - v, 0) for h, v in zip(ratios, variances, strict=True))
        variance = np.asarray(sum((2 * s * v + v**2).sum(axis=0) for s, v in zip(signal, variances, strict=True)))
        return cls(power, noise, variance, correlated_lines)

    def smoothed(self, width: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Noise-free power (K,) averaged over ``width`` lines, and its standard deviation (K,)."""
        independent = max(1.0, width / self.correlated_lines)
        level = np.maximum(_mean(self.power - self.noise, width), 0)
        doubt = _LEVEL_UNCERTAINTY * _mean(self.noise, width)
        spread = np.sqrt(_mean(self.variance, width) / independent + doubt**2)
        return level, np.maximum(spread, _shared_scatter(_mean(self.power, width), width))


def sigma_peaks(
    spectra: CampaignSpectra, prominence_db: float = 1.0, false_alarm: float = 0.01
) -> tuple[SigmaPeak, ...]:
    """Peaks of the sigma plot of a campaign, in order of frequency.

    ``false_alarm`` bounds the chance that noise alone makes one peak somewhere
    in the plot. Too few lines to tell noise from signal (``FEWEST_LINES``) give no peaks.
    """
    frequency = spectra.frequency_hz
    if frequency.size < FEWEST_LINES:
        return ()
    raw = SigmaPlot.of([r.accelerance for r in spectra.runs], [r.variance for r in spectra.runs])
    found: list[SigmaPeak] = []
    for plot, widths in ((raw, _RAW_WIDTHS), (_local_plot(spectra), _LOCAL_WIDTHS)):
        for width in (w for w in widths if w <= frequency.size // 4):
            extent = max(width, 2 * _LOCAL_HALF_WIDTH + 1) if plot.correlated_lines > 1 else width
            for peak in _peaks_at(frequency, raw.power, plot, width, prominence_db, false_alarm):
                if all(abs(peak.line - p.line) > (extent + p.smoothing_lines) / 2 + 1 for p in found):
                    found.append(peak)
    return tuple(sorted(found, key=lambda p: p.line))


def _local_plot(spectra: CampaignSpectra) -> SigmaPlot:
    """The sigma plot of the local polynomial estimate, without leakage."""
    from vgvt.signals.local_polynomial import local_polynomial_fit

    lines = np.arange(1, spectra.frequency_hz.size + 1)
    values, variances = [], []
    for run in spectra.runs:
        # The estimator wants the 0 Hz line in front, which it never uses.
        response = np.pad(run.accelerance * run.force, ((0, 0), (1, 0)))
        fit = local_polynomial_fit(response, np.pad(run.force, (1, 0))[None], lines, half_width=_LOCAL_HALF_WIDTH)
        values.append(fit.values[:, 0])
        variances.append(fit.variance[:, 0])
    return SigmaPlot.of(values, variances, correlated_lines=_LOCAL_HALF_WIDTH)


def _shared_scatter(smoothed: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    """Standard deviation (K,) of a smoothed power, from how much values ``width`` lines apart differ.

    Sees what a sum over independent responses cannot: errors that all responses
    share, such as leakage, which divides every response by the same force. The
    third difference of the logarithm removes what is smooth, a low percentile
    over a neighbourhood ignores the peaks themselves.
    """
    from scipy.ndimage import percentile_filter

    taps = np.array([1.0, -3.0, 3.0, -1.0])
    reach = 3 * width
    if smoothed.size < 4 * reach:
        return np.zeros_like(smoothed)
    logarithm = np.log(np.maximum(smoothed, 1e-300))
    difference = sum(t * logarithm[i * width : smoothed.size - reach + i * width] for i, t in enumerate(taps))
    square = np.asarray(difference) ** 2 / (taps @ taps)
    relative = percentile_filter(square, 30, size=max(51, 12 * width), mode="nearest") / _CHI_SQUARE_30
    padded = np.pad(relative, (reach // 2, reach - reach // 2), mode="edge")
    return np.asarray(smoothed * np.sqrt(padded))


def _threshold(false_alarm: float, independent_lines: float) -> float:
    """Standard deviations that a rise must have: twice the Gaussian bound, as both top and saddle are extremes."""
    from scipy.stats import norm

    return 2 * float(norm.isf(false_alarm / (2 * max(independent_lines, 1.0))))


def _mean(values: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    """Moving average, ends held; summed afresh for every line, as running sums leak large values into small ones."""
    from scipy.ndimage import correlate1d

    return np.asarray(correlate1d(values, np.full(width, 1 / width), mode="nearest")) if width > 1 else values


def _peaks_at(
    frequency_hz: NDArray[np.float64],
    raw_power: NDArray[np.float64],
    plot: SigmaPlot,
    width: int,
    prominence_db: float,
    false_alarm: float,
) -> list[SigmaPeak]:
    from scipy.signal import find_peaks, peak_widths

    level, spread = plot.smoothed(width)
    tops, facts = find_peaks(level, prominence=(None, None))
    if not tops.size:
        return []
    widths = peak_widths(level, tops, 0.5, (facts["prominences"], facts["left_bases"], facts["right_bases"]))[0]
    threshold = _threshold(false_alarm, level.size / width)
    step = float(frequency_hz[1] - frequency_hz[0])
    peaks = []
    for top, prominence, wide in zip(tops, facts["prominences"], widths, strict=True):
        floor = max(float(level[top] - prominence), float(spread[top]))
        rise_db = float(10 * np.log10(max(level[top], 1e-300) / max(floor, 1e-300)))
        significance = float(prominence / max(spread[top], 1e-300))
        if rise_db < prominence_db or significance < threshold:
            continue
        low, high = max(0, top - width // 2), min(level.size, top + width // 2 + 1)
        line = low + int(np.argmax(raw_power[low:high]))
        peaks.append(SigmaPeak(float(frequency_hz[line]), line, rise_db, significance, width, float(wide) * step))
    return peaks
