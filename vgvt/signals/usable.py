"""Which channels of a campaign can go into a frequency response, and why the others cannot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, Channel, ChannelRole, InputError, Record
from vgvt.signals.clipping import clipped_share

MOST_CLIPPED = 0.005
"""Share of clipped samples above which a channel is not used: a resonance fills no more of a sweep."""


@dataclass(frozen=True, slots=True, eq=False)
class UsableRun:
    """The sound channels of one run; samples are views of the record's.

    ``mounted`` are all its response channels, those left out among them: their sensors load the structure all the same.
    """

    run: int
    sample_rate_hz: float
    references: tuple[Channel, ...]
    reference_samples: tuple[NDArray[np.floating], ...]
    responses: tuple[Channel, ...]
    response_samples: tuple[NDArray[np.floating], ...]
    mounted: tuple[Channel, ...]

    @property
    def samples(self) -> int:
        """Length of the record in samples."""
        return int(self.reference_samples[0].size)


def usable_runs(campaign: Campaign, *, every_run: bool = False) -> tuple[tuple[UsableRun, ...], tuple[str, ...]]:
    """The runs with their sound channels, and a remark for every channel left out or doubtful.

    Runs without a sound response are left out, but for ``every_run``: what changes from run to run counts them.
    InputError when a run has no sound reference, or when no response is left in the whole campaign.
    """
    remarks: list[str] = []
    runs = tuple(_usable_run(campaign.name, record, remarks) for record in campaign.runs)
    sound = tuple(run for run in runs if run.responses)
    if not sound:
        raise InputError(
            campaign.name,
            "no response channel can be used" + "".join(f"\n    {r}" for r in remarks),
            "check the channel table: at least one response with samples that are finite and not constant is needed",
        )
    return runs if every_run else sound, tuple(remarks)


def fault_of(samples: NDArray[np.floating], sample_rate_hz: float) -> str | None:
    """Why one channel (N,) cannot be used, or None: samples not finite, all the same, or clipped in large part."""
    # One pass over the samples without a mask as long as the record: NaN and inf survive min and max.
    low, high = float(samples.min()), float(samples.max())
    if not (np.isfinite(low) and np.isfinite(high)):
        bad = np.flatnonzero(~np.isfinite(samples))
        return f"{bad.size} of {samples.size} samples are not finite (first at {bad[0] / sample_rate_hz:.4g} s)"
    if low == high:
        return f"dead: every sample is {low:g}"
    share = clipped_share(samples)
    if share > MOST_CLIPPED:
        return f"saturated: {100 * share:.2g} % of its samples lie on a flat top or bottom"
    return None


def doubt_of(samples: NDArray[np.floating]) -> str | None:
    """What to know of one channel (N,) that is used all the same, or None: a little clipping."""
    share = clipped_share(samples)
    return f"{100 * share:.2g} % of its samples are clipped; it is used as it is" if share > 0 else None


def _usable_run(campaign: str, record: Record, remarks: list[str]) -> UsableRun:
    references = [(c, x) for c, x in zip(record.channels, record.samples, strict=True) if _is(c, ChannelRole.REFERENCE)]
    responses = [(c, x) for c, x in zip(record.channels, record.samples, strict=True) if _is(c, ChannelRole.RESPONSE)]
    if not references:
        raise InputError(
            f"{campaign}, run {record.run}",
            "no reference (force) channel",
            "give one channel the role 'reference', or leave this run out",
        )
    for channel, samples in references:
        fault = fault_of(samples, record.sample_rate_hz)
        if fault is not None:
            raise InputError(
                f"{campaign}, run {record.run}, channel {channel.name} ({channel.dof})",
                f"the reference cannot be used: {fault}",
                f"repair the record or leave run {record.run} out; a frequency response needs the force of its own run",
            )
    sound = []
    for channel, samples in responses:
        fault = fault_of(samples, record.sample_rate_hz)
        if fault is None:
            sound.append((channel, samples))
            doubt = doubt_of(samples)
            if doubt is not None and channel.name not in record.overloaded:
                remarks.append(f"run {record.run}: {channel.name} ({channel.dof}): {doubt}")
        else:
            remarks.append(f"run {record.run}: {channel.name} ({channel.dof}) left out, {fault}")
    remarks += [f"run {record.run}: {name} clipped; it is used as it is" for name in record.overloaded]
    return UsableRun(
        record.run,
        record.sample_rate_hz,
        tuple(c for c, _ in references),
        tuple(x for _, x in references),
        tuple(c for c, _ in sound),
        tuple(x for _, x in sound),
        tuple(c for c, _ in responses),
    )


def _is(channel: Channel, role: ChannelRole) -> bool:
    return channel.role is role
