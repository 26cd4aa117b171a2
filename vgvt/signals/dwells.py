"""Stepped sine as an analyser reads it: at every dwell wait, then integrate over whole cycles.

What is left of the step to the dwell's frequency biases the reading. A mode with pole
-ζω ± iω_d leaves a share of its step that falls with the time to settle as exp(-ζω t),
and that the integration over T shortens by about 1/(ζω T): settle for 5/(ζω) of the slowest mode.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, InputError
from vgvt.signals.excitation_sines import stepped_frequencies

NOTE = "dwells"
# Scatter between blocks of one dwell gives the variance: four are enough to see it, more would be short.
_MOST_BLOCKS = 4
_FEWEST_SAMPLES = 8

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True)
class DwellSchedule:
    """When a stepped sine dwells where: ``points`` frequencies of ``dwell_s`` each, of which ``settle_s`` is waited."""

    start_hz: float
    stop_hz: float
    points: int
    dwell_s: float
    settle_s: float
    lead_in_s: float = 0.0

    @property
    def frequency_hz(self) -> Array:
        """Frequencies in the order of the dwells, shape (points,)."""
        return stepped_frequencies(self.start_hz, self.stop_hz, self.points)

    @property
    def cycles(self) -> NDArray[np.intp]:
        """Whole cycles that each dwell has time to integrate over, shape (points,)."""
        return np.floor((self.dwell_s - self.settle_s) * self.frequency_hz + 1e-9).astype(int)

    def note(self) -> str:
        """The schedule as a campaign's notes carry it, under the key 'dwells'."""
        return json.dumps(asdict(self))


def dwell_schedule(campaign: Campaign) -> DwellSchedule | None:
    """The dwells that a campaign's notes tell of, None without any; InputError for a note that cannot be read."""
    if NOTE not in campaign.notes:
        return None
    try:
        return DwellSchedule(**json.loads(campaign.notes[NOTE]))
    except (TypeError, ValueError) as error:
        example = DwellSchedule(3.0, 35.0, 400, 0.5, 0.15).note()
        raise InputError(f"{campaign.name}, note {NOTE!r}", str(error), f"write it like {example}") from error


@dataclass(frozen=True, slots=True, eq=False)
class DwellFit:
    """A record cut into blocks of whole cycles, and the weights that read a sine's amplitude and phase from each.

    ``sample`` and ``weight`` (W,) belong to all blocks one after the other, which begin at ``begin``
    (blocks,); ``cell`` are their places in a table of (blocks of a dwell, dwells by frequency).
    """

    frequencies_hz: Array
    block_s: Array
    blocks: NDArray[np.intp]
    sample: NDArray[np.intp]
    weight: Complex
    begin: NDArray[np.intp]
    cell: tuple[NDArray[np.intp], NDArray[np.intp]]

    def frequency_hz(self, sample_rate_hz: float) -> Array:
        """The frequencies dwelt at, rising, (points,); the rate does not matter."""
        return self.frequencies_hz

    def effective_averages(self) -> Array:
        """Blocks of every dwell, (points,)."""
        return self.blocks.astype(float)

    def spectra(self, samples: NDArray[np.floating], *, force: bool = False) -> Complex:
        """Complex amplitudes (blocks, points) of one channel (N,); zero where a dwell has fewer blocks."""
        amplitudes = np.zeros((int(self.blocks.max()), self.blocks.size), dtype=complex)
        amplitudes[self.cell] = np.add.reduceat(samples[self.sample] * self.weight, self.begin)
        return amplitudes


def fit_dwells(where: str, schedule: DwellSchedule, samples: int, sample_rate_hz: float) -> DwellFit:
    """The blocks and weights for records of ``samples`` at a rate.

    In each block a sine, a cosine and a constant are fitted by least squares: over whole cycles
    that is the analyser's integral, whether or not samples divide cycles. InputError where
    the record ends before the dwells do, or a cycle has too few samples.
    """
    order = np.argsort(schedule.frequency_hz)
    frequency, cycles = schedule.frequency_hz[order], schedule.cycles[order]
    if (schedule.lead_in_s + schedule.points * schedule.dwell_s) * sample_rate_hz > samples + 1:
        problem = f"the dwells last longer than a record of {samples / sample_rate_hz:.4g} s"
        raise InputError(where, problem, "correct points, dwell_s or lead_in_s")
    if cycles.min() < 1:
        problem = f"less than a cycle is left to integrate over at {frequency[np.argmin(cycles)]:g} Hz"
        raise InputError(where, problem, "settle less, or dwell longer")
    sample, weight, size, cell, blocks, length = [], [], [], [], [], []
    for point, (f, whole, dwell) in enumerate(zip(frequency, cycles, order, strict=True)):
        count, each = _blocks(where, float(f), int(whole), sample_rate_hz)
        end = schedule.lead_in_s + (dwell + 1) * schedule.dwell_s
        edges = np.ceil((end - np.arange(count, -1, -1) * each / f) * sample_rate_hz - 1e-9).astype(int)
        for block, (first, last) in enumerate(pairwise(edges)):
            index = np.arange(first, min(last, samples))
            sample.append(index)
            weight.append(_sine_weights(2 * np.pi * f / sample_rate_hz * index))
            size.append(index.size)
            cell.append((block, point))
        blocks.append(count)
        length.append(each / f)
    begin = np.concatenate([[0], np.cumsum(size)[:-1]])
    rows, columns = np.array(cell).T
    return DwellFit(
        frequency, np.array(length), np.array(blocks), np.concatenate(sample), np.concatenate(weight), begin,
        (rows, columns),
    )  # fmt: skip


def with_known_variance(variance: Array, force_power: Array, block_s: Array) -> Array | None:
    """The variance (R, L) with its NaN filled where a dwell had one block only; None where all had.

    There the noise is that of the nearest lines that know it: its power falls with the length of a block.
    """
    known = np.isfinite(variance).all(axis=0)
    if not known.any():
        return None
    line = np.arange(known.size)
    share = force_power * block_s
    noise = [np.interp(line, line[known], row[known] * share[known]) for row in variance]
    return np.where(known, variance, np.array(noise) / share)


def _blocks(where: str, frequency_hz: float, cycles: int, sample_rate_hz: float) -> tuple[int, int]:
    """How many blocks of how many cycles."""
    for count in range(min(_MOST_BLOCKS, cycles), 0, -1):
        each = cycles // count
        if each / frequency_hz * sample_rate_hz >= _FEWEST_SAMPLES and 2.2 * frequency_hz < sample_rate_hz:
            return count, each
    raise InputError(
        where,
        f"a dwell at {frequency_hz:g} Hz holds too few samples at {sample_rate_hz:g} Hz to read a sine from",
        "sample faster, or dwell longer",
    )


def _sine_weights(phase: Array) -> Complex:
    """Weights (n,) that read X of samples Re(X exp(i phase)) + constant by least squares."""
    fit = np.linalg.pinv(np.stack([np.cos(phase), -np.sin(phase), np.ones_like(phase)], axis=1))
    return np.asarray(fit[0] + 1j * fit[1])
