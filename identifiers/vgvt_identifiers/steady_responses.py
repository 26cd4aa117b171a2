"""The responses that a method without a force can use: measured together, under steady broad-band excitation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, Channel, ChannelRole, Dof, Record
from vgvt.signals.usable import fault_of
from vgvt_identifiers.output_spectra import DIFFERENTIATIONS

_BLOCKS = 16
_LEAST_STEADINESS = 0.3


@dataclass(frozen=True, slots=True, eq=False)
class SteadyResponses:
    """Samples (D, N) of motion channels of one run; ``problem`` says why they cannot be used, empty if they can."""

    channels: tuple[Channel, ...]
    samples: NDArray[np.float64]
    sample_rate_hz: float
    remarks: tuple[str, ...]
    problem: str = ""

    @property
    def duration_s(self) -> float:
        """Length of the record in seconds."""
        return float(self.samples.shape[1] / self.sample_rate_hz)


def steady_responses(campaign: Campaign, band_hz: tuple[float, float]) -> SteadyResponses:
    """The sound motion channels of the run that has most, with remarks on what is left out, and what is wrong.

    Sensors at one point along one axis, ``12-Z`` and ``12+Z``, are one response: the mean of those that measure what
    the first does.
    """
    best = max(campaign.runs, key=lambda r: (len(r.select(ChannelRole.RESPONSE)[0]), r.duration_s, -r.run))
    others = sorted(r.run for r in campaign.runs if r is not best)
    every = tuple(text for r in campaign.runs for text in _faults(r)[2])
    channels, samples, _ = _faults(best)
    channels, samples, joined = _joined(channels, samples)
    every = (*every, *joined)
    problem = ""
    missing = {d.unsigned for d in campaign.response_dofs} - {c.dof.unsigned for c in best.channels if c.dof}
    if others and missing:
        problem = (
            f"{len(missing)} responses were not measured together with those of run {best.run}: without a force their "
            "shapes cannot be joined; measure all sensors at once, or use a method with the force"
        )
    elif len(channels) < 2:
        problem = f"run {best.run} has {len(channels)} sound motion channels, two are needed"
    else:
        steady = steadiness(samples, best.sample_rate_hz, band_hz)
        if steady < _LEAST_STEADINESS:
            problem = (
                f"the power within the band comes and goes (steadiness {steady:.2f} of 1), as in a sweep or a few "
                "bursts; without a force the excitation must be broad-band and steady: use a method with the force"
            )
    if others and not missing:
        every = (*every, f"run {best.run} is used alone, run {', '.join(map(str, others))} is left out")
    if not problem:
        every = (*every, *_trap(campaign))
    return SteadyResponses(channels, samples, best.sample_rate_hz, every, problem)


def _joined(
    channels: tuple[Channel, ...], samples: NDArray[np.float64]
) -> tuple[tuple[Channel, ...], NDArray[np.float64], tuple[str, ...]]:
    """The channels with their samples (D, N), each DOF once, and a remark for each that several measured."""
    places: dict[Dof | None, list[int]] = {}
    for i, channel in enumerate(channels):
        places.setdefault(channel.dof and channel.dof.unsigned, []).append(i)
    kept, rows, remarks = [], [], []
    for dof, found in places.items():
        first = channels[found[0]]
        alike = [i for i in found if channels[i].quantity is first.quantity]
        turned = [1 if (d := channels[i].dof) is None or d == first.dof else -1 for i in alike]
        kept.append(first)
        rows.append(np.mean([sign * samples[i] for sign, i in zip(turned, alike, strict=True)], axis=0))
        if len(found) > 1:
            names = ", ".join(channels[i].name for i in found)
            mean = "their mean is taken" if len(alike) > 1 else f"{first.name} is taken"
            other = " of one quantity" if 1 < len(alike) < len(found) else ""
            remarks.append(f"{dof} is measured by {names}: {mean}{other}")
    return tuple(kept), np.array(rows) if rows else samples, tuple(remarks)


def _trap(campaign: Campaign) -> tuple[str, ...]:
    """What to know where a force was measured and is not used."""
    if not any(c.role is not ChannelRole.RESPONSE for r in campaign.runs for c in r.channels):
        return ()
    return (
        "the force is not used: on a shaker the responses alone show the combined resonances of shaker and aircraft; "
        "use a method that takes the force, such as cfdd",
    )


def steadiness(samples: NDArray[np.float64], sample_rate_hz: float, band_hz: tuple[float, float]) -> float:
    """How evenly the power of responses (D, N) is spread over time: 1 steady, towards 0 a sweep or a burst.

    In each of 12 parts of the band the powers of 16 blocks of time are compared by their geometric over
    arithmetic mean; a sweep passes a part in few blocks. The median over the parts is returned.
    """
    length = samples.shape[1] // _BLOCKS
    pieces = samples[:, : _BLOCKS * length].reshape(samples.shape[0], _BLOCKS, length)
    pieces = (pieces - pieces.mean(axis=2, keepdims=True)) * np.hanning(length)
    power = (np.abs(np.fft.rfft(pieces, axis=2)) ** 2).sum(axis=0)
    frequency = np.fft.rfftfreq(length, 1 / sample_rate_hz)
    inside = (frequency >= max(band_hz[0], 2 * sample_rate_hz / length)) & (frequency <= band_hz[1])
    parts = [p.sum(axis=1) for p in np.array_split(power[:, inside], 12, axis=1) if p.size]
    if not parts:
        return 1.0
    levels = np.array(parts) + 1e-12 * float(np.max(parts)) + 1e-300
    return float(np.median(np.exp(np.log(levels).mean(axis=1)) / levels.mean(axis=1)))


def _faults(record: Record) -> tuple[tuple[Channel, ...], NDArray[np.float64], tuple[str, ...]]:
    """The sound motion channels of one run, their samples (D, N), and a remark for each one left out."""
    remarks, channels, rows = [], [], []
    for channel, samples in zip(record.channels, record.samples, strict=True):
        if channel.role is not ChannelRole.RESPONSE:
            continue
        fault = fault_of(samples, record.sample_rate_hz)
        if fault is None and channel.quantity not in DIFFERENTIATIONS:
            fault = f"{channel.quantity.name.lower()} is no motion"
        if fault is None:
            channels.append(channel)
            rows.append(np.asarray(samples, dtype=np.float64))
        else:
            remarks.append(f"run {record.run}: {channel.name} ({channel.dof}) left out, {fault}")
    stacked = np.array(rows) if rows else np.empty((0, record.samples.shape[1]))
    return tuple(channels), stacked, tuple(remarks)
