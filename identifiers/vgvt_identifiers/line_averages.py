"""Spectral density matrices averaged over neighbouring lines, where noise hides the shape that single lines have.

Two lines of one mode, each with a part n of its power made of noise, have a MAC of (1 - n)^2 at best. The
mean of m neighbours keeps the mode in one singular vector and spreads the noise over all of them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.output_spectra import Decomposition

_SPARE = 4.0


def lines_to_average(found: Decomposition, line: int, order: int, least_mac: float) -> int:
    """How many lines must be averaged before noise leaves a MAC of ``least_mac``; 1 where one line does."""
    noise = float(found.noise[order, line] / found.values[order, line])
    allowed = 1 - np.sqrt(least_mac)
    if found.window is not None or not allowed < noise < 1:
        return 1
    return int(np.ceil(_SPARE * noise / allowed))


def averaged(found: Decomposition, lines: int) -> Decomposition:
    """Singular values of the mean of every ``lines`` neighbouring matrices, noise and scatter carried over.

    Lines at the end that do not fill a mean are left out. ValueError for what is averaged already.
    """
    if found.window is not None:
        raise ValueError("lines that are averages already share their errors: they cannot be averaged once more")
    means = found.frequency_hz.size // lines
    used = slice(0, means * lines)

    def grouped(values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of every mean the quantities (P, K) of its columns, (means, lines * P)."""
        return values[:, used].T.reshape(means, -1)

    # G = sum v s^2 v' over the vectors of all its lines: their roots side by side have the same singular vectors.
    roots = (found.vectors * np.sqrt(found.values.T)[:, None, :])[used] / np.sqrt(lines)
    sensors = roots.shape[1]
    stacked = roots.reshape(means, lines, sensors, -1).transpose(0, 2, 1, 3).reshape(means, sensors, -1)
    left, singular, right = np.linalg.svd(stacked, full_matrices=False)
    keep = found.values.shape[0]
    share = np.abs(right[:, :keep]) ** 2
    values = np.maximum(singular[:, :keep].T ** 2, 1e-300)
    own = np.einsum("kpc,kc->pk", share, grouped(found.relative_std**2 * found.values / 2)) / lines
    # A vector that the data choose follows the noise of all columns, not of its own alone.
    noise = np.einsum("kpc,kc->pk", share, grouped(found.noise)) / lines + (lines - 1) * own
    step = float(found.frequency_hz[1] - found.frequency_hz[0])
    offsets = np.asarray((np.arange(lines) - (lines - 1) / 2) * step, np.float64)
    return replace(
        found,
        frequency_hz=found.frequency_hz[used].reshape(means, lines).mean(axis=1),
        values=values,
        vectors=left[:, :, :keep],
        relative_std=np.sqrt(2 * own / values),
        noise=noise,
        window=(offsets, np.full(lines, 1 / lines)),
    )
