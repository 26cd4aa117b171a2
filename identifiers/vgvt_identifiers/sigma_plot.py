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

from vgvt_identifiers.spectra import FEWEST_LINES, LOCAL_HALF_WIDTH, CampaignSpectra

_RAW_WIDTHS = (1, 3, 5, 9)
_LOCAL_WIDTHS = (9, 17, 33, 65, 129)
_LEVEL_UNCERTAINTY = 0.15
_CHI_SQUARE_30 = 0.1485  # 30th percentile of chi-square with one degree of freedom


@dataclass(frozen=True, slots=True)
class SigmaPeak:
    """A peak: the raw line where the sigma plot is largest, and how it was judged.

    ``significance`` is the rise of the smoothed power in standard deviations of
    errors that add or of errors that multiply, whichever are fewer,
    ``smoothing_lines`` the width at which the peak first passed, ``width_hz``
    its width at half prominence.
    """

    frequency_hz: float
    line: int
    prominence_db: float
    significance: float
    smoothing_lines: int
    width_hz: float


@dataclass(frozen=True, slots=True, eq=False)
class SigmaPlot:
    """Square of a sigma plot (K,) and its errors, which reach over ``correlated_lines``.

    For responses H + e with E|e|^2 = v: ``noise`` (K,) is sum v, ``noise_square``
    sum v^2, and ``cross`` 2 sum |H|^2 v; the power has the variance cross + noise_square.
    """

    power: NDArray[np.float64]
    noise: NDArray[np.float64]
    noise_square: NDArray[np.float64]
    cross: NDArray[np.float64]
    correlated_lines: int = 1

    @classmethod
    def of(
        cls,
        ratios: Sequence[NDArray[np.complex128]],
        variances: Sequence[NDArray[np.float64]],
        correlated_lines: int = 1,
    ) -> SigmaPlot:
        """From frequency responses (R, K) of every run and their variance E|e|^2 (R, K)."""
        squares = [np.abs(h) ** 2 for h in ratios]
        pairs = list(zip(squares, variances, strict=True))
        return cls(
            power=np.sum([p.sum(axis=0) for p in squares], axis=0),
            noise=np.sum([v.sum(axis=0) for v in variances], axis=0),
            noise_square=np.sum([(v**2).sum(axis=0) for v in variances], axis=0),
            cross=np.sum([(2 * np.maximum(p - v, 0) * v).sum(axis=0) for p, v in pairs], axis=0),
            correlated_lines=correlated_lines,
        )

    def smoothed(self, width: int) -> _Smoothed:
        """The plot and its errors averaged over ``width`` lines."""
        noise = _mean(self.noise, width)
        return _Smoothed(
            level=np.maximum(_mean(self.power - self.noise, width), 0),
            noise=noise,
            noise_square=_mean(self.noise_square, width),
            cross=_mean(self.cross, width),
            relative=_shared_scatter(_mean(self.power, width), width),
            independent=max(1.0, width / self.correlated_lines),
        )


@dataclass(frozen=True, slots=True, eq=False)
class _Smoothed:
    """A smoothed sigma plot: power above the noise (K,), its errors (K,), of which some lines are independent."""

    level: NDArray[np.float64]
    noise: NDArray[np.float64]
    noise_square: NDArray[np.float64]
    cross: NDArray[np.float64]
    relative: NDArray[np.float64]
    independent: float

    def judge(self, top: int, saddle: float) -> tuple[float, float]:
        """Rise of a top over its saddle as (natural logarithm, significance in standard deviations).

        Tested against the plot without the peak: errors that add are those of a
        response as large as the saddle.
        """
        level = max(float(self.level[top]), 1e-300)
        variance = (self.noise_square[top] + self.cross[top] * saddle / level) / self.independent
        spread = float(np.sqrt(variance + (_LEVEL_UNCERTAINTY * self.noise[top]) ** 2))
        rise = float(np.log(level / max(saddle, spread, 1e-300)))
        adding = (level - saddle) / max(spread, 1e-300)
        return rise, min(adding, rise / max(float(self.relative[top]), 1e-12))


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
    local = SigmaPlot.of([r.local for r in spectra.runs], [r.local_variance for r in spectra.runs], LOCAL_HALF_WIDTH)
    found: list[SigmaPeak] = []
    for plot, widths in ((raw, _RAW_WIDTHS), (local, _LOCAL_WIDTHS)):
        for width in (w for w in widths if w <= frequency.size // 4):
            extent = max(width, 2 * LOCAL_HALF_WIDTH + 1) if plot is local else width
            for peak in _peaks_at(frequency, raw.power, plot, width, prominence_db, false_alarm):
                if all(abs(peak.line - p.line) > (extent + p.smoothing_lines) / 2 + 1 for p in found):
                    found.append(peak)
    return tuple(sorted(found, key=lambda p: p.line))


def _shared_scatter(smoothed: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    """Standard deviation (K,) of the logarithm of a smoothed power, from how much values ``width`` lines apart differ.

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
    return np.asarray(np.sqrt(np.pad(relative, (reach // 2, reach - reach // 2), mode="edge")))


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

    smoothed = plot.smoothed(width)
    level = smoothed.level
    tops, facts = find_peaks(level, prominence=(None, None))
    if not tops.size:
        return []
    widths = peak_widths(level, tops, 0.5, (facts["prominences"], facts["left_bases"], facts["right_bases"]))[0]
    threshold = _threshold(false_alarm, level.size / width)
    step = float(frequency_hz[1] - frequency_hz[0])
    peaks = []
    for top, prominence, wide in zip(tops, facts["prominences"], widths, strict=True):
        rise, significance = smoothed.judge(int(top), float(level[top] - prominence))
        rise_db = 10 * rise / np.log(10)
        if rise_db < prominence_db or significance < threshold:
            continue
        low, high = max(0, top - width // 2), min(level.size, top + width // 2 + 1)
        line = low + int(np.argmax(raw_power[low:high]))
        peaks.append(SigmaPeak(float(frequency_hz[line]), line, rise_db, significance, width, float(wide) * step))
    return peaks
