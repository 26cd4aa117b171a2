"""Whether records start and end at rest: only then do their whole spectra divide without leakage."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign
from vgvt.signals.usable import UsableRun

_UNRECORDED_NOTE = "unrecorded_s"  # how long the shaker had run when the records began
_AT_REST = 0.1  # root mean square at an end over that of the record
_END = 0.02  # part of a record that is its end
_START = 1 / 64  # of the shortest period in the band: what starts from rest has not moved by then
_PASSING = 0.25  # part of a record; noise fills half of it at any one frequency, a multisine more
_LEAST = float(np.finfo(float).tiny)


def start_at_rest(campaign: Campaign, runs: tuple[UsableRun, ...]) -> bool:
    """Whether no force acts and nothing rings at the first samples of records, nor did by the campaign's notes.

    Responses of one quantity count together, by their power, and are allowed the noise that fills all frequencies.
    """
    if _begun_late(campaign):
        return False
    moved: dict[str, list[tuple[NDArray[np.floating], float, float]]] = {}
    for run in runs:
        begin = max(1, round(_START * run.sample_rate_hz / campaign.band_hz[1]))
        forces = [_centred(x) for x in run.reference_samples]
        if max(_level(x[:begin]) for x in forces) > _AT_REST * max(_level(x) for x in forces):
            return False
        for channel, samples in zip(run.responses, run.response_samples, strict=True):
            signal = _centred(samples)
            levels = (_level(signal[:begin]) ** 2, _level(signal) ** 2)
            moved.setdefault(channel.quantity.name, []).append((samples, *levels))
    return all(_quiet(responses) for responses in moved.values())


def _quiet(responses: list[tuple[NDArray[np.floating], float, float]]) -> bool:
    """Whether responses (n,) of one quantity, with the power of their first samples and of all, begin quietly."""
    spare = sum(first - _AT_REST**2 * whole for _, first, whole in responses)
    if spare <= 0:
        return True
    # Three deviations of the power of as many samples of noise.
    noise = sum(whole * _noise_share(_centred(samples)) for samples, _, whole in responses)
    return bool(spare <= noise * (1 + 3 * np.sqrt(2 / len(responses))))


def end_at_rest(runs: tuple[UsableRun, ...]) -> bool:
    """Whether no force acts and nothing rings at the ends of records; an idle shaker is measured by the others."""
    shares = []
    for run in runs:
        end = max(16, round(_END * run.samples))
        forces = [_centred(x) for x in run.reference_samples]
        if max(_level(x[-end:]) for x in forces) > _AT_REST * max(_level(x) for x in forces):
            return False
        shares += [_ringing(x[-end:]) / max(_level(x), _LEAST) for x in map(_centred, run.response_samples)]
    # Over all responses: of one alone that hears little, chance makes its noise look like ringing.
    return _level(np.array(shares)) <= _AT_REST


def pass_once(runs: tuple[UsableRun, ...], band_hz: tuple[float, float]) -> bool:
    """Whether forces are at any one frequency for a small part of the record only, as those of sweeps and hits are."""
    return all(_passing(x, run.sample_rate_hz, band_hz) <= _PASSING for run in runs for x in run.reference_samples)


def _begun_late(campaign: Campaign) -> bool:
    try:
        return float(campaign.notes.get(_UNRECORDED_NOTE, 0.0)) > 0
    except ValueError:
        return False  # a note in other words; the records themselves are asked


def _noise_share(signal: NDArray[np.float64]) -> float:
    """The part of a signal's power (n,) that is noise on all lines, told from the tenth of them that have least."""
    power = np.abs(np.fft.rfft(signal)) ** 2
    # A tenth of lines of noise lies below this part of their mean: their power is exponentially distributed.
    return float(min(1.0, np.quantile(power, 0.1) / -np.log(0.9) / max(float(power.mean()), _LEAST)))


def _passing(samples: NDArray[np.floating], rate_hz: float, band_hz: tuple[float, float]) -> float:
    """The part of a record (n,) in which a frequency is excited, median over the band; 1 where none can be told.

    Told from short spectra that are as fine in time as in frequency, each of its whole.
    """
    from scipy.signal import stft

    signal = _centred(samples)
    low, high = band_hz
    length = max(8, round(rate_hz * np.sqrt(signal.size / rate_hz / max(high - low, _LEAST))))
    if 2 * length > signal.size:
        return 1.0
    frequency, _, short = stft(signal, rate_hz, nperseg=length, noverlap=length // 2, boundary=None, padded=False)
    power = np.abs(short[(frequency >= low) & (frequency <= high)]) ** 2
    if not power.size:
        return 1.0
    # The number of equal parts that would scatter as these do.
    filled = power.sum(axis=1) ** 2 / np.maximum((power**2).sum(axis=1), _LEAST)
    return float(np.median(filled) / power.shape[1])


def _ringing(tail: NDArray[np.float64]) -> float:
    """Root mean square of what rings in the end (n,) of a response: it fills few frequencies, where noise fills all."""
    power = np.abs(np.fft.rfft(tail * np.hanning(tail.size))) ** 2
    excess = max(0.0, 1 - 2 * float(np.median(power)) / max(float(power.mean()), _LEAST))
    return float(np.sqrt(excess)) * _level(tail)


def _centred(samples: NDArray[np.floating]) -> NDArray[np.float64]:
    signal = np.asarray(samples, dtype=np.float64)
    return np.asarray(signal - signal.mean())


def _level(samples: NDArray[np.float64]) -> float:
    return float(np.sqrt((samples**2).mean()))
