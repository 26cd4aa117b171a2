"""How noisy a spectrum is, three more ways than the local polynomial: local rational, quiet times, repeats."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from vgvt.reconcile.question.data import MeasuredChannel

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
_RATIONAL_HALF_WIDTH = 10
_REWEIGHTED, _OUTLYING = 6, 3.0
_SEGMENT_S = 1.0
# Median of a chi-squared variable of two degrees of freedom over its mean: what the median of a periodogram misses.
_MEDIAN_PER_MEAN = np.log(2.0)
_SMOOTHED_LINES = 10


def local_rational_noise(responses: ComplexArray, force: ComplexArray, lines: NDArray[np.intp]) -> tuple[Array, Array]:
    """Power (channels, lines), squared units of the spectra, of what noise adds to A - G F at each line; and the share
    of it, likewise, that is the force's noise, which all responses see at once.

    A local rational model with transient, orders 2, 2 and 2 (McKelvey and Guérin, Non-parametric frequency response
    estimation using a local rational model, IFAC Proceedings 45(16), 2012), does not take a sharp mode for noise as a
    polynomial does. What it leaves is noise times its denominator, which is therefore divided out. ``responses``
    (channels, K) and ``force`` (K,) are whole-record spectra; ValueError for fewer than 22 lines.
    """
    window, powers, basis = _local(force, lines)
    scale = _rms(force[window])
    free = 1 - (np.abs(basis) ** 2).sum(axis=2)
    share = 1 - 2 / (window.shape[1] - basis.shape[2])
    # A gap in the force holds no information on |G|; it must not stand for an infinite one.
    strength = np.maximum(np.abs(force[window]), 1e-3 * scale)
    noise, around = np.empty((2, responses.shape[0], lines.size))
    for c, response in enumerate(responses):
        left, denominator = _rational(response[window], powers, basis)
        weight = np.abs(denominator) ** 2 * free
        noise[c] = (np.abs(left) ** 2).sum(axis=1) / (weight.sum(axis=1) * share)
        around[c] = (weight * np.abs(response[window] / strength) ** 2).sum(axis=1) / weight.sum(axis=1)
    here = np.abs(responses[:, lines] / np.maximum(np.abs(force[lines]), 1e-3 * scale[:, 0])) ** 2
    own, of_force = _shares(noise, around)
    whole = own[:, None] + of_force * here
    return noise * whole / (own[:, None] + of_force * around), of_force * here / whole


def local_rational_rest(responses: ComplexArray, force: ComplexArray, lines: NDArray[np.intp]) -> ComplexArray:
    """What a local rational model leaves of responses (channels, K) at each line, (channels, lines): no linear answer.

    ``force`` (K,) is a whole-record spectrum as well; the model is that of :func:`local_rational_noise`.
    """
    window, powers, basis = _local(force, lines)
    own = (window == lines[:, None]).argmax(axis=1)
    rows = np.arange(lines.size)
    return np.array([_rational(r[window], powers, basis)[0][rows, own] for r in responses])


def _local(force: ComplexArray, lines: NDArray[np.intp]) -> tuple[NDArray[np.intp], Array, ComplexArray]:
    """Windows (L, W) of lines, powers (L, W, 3) of distances in them, and a basis (L, W, 6) of force and leakage."""
    n, last = _RATIONAL_HALF_WIDTH, force.size - 1
    if last < 2 * n + 1:
        raise ValueError(f"{force.size} lines cannot hold a window of {2 * n + 1}")
    window = np.clip(lines, 1 + n, last - n)[:, None] + np.arange(-n, n + 1)
    powers = ((window - lines[:, None]) / n)[:, :, None] ** np.arange(3)
    pushed = (force[window] / _rms(force[window]))[:, :, None] * powers
    basis, _ = np.linalg.qr(np.concatenate([pushed, powers.astype(complex)], axis=2))
    return window, powers, basis


def _rms(values: ComplexArray) -> Array:
    """Root mean square of each window (L, W), (L, 1); 1 where all is zero."""
    size = np.sqrt((np.abs(values) ** 2).mean(axis=1))[:, None]
    return np.asarray(np.where(size > 0, size, 1.0))


def _rational(data: ComplexArray, powers: Array, basis: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """What D A - B F - T leaves of windows of a response (L, W), and the denominator D there, 1 at the line."""
    level = _rms(data)
    both = np.concatenate([(data / level)[:, :, None], (data / level)[:, :, None] * powers[:, :, 1:]], axis=2)
    both = both - basis @ (basis.conj().transpose(0, 2, 1) @ both)
    own, triangle = np.linalg.qr(both[:, :, 1:])
    taken = own.conj().transpose(0, 2, 1) @ both[:, :, :1]
    left = (both[:, :, :1] - own @ taken)[:, :, 0]
    denominator = 1 - (powers[:, :, 1:] @ (np.linalg.pinv(triangle) @ taken))[:, :, 0]
    return left * level, denominator


def _shares(noise: Array, around: Array) -> tuple[Array, float]:
    """Each response's own noise power (C,) and that of the force, which all of them see times |G|² (C, L).

    By least squares on relative deviations; lines with three times what that expects, where something else adds
    to the noise, have no say.
    """
    from scipy.optimize import nnls

    count = noise.shape[0]
    unit = np.maximum(np.median(noise, axis=1), 1e-300)
    relative = noise / unit[:, None]
    scale = float(np.median(unit / np.median(around, axis=1)))
    shares, model = np.zeros(count + 1), np.ones_like(noise)
    for _ in range(_REWEIGHTED):
        columns = np.zeros((*noise.shape, count + 1))
        for c in range(count):
            columns[c, :, c] = 1 / model[c]
        columns[:, :, count] = around * scale / unit[:, None] / model
        keep = relative < _OUTLYING * model
        shares, _ = nnls(columns[keep], (relative / model)[keep])
        model = np.maximum(shares[:count, None] + shares[count] * around * scale / unit[:, None], 1e-3)
    # A response without noise of its own keeps a trace, or nothing would stand for it where it is still.
    return np.maximum(shares[:count], 1e-3) * unit, float(shares[count]) * scale


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
            # At the ends of the band there are fewer lines to take the mean of.
            inside = np.convolve(np.ones(lines.size), kernel, mode="same")
            out[members] = np.convolve(spread.sum(axis=0) / (len(members) - 1), kernel, mode="same") / inside
    size = np.array([np.abs(responses[i][lines] / forces[run_of[i]][lines]) ** 2 for _, i in rows])
    usual = np.nanmedian(out / size, axis=0)
    return np.where(np.isnan(out), usual * size, out)
