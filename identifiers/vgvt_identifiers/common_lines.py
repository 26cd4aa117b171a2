"""Frequency lines that runs of different lengths share, without zeros at the ends of the shorter ones.

A record that is padded to a longer one has lines between its own, on which noise is interpolated, what
leaks is not smooth, and an error is counted as often as there are lines: modes that are not there, and
errors told too small. Here the lines are those of the shorter records, and a longer record
is transformed over a whole number of their length: it has these lines among its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_SHORTEST = 0.5  # of the median length; a run shorter than that broke off
_PART_LINES = 25  # over which the power of a force is asked for
_LEAST_LEFT = 0.5  # of the energy in every part of the band, over what the samples kept are of all
_DRIVEN = 1e-4  # of the mean power of all parts, which a part holds that is driven at all
_WHOLE = 1e-6  # of a sample, by which a length may differ from a whole number of them


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """What choosing lines takes: number, rate and force (N,) of a run, and how many responses it has."""

    run: int
    rate_hz: float
    force: NDArray[np.floating]
    responses: int

    @property
    def duration_s(self) -> float:
        """Length of the record."""
        return self.force.size / self.rate_hz


@dataclass(frozen=True, slots=True)
class CommonLines:
    """Lines at multiples of 1/``length_s``, how many samples of each run take part, and remarks on what does not."""

    length_s: float
    samples: dict[int, int]
    remarks: tuple[str, ...] = ()

    def transform(
        self, samples: NDArray[np.floating], rate_hz: float, lines: NDArray[np.intp]
    ) -> NDArray[np.complex128]:
        """Sums of the samples (n,) of one channel less their mean, at ``lines`` (K,), neighbours, in 1/length_s."""
        from scipy.signal import czt

        signal = np.asarray(samples, dtype=np.float64)
        signal = signal - signal.mean()
        times = signal.size / (self.length_s * rate_hz)
        stride = round(times)
        if abs(times - stride) * self.length_s * rate_hz < _WHOLE:
            return np.asarray(np.fft.rfft(signal)[lines * stride])
        # No whole number of samples is as long as the lines ask for: their transform is taken between its own lines.
        step = np.exp(-2j * np.pi / (self.length_s * rate_hz))
        first = np.exp(2j * np.pi * lines[0] / (self.length_s * rate_hz))
        return np.asarray(czt(signal, lines.size, step, first))


def common_lines(runs: Sequence[Measured], band_hz: tuple[float, float]) -> CommonLines:
    """The lines on which most responses remain; of equals, the finest.

    A run takes part with as many whole lengths as it holds, if what is then cut off its end holds no
    part of the band that the rest does not. Runs shorter than half the median have no say.
    """
    lengths = {run.run: run.duration_s for run in runs}
    if len({round(length / min(lengths.values()), 9) for length in lengths.values()}) == 1:
        return CommonLines(runs[0].duration_s, {run.run: run.force.size for run in runs})
    least = _SHORTEST * float(np.median(list(lengths.values())))
    choices = [_taking_part(runs, length, band_hz) for length in sorted(set(lengths.values())) if length >= least]
    responses = {run.run: run.responses for run in runs}
    return max(choices, key=lambda c: (sum(responses[run] for run in c.samples), c.length_s))


def _taking_part(runs: Sequence[Measured], length_s: float, band_hz: tuple[float, float]) -> CommonLines:
    samples: dict[int, int] = {}
    remarks = [f"the runs differ in length: frequency lines are {1 / length_s:.4g} Hz apart, those of {length_s:.6g} s"]
    for run in runs:
        size = run.force.size
        times = int((size + _WHOLE) / (length_s * run.rate_hz))
        kept = min(size, int(times * length_s * run.rate_hz + _WHOLE))
        if not times:
            remarks.append(f"run {run.run} left out: it lasts {run.duration_s:.4g} s, shorter than the others")
        elif not _band_is_left(run, kept, band_hz):
            remarks.append(
                f"run {run.run} left out: its first {kept / run.rate_hz:.4g} s, as long as the others, do not hold "
                "the whole band; make the runs of one length"
            )
        else:
            samples[run.run] = kept
            if kept < size:
                remarks.append(
                    f"run {run.run}: of {run.duration_s:.4g} s the first {kept / run.rate_hz:.4g} s are used"
                )
    return CommonLines(length_s, samples, tuple(remarks))


def _band_is_left(run: Measured, kept: int, band_hz: tuple[float, float]) -> bool:
    """Whether the first ``kept`` samples of a force hold their share of its energy in every part of the band."""
    if kept == run.force.size:
        return True
    width = _PART_LINES * run.rate_hz / kept
    edges = np.append(np.arange(band_hz[0], band_hz[1], width), band_hz[1])
    powers = []
    for force in (run.force[:kept], run.force):
        signal = np.asarray(force, dtype=float)
        lines = np.fft.rfftfreq(signal.size, 1 / run.rate_hz)
        power = np.abs(np.fft.rfft(signal - signal.mean())) ** 2 / signal.size
        powers.append(np.histogram(lines, edges, weights=power)[0])
    left, whole = powers
    driven = whole > _DRIVEN * whole.mean()
    # Of steady noise every part keeps what the length keeps.
    return bool(np.all(left[driven] >= _LEAST_LEFT * kept / run.force.size * whole[driven]))
