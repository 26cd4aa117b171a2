"""Coloured Gaussian noise with a prescribed spectrum."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def interpolated_density(frequency_hz: ArrayLike, known_hz: ArrayLike, density: ArrayLike) -> NDArray[np.float64]:
    """A spectral density at other frequencies: log-log between the known points, flat outside them.

    ``known_hz`` (K,) increases and is positive, ``density`` (K,) is positive; ValueError otherwise.
    """
    known, values = np.atleast_1d(np.asarray(known_hz, float)), np.atleast_1d(np.asarray(density, float))
    if known.shape != values.shape or known.ndim != 1:
        raise ValueError(f"frequencies and densities must pair up: {known.shape} against {values.shape}")
    if np.any(known <= 0) or np.any(np.diff(known) <= 0) or np.any(values <= 0):
        raise ValueError("frequencies must be positive and increase, densities must be positive")
    wanted = np.clip(np.asarray(frequency_hz, dtype=float), known[0], known[-1])
    return np.asarray(np.exp(np.interp(np.log(wanted), np.log(known), np.log(values))))


def coloured_noise(
    generator: np.random.Generator,
    samples: int,
    sample_rate_hz: float,
    frequency_hz: ArrayLike,
    density: ArrayLike,
) -> NDArray[np.float64]:
    """Gaussian noise, shape (samples,), with a one-sided amplitude spectral density.

    ``density`` (K,) is in signal units per root hertz at ``frequency_hz`` (K,),
    log-log in between and flat outside, down to 0 Hz and up to the Nyquist
    frequency. Made by random phases and amplitudes in the frequency domain over
    at least twice the length, so that the end of the record does not know its start;
    features of the density narrower than half a line of the record are not resolved.
    """
    from scipy.fft import irfft, next_fast_len

    length = next_fast_len(2 * samples, real=True)
    lines_hz = np.arange(length // 2 + 1) * (sample_rate_hz / length)
    # The one-sided power of a line is density^2 * df; irfft divides by the length.
    amplitude = interpolated_density(lines_hz, frequency_hz, density) * np.sqrt(sample_rate_hz * length) / 2
    parts = generator.standard_normal((2, lines_hz.size))
    spectrum = amplitude * (parts[0] + 1j * parts[1])
    # Lines 0 and Nyquist stand alone (no conjugate partner) and are real.
    alone = [0, -1] if length % 2 == 0 else [0]
    spectrum[alone] = np.sqrt(2) * spectrum[alone].real
    noise: NDArray[np.float64] = irfft(spectrum, n=length)[:samples]
    return noise.copy()
