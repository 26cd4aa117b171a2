"""The channel table that TDMS files suggest: what each channel is by its unit, and how it is found in every run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from vgvt.data import ChannelRole, InputError, Quantity
from vgvt.files.describe.draft import ProposedChannel
from vgvt.files.tdms.read import TdmsChannel
from vgvt.files.tdms.recording import Recording
from vgvt.files.unit_labels import unit_of_label
from vgvt.files.units import QUANTITIES


@dataclass(frozen=True, slots=True)
class Proposal:
    """Channels, and which groups hold them."""

    channels: tuple[ProposedChannel, ...]
    group: str
    """The one that is named for all runs; empty where none needs to be."""
    indices: tuple[int | None, ...]
    """Which group of its file each run is, counted from 1; None where that need not be said."""
    columns: int | None
    """Of the group of a run; None where it is not one number."""
    time: str
    """The channel with the time axis; empty unless every run has one of that name."""
    remarks: tuple[str, ...]


def propose_channels(recordings: Sequence[Recording]) -> Proposal:
    """The channels of all recordings: by name where these are the same in every run, else by column.

    InputError where runs have other channels than the first.
    """
    spread = any(len(recording.groups) > 1 for recording in recordings)
    by_name = _called_alike(recordings, spread)
    rows = _matched(recordings, spread) if by_name else _in_the_same_columns(recordings, spread)
    columns = [_columns(recording) for recording in recordings]
    group, indices = ("", (None,) * len(recordings)) if spread else _where(recordings)
    counted = Counter(row[0].name for row in rows)
    channels = tuple(
        _proposed(row, spread, None if by_name else columns[0][row[0].path], counted[row[0].name] > 1) for row in rows
    )
    sizes = {len(recording.run.file.group(recording.groups[0])) for recording in recordings}
    return Proposal(
        channels,
        group,
        indices,
        sizes.pop() if len(sizes) == 1 and not spread else None,
        _time(recordings, spread),
        tuple(_other_labels(channels, rows)),
    )


def _called(channel: TdmsChannel, spread: bool) -> str:
    return channel.path if spread else channel.name


def _called_alike(recordings: Sequence[Recording], spread: bool) -> bool:
    """True where the same names are in every run; a name that looks like a path would be taken for one."""
    names = [[_called(channel, spread) for channel in recording.channels] for recording in recordings]
    odd = not spread and any(name.startswith("/'") or not name for name in names[0])
    return not odd and all(set(one) == set(names[0]) for one in names)


def _matched(recordings: Sequence[Recording], spread: bool) -> list[tuple[TdmsChannel, ...]]:
    keyed = [{_called(channel, spread): channel for channel in recording.channels} for recording in recordings]
    return [tuple(one[name] for one in keyed) for name in keyed[0]]


def _in_the_same_columns(recordings: Sequence[Recording], spread: bool) -> list[tuple[TdmsChannel, ...]]:
    """Channels at the same columns of every run's group; InputError where these hold other quantities."""
    first = recordings[0]
    for recording in recordings[1:]:
        kinds, others = (
            [(_columns(one)[channel.path], _quantity(channel)) for channel in one.channels]
            for one in (first, recording)
        )
        if spread or kinds != others:
            raise InputError(
                f"{recording.run.file.path}, {', '.join(map(repr, recording.groups))}",
                f"its channels are not those of the first run: {_listed(recording)}, and there {_listed(first)}",
                "describe files with other channels by themselves, or say with --columns how many a run has",
            )
    return list(zip(*(recording.channels for recording in recordings), strict=True))


def _columns(recording: Recording) -> dict[str, int]:
    """Where each channel stands in its group, counted from 1, by its path."""
    groups = [recording.run.file.group(name) for name in recording.groups]
    return {channel.path: k for group in groups for k, channel in enumerate(group, start=1)}


def _where(recordings: Sequence[Recording]) -> tuple[str, tuple[int | None, ...]]:
    """The group to name for all runs, or the index of each run's own; neither where files have one alone."""
    runs = [(recording.run.file, recording.groups[0]) for recording in recordings]
    if all(len(file.groups) == 1 for file, _ in runs):
        return "", (None,) * len(runs)
    names = {name for _, name in runs}
    if len(names) == 1 and not any(recording.run.one_of_several for recording in recordings):
        return names.pop(), (None,) * len(runs)
    return "", tuple(file.groups.index(name) + 1 for file, name in runs)


def _time(recordings: Sequence[Recording], spread: bool) -> str:
    """The name of the time axis; its path where it stands outside the one group that holds the channels."""
    names = set()
    for recording in recordings:
        time = recording.time
        outside = time is not None and (spread or time.group != recording.groups[0])
        names.add("" if time is None else _called(time, outside))
    return names.pop() if len(names) == 1 else ""


def _proposed(row: Sequence[TdmsChannel], spread: bool, column: int | None, twice: bool) -> ProposedChannel:
    first = row[0]
    quantity = _quantity(first)
    labelled = unit_of_label(first.unit)
    return ProposedChannel(
        name=f"{first.group}/{first.name}" if twice else first.name or f"channel{column}",
        role=ChannelRole.REFERENCE if quantity is Quantity.EXCITATION_FORCE else ChannelRole.RESPONSE,
        quantity=next((word for word, kind in QUANTITIES.items() if kind is quantity), ""),
        unit="" if quantity is None or labelled is None else labelled[1],
        label=first.unit,
        column=column,
        places=(None,) * len(row),
        variable=_called(first, spread) if column is None else "",
    )


def _quantity(channel: TdmsChannel) -> Quantity | None:
    """What its unit says that was measured; volts may be of any sensor, or of the drive signal."""
    labelled = unit_of_label(channel.unit)
    return None if labelled is None or labelled[0] is Quantity.GENERAL else labelled[0]


def _other_labels(channels: Sequence[ProposedChannel], rows: Sequence[Sequence[TdmsChannel]]) -> list[str]:
    words = []
    for channel, row in zip(channels, rows, strict=True):
        labels = list(dict.fromkeys(found.unit for found in row))
        if len(labels) > 1:
            words.append(f"CHECK: the unit of {channel.name} changes from run to run: {', '.join(map(repr, labels))}")
    return words


def _listed(recording: Recording) -> str:
    return ", ".join(repr(channel.name) for channel in recording.channels[:8])
