"""The channels of one run, found among the groups and channels of a TDMS file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.data.suggestion import choose_one_of
from vgvt.files.sidecar import ChannelRow, RunRow, Sidecar
from vgvt.files.tdms.read import TdmsChannel, TdmsFile, read_samples
from vgvt.files.tdms.timing import check_rate, check_starts
from vgvt.files.time_axis import check_time_axis
from vgvt.files.unit_agreement import check_unit_label


def columns_of_run(sidecar: Sidecar, run: RunRow, file: TdmsFile) -> list[NDArray[Any]]:
    """The channels (N,) of one run as they stand in the file, in the order of the sidecar.

    InputError names the file's channel and the sidecar's: one that is not there or holds no real numbers, that has
    another length than the others, or whose rate, start or unit is not what the sidecar says.
    """
    where = f"{file.path}, run {run.run}"
    group = _group_of_run(sidecar, run, file, where)
    picked = [_picked(channel, group, file, where) for channel in sidecar.channel]
    _check_told_apart(sidecar, picked, where)
    rate_hz, believed = run.sample_rate_hz or sidecar.records.sample_rate_hz, bool(sidecar.records.overrides)
    for channel, found in zip(sidecar.channel, picked, strict=True):
        here = f"{file.path}, {found.path} (run {run.run}, channel {channel.name!r})"
        if "unit" not in channel.overrides:
            check_unit_label(channel, found.unit, here)
        check_rate(found, rate_hz, believed, here)
        if found.samples != picked[0].samples:
            raise InputError(
                here,
                f"has {found.samples} samples, and channel {sidecar.channel[0].name!r} has {picked[0].samples}",
                "give channels of one recording, cut to one length, or leave this one out of the sidecar",
            )
    if not believed:
        check_starts(picked, rate_hz, where)
    if not sidecar.records.time_s:
        return read_samples(file.path, picked)
    time = _named(sidecar.records.time_s, group, file, where)
    time_s, *columns = read_samples(file.path, [time, *picked])
    check_time_axis(time_s.astype(float), picked[0].samples, rate_hz, f"{file.path}, {time.path} (run {run.run})")
    return columns


def _group_of_run(sidecar: Sidecar, run: RunRow, file: TdmsFile, where: str) -> tuple[TdmsChannel, ...]:
    """The channels of the group that is named, of the run's group where each has its own, or of the only one."""
    groups, named = file.groups, sidecar.records.samples
    if not groups:
        raise InputError(str(file.path), "holds no channels", "export it again, with its channels")
    if named:
        if named not in groups:
            raise InputError(where, f"no group {named!r}", choose_one_of(named, groups))
        name = named
    elif run.index is not None:
        if run.index > len(groups):
            raise InputError(where, f"no run {run.index} in a file of {_counted(len(groups), 'group')}",
                             f"write index = 1 to {len(groups)}")  # fmt: skip
        name = groups[run.index - 1]
    elif len(groups) == 1:
        name = groups[0]
    elif all(channel.variable.startswith("/'") for channel in sidecar.channel):
        return ()
    else:
        raise InputError(
            where,
            f"{len(groups)} groups, and nothing says which one: {', '.join(map(repr, groups))}",
            f"write samples = {groups[0]!r} in [records], give each run the index of its group, or each channel its "
            "whole path as variable, like \"/'group'/'channel'\"",
        )
    channels, columns = file.group(name), sidecar.records.columns
    if columns is not None and columns != len(channels):
        raise InputError(
            where,
            f"{_counted(len(channels), 'channel')} in group {name!r}, but the sidecar speaks of {columns} "
            "(records.columns)",
            "correct columns, or the file",
        )
    return channels


def _picked(channel: ChannelRow, group: Sequence[TdmsChannel], file: TdmsFile, where: str) -> TdmsChannel:
    """The file's channel of a row of the sidecar: by its name or path, or by its column in the group."""
    if channel.variable:
        return _named(channel.variable, group, file, f"{where}, channel {channel.name!r}")
    if channel.column > len(group):
        raise InputError(
            where,
            f"{_counted(len(group), 'channel')} in its group, but channel {channel.name!r} is said to be column "
            f"{channel.column}",
            f"write column = 1 to {len(group)} there, or its name as variable",
        )
    return group[channel.column - 1]


def _named(name: str, group: Sequence[TdmsChannel], file: TdmsFile, where: str) -> TdmsChannel:
    known = {channel.path: channel for channel in file.channels} | {channel.name: channel for channel in group}
    if name in known:
        return known[name]
    offered = [channel.path for channel in file.channels] if name.startswith("/'") else [c.name for c in group]
    raise InputError(where, f"no channel {name!r}", choose_one_of(name, offered))


def _check_told_apart(sidecar: Sidecar, picked: Sequence[TdmsChannel], where: str) -> None:
    taken: dict[str, str] = {}
    for channel, found in zip(sidecar.channel, picked, strict=True):
        other = taken.setdefault(found.path, channel.name)
        if other != channel.name:
            raise InputError(
                where, f"channels {other!r} and {channel.name!r} are both {found.path}", "correct one of them"
            )


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}{'s' * (count != 1)}"
