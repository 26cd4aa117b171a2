"""Segments, windows and spectral densities."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray


class Cut(Protocol):
    """How a record is cut into averages, and what each is worth."""

    def frequency_hz(self, sample_rate_hz: float) -> NDArray[np.float64]:
        """Frequency of every line, rising, (lines,)."""

    def effective_averages(self) -> float | NDArray[np.float64]:
        """Independent averages that the segments are worth, of all lines or of each, (lines,)."""

    def spectra(self, samples: NDArray[np.floating], *, force: bool = False) -> NDArray[np.complex128]:
        """Spectra (segments, lines) of one channel (N,), a force or a response."""


@dataclass(frozen=True, slots=True, eq=False)
class Segmentation:
    """How a record is cut for averaging: windows of equal length, ``hop`` samples apart from sample ``first`` on."""

    window: NDArray[np.float64]
    hop: int
    segments: int
    first: int = 0

    @property
    def length(self) -> int:
        """Samples in a segment."""
        return int(self.window.size)

    def frequency_hz(self, sample_rate_hz: float) -> NDArray[np.float64]:
        """Frequency of every line, 0 to Nyquist."""
        return np.asarray(np.arange(self.length // 2 + 1) * (sample_rate_hz / self.length), dtype=np.float64)

    def spectra(self, samples: NDArray[np.floating], *, force: bool = False) -> NDArray[np.complex128]:
        """Spectra (segments, lines) of one channel (N,); force and response have the same window."""
        return segment_spectra(samples, self)

    def effective_averages(self) -> float:
        """Independent averages that the overlapping segments are worth.

        Welch, The use of fast Fourier transform for the estimation of power
        spectra, IEEE Trans. Audio Electroacoust. 15(2), 1967, for white noise.
        """
        lags = np.arange(1, min(self.segments, -(-self.length // self.hop)))
        power = float(self.window @ self.window)
        overlap = np.array([self.window[k * self.hop :] @ self.window[: -k * self.hop] for k in lags])
        shared = float(((1 - lags / self.segments) * (overlap / power) ** 2).sum())
        return self.segments / (1 + 2 * shared)


def whole_record(samples: int) -> Segmentation:
    """One segment without a window: the whole record, as it is."""
    return Segmentation(np.ones(samples), hop=samples, segments=1)


def welch_segments(
    samples: int, segment: int, window: str = "hann", overlap: float = 0.5, first: int = 0
) -> Segmentation:
    """Windowed segments of ``segment`` samples with a fractional ``overlap`` over a record of ``samples``.

    The first begins at sample ``first``. ValueError when a segment is longer than what the record has from there
    on or the overlap is not in 0..1.
    """
    from scipy.signal import get_window

    if first < 0 or not 2 <= segment <= samples - first:
        raise ValueError(f"a segment must have 2 to {samples - first} samples, got {segment}")
    if not 0 <= overlap < 1:
        raise ValueError(f"overlap must be at least 0 and less than 1, got {overlap}")
    hop = max(1, round(segment * (1 - overlap)))
    segments = 1 + (samples - first - segment) // hop
    return Segmentation(np.asarray(get_window(window, segment), float), hop, segments, first)


def segment_spectra(samples: NDArray[np.floating], cut: Segmentation) -> NDArray[np.complex128]:
    """Spectra (segments, lines) of one channel (N,), mean of the record removed.

    Plain sums of the windowed samples: no scaling, as ratios need none.
    """
    signal = np.asarray(samples, dtype=np.float64)
    signal = signal - signal.mean()
    starts = cut.first + np.arange(cut.segments) * cut.hop
    pieces = np.lib.stride_tricks.sliding_window_view(signal, cut.length)[starts]
    return np.asarray(np.fft.rfft(pieces * cut.window, axis=1))


def power_spectral_density(
    samples: NDArray[np.floating],
    sample_rate_hz: float,
    segment_s: float,
    window: str = "hann",
    overlap: float = 0.5,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """One-sided power spectral density of one channel (N,) by Welch's method: frequency_hz and density, (lines,).

    In units squared per hertz. Bendat and Piersol, Random Data, 4th ed., section 11.5.
    """
    cut = welch_segments(len(samples), round(segment_s * sample_rate_hz), window, overlap)
    power = (np.abs(segment_spectra(samples, cut)) ** 2).mean(axis=0)
    density = power * 2 / (sample_rate_hz * float(cut.window @ cut.window))
    density[0] /= 2
    if cut.length % 2 == 0:
        density[-1] /= 2
    return cut.frequency_hz(sample_rate_hz), density
