"""How noisy a spectrum is, three more ways than the local polynomial: local rational, quiet times, repeats."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from vgvt.reconcile.data import MeasuredChannel

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
_RATIONAL_HALF_WIDTH = 10
_SEGMENT_S = 1.0
# Median of a chi-squared variable of two degrees of freedom over its mean: what the median of a periodogram misses.
_MEDIAN_PER_MEAN = np.log(2.0)
_SMOOTHED_LINES = 10


def local_rational_noise(responses: ComplexArray, force: ComplexArray, lines: NDArray[np.intp]) -> Array:
    """Noise power (channels, lines) left by a local rational model with transient, orders 2, 2 and 2.

    McKelvey and Guérin, Non-parametric frequency response estimation using a local rational model, IFAC
    Proceedings 45(16), 2012. Unlike a polynomial it does not take a sharp mode for noise. ``responses``
    (channels, K) and ``force`` (K,) are whole-record spectra.
    """
    n, last = _RATIONAL_HALF_WIDTH, force.size - 1
    centre = np.clip(lines, 1 + n, last - n)
    window = centre[:, None] + np.arange(-n, n + 1)
    r = ((window - lines[:, None]) / n)[:, :, None]
    powers = r ** np.arange(3)
    scale = np.sqrt((np.abs(force[window]) ** 2).mean(axis=1))[:, None]
    pushed = (force[window] / scale)[:, :, None] * powers
    noise = np.empty((responses.shape[0], lines.size))
    for c, response in enumerate(responses):
        data = response[window]
        level = np.sqrt((np.abs(data) ** 2).mean(axis=1))[:, None]
        own = (data / level)[:, :, None] * powers[:, :, 1:]
        basis, _ = np.linalg.qr(np.concatenate([pushed, powers.astype(complex), own], axis=2))
        y = data[:, :, None]
        left = y - basis @ (basis.conj().transpose(0, 2, 1) @ y)
        noise[c] = (np.abs(left[:, :, 0]) ** 2).sum(axis=1) / (2 * n + 1 - basis.shape[2])
    return noise


def quiet_noise(samples: NDArray[np.floating], rate_hz: float, frequency_hz: Array) -> Array:
    """One-sided density (lines,), units² per hertz, of a channel (N,) at times when a frequency is not excited.

    The median over time of short periodograms: a sweep is at each frequency for a small part of the record only.
    """
    length = max(16, round(_SEGMENT_S * rate_hz))
    signal = np.asarray(samples, dtype=float)
    count = max(1, signal.size // length)
    pieces = signal[: count * length].reshape(count, -1) if signal.size >= length else signal[None]
    pieces = pieces - pieces.mean(axis=1, keepdims=True)
    # A Blackman window: a sweep's side lobes must not fill the quiet.
    window = np.blackman(pieces.shape[1])
    power = np.abs(np.fft.rfft(pieces * window, axis=1)) ** 2 * 2 / (rate_hz * float(window @ window))
    density = np.median(power, axis=0) / _MEDIAN_PER_MEAN
    known = np.fft.rfftfreq(pieces.shape[1], 1 / rate_hz)
    return np.asarray(np.interp(frequency_hz, known, density))


def repeat_noise(
    responses: ComplexArray,
    forces: ComplexArray,
    rows: list[tuple[MeasuredChannel, int]],
    lines: NDArray[np.intp],
) -> Array | None:
    """Variance (channels, lines) of each channel's A/F over runs that repeat all its DOFs; None without repeats.

    A channel without a repeat gets the median of those that have one, relative to |A/F|².
    """
    groups: dict[tuple[object, ...], list[int]] = {}
    sets = {channel.run: tuple(c.dof for c, _ in rows if c.run == channel.run) for channel, _ in rows}
    for channel, i in rows:
        groups.setdefault((channel.dof, sets[channel.run]), []).append(i)
    if all(len(members) < 2 for members in groups.values()):
        return None
    run_of = {i: channel.run for channel, i in rows}
    out = np.full((len(rows), lines.size), np.nan)
    kernel = np.ones(2 * _SMOOTHED_LINES + 1) / (2 * _SMOOTHED_LINES + 1)
    for members in groups.values():
        if len(members) > 1:
            ratio = np.array([responses[i][lines] / forces[run_of[i]][lines] for i in members])
            spread = np.abs(ratio - ratio.mean(axis=0)) ** 2
            variance = np.convolve(spread.sum(axis=0) / (len(members) - 1), kernel, mode="same")
            out[members] = variance
    size = np.array([np.abs(responses[i][lines] / forces[run_of[i]][lines]) ** 2 for _, i in rows])
    usual = np.nanmedian(out / size, axis=0)
    return np.where(np.isnan(out), usual * size, out)
