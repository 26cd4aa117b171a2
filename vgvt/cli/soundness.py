"""Is a campaign fit to identify from? What is wrong with it is said before any number comes out."""

from __future__ import annotations

from dataclasses import replace

from vgvt.cli.console import log
from vgvt.data import Campaign, ChannelRole, InputError, Record
from vgvt.signals.usable import fault_of


def sound_campaign(source: str, leave_out_faulty: bool, *, still_mounted: bool = False) -> Campaign:
    """Open a campaign and refuse it where its samples cannot be trusted; remarks go to stderr.

    With ``leave_out_faulty`` channels with samples that are not finite, or all
    the same, are left out instead, and so are runs that lose their force or all responses.
    Where they are ``still_mounted``, such channels stay in the records of the runs that are kept, as do runs
    that keep their force alone: whoever asks leaves them out itself, and must know what loads the structure and
    which run is which.
    InputError names the source, the run and the channel.
    """
    from vgvt.files import open_campaign

    campaign = open_campaign(source)
    _check_rates(source, campaign)
    for record in campaign.runs:
        for name in record.overloaded:
            log(f"{source}, run {record.run}: {name} clipped; it is used as it is")
    faults = channel_faults(campaign)
    if not faults:
        return campaign
    if not leave_out_faulty:
        (run, channel), fault = next(iter(faults.items()))
        more = f", and {len(faults) - 1} more faulty channels" if len(faults) > 1 else ""
        raise InputError(
            f"{source}, run {run}, channel {channel}",
            fault + more,
            "repair the record, or go on with the rest: --leave-out-faulty",
        )
    for (run, channel), fault in faults.items():
        log(f"{source}, run {run}: {channel} left out, {fault}")
    return _without(source, campaign, set(faults), still_mounted)


def channel_faults(campaign: Campaign) -> dict[tuple[int, str], str]:
    """What is wrong with the samples of forces and responses, by run and channel name; nothing where all is well."""
    found = {}
    for record in campaign.runs:
        for channel, samples in zip(record.channels, record.samples, strict=True):
            fault = None if channel.role is ChannelRole.DRIVE else fault_of(samples, record.sample_rate_hz)
            if fault is not None:
                found[record.run, channel.name] = fault
    return found


def _check_rates(source: str, campaign: Campaign) -> None:
    first = campaign.runs[0]
    for record in campaign.runs[1:]:
        if record.sample_rate_hz != first.sample_rate_hz:
            raise InputError(
                f"{source}, run {record.run}",
                f"it is sampled at {record.sample_rate_hz:g} Hz, but run {first.run} at {first.sample_rate_hz:g} Hz",
                "bring all runs to one rate, or identify from the runs of each rate apart",
            )


def _without(source: str, campaign: Campaign, faulty: set[tuple[int, str]], still_mounted: bool) -> Campaign:
    needed = {ChannelRole.REFERENCE} if still_mounted else {ChannelRole.REFERENCE, ChannelRole.RESPONSE}
    sound = ((record, _record_without(record, faulty, needed)) for record in campaign.runs)
    runs = tuple(record if still_mounted else kept for record, kept in sound if kept is not None)
    if not runs:
        raise InputError(source, "no run keeps a force and a response", "repair the records")
    return replace(campaign, runs=runs)


def _record_without(record: Record, faulty: set[tuple[int, str]], needed: set[ChannelRole]) -> Record | None:
    index = [i for i, channel in enumerate(record.channels) if (record.run, channel.name) not in faulty]
    if len(index) == len(record.channels):
        return record
    channels = tuple(record.channels[i] for i in index)
    if not needed <= {channel.role for channel in channels}:
        what = " or ".join(f"no {'force' if role is ChannelRole.REFERENCE else 'response'}" for role in sorted(needed))
        log(f"run {record.run} left out: it keeps {what}")
        return None
    return replace(record, channels=channels, samples=record.samples[index])
