"""Parts of the band in which the responses do not follow the force: less of them is answer than noise."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, ChannelRole
from vgvt.signals.usable import fault_of

_WIDTH = 25
_TAPS = np.array([1.0, -4.0, 6.0, -4.0, 1.0])


def deaf_bands(
    frequency_hz: NDArray[np.float64], power: NDArray[np.float64], noise: NDArray[np.float64]
) -> tuple[tuple[float, float], ...]:
    """Parts (low, high) in Hz in which the power (K,) of responses over the force is less than twice its noise (K,).

    There the coherence is under a half. Parts narrower than 25 lines, the width of the median, are passed over.
    """
    from scipy.ndimage import median_filter

    if frequency_hz.size < 2 * _WIDTH:
        return ()
    deaf = median_filter(power - 2 * noise, size=_WIDTH, mode="nearest") < 0
    edges = np.flatnonzero(np.diff(np.concatenate([[False], deaf, [False]]).astype(int)))
    pairs = zip(edges[::2], edges[1::2], strict=True)
    return tuple((float(frequency_hz[a]), float(frequency_hz[b - 1])) for a, b in pairs if b - a > _WIDTH)


def deaf_bands_of(campaign: Campaign, band_hz: tuple[float, float]) -> tuple[tuple[float, float], ...]:
    """The same from whole-record ratios of a campaign; none where a run has no single force, or runs differ in length.

    Noise is what the fourth difference over lines leaves, as a structure's answer is smooth and noise is not.
    """
    shapes = {(r.samples.shape[1], r.sample_rate_hz) for r in campaign.runs}
    if len(shapes) > 1:
        return ()
    (count, rate_hz) = shapes.pop()
    frequency = np.fft.rfftfreq(count, 1 / rate_hz).astype(np.float64)
    inside = (frequency > 0) & (frequency >= band_hz[0]) & (frequency <= band_hz[1])
    power, noise = np.zeros(int(inside.sum())), np.zeros(int(inside.sum()))
    for record in campaign.runs:
        _, forces = record.select(ChannelRole.REFERENCE)
        if len(forces) != 1 or fault_of(forces[0], rate_hz) is not None or inside.sum() < 2 * _WIDTH:
            return ()
        force = _transform(forces[0])[inside]
        size = np.maximum(np.abs(force), 1e-12 * np.abs(force).max(initial=1e-300))
        for samples in record.select(ChannelRole.RESPONSE)[1]:
            if fault_of(samples, rate_hz) is None:
                ratio = _transform(samples)[inside] / np.where(force == 0, np.inf, force)
                power += np.abs(ratio) ** 2
                noise += rough_noise(ratio[None], size)[0] / size**2
    return deaf_bands(frequency[inside], power, noise)


def rough_noise(ratio: NDArray[np.complex128], size: NDArray[np.float64]) -> NDArray[np.float64]:
    """Noise power (R, K) of responses whose ratios (R, K) to a force of ``size`` (K,) ought to be smooth over lines."""
    from scipy.ndimage import median_filter

    lines = size.size
    difference = sum(t * ratio[:, i : lines - 4 + i] for i, t in enumerate(_TAPS))
    spread = sum(t**2 / size[i : lines - 4 + i] ** 2 for i, t in enumerate(_TAPS))
    rough = np.pad(np.abs(np.asarray(difference)) ** 2 / spread, ((0, 0), (2, 2)), mode="edge")
    return np.asarray(median_filter(rough, size=(1, _WIDTH), mode="nearest") / np.log(2))


def _transform(samples: NDArray[np.floating]) -> NDArray[np.complex128]:
    signal = np.asarray(samples, dtype=np.float64)
    return np.asarray(np.fft.rfft(signal - signal.mean()))
