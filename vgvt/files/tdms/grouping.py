"""Which groups of a TDMS file were recorded together: one a run, or all of them as devices of one recording."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from vgvt.data import InputError
from vgvt.files.tdms.read import TdmsChannel, TdmsFile
from vgvt.files.tdms.timing import increment_s

# Clocks that were never set begin in 1904 or 1970.
_EARLIEST = np.datetime64("1971-01-01")


@dataclass(frozen=True, slots=True, eq=False)
class GroupedRun:
    """The groups of one recording, as they stand in a file."""

    file: TdmsFile
    groups: tuple[str, ...]
    one_of_several: bool
    """True where it is one group of a file with several, each a run of its own."""

    @property
    def channels(self) -> tuple[TdmsChannel, ...]:
        """All that its groups hold, in order of appearance."""
        return tuple(channel for channel in self.file.channels if channel.group in self.groups)


def group_runs(file: TdmsFile, columns: int | None = None) -> tuple[GroupedRun, ...]:
    """The runs of a file: ``columns`` channels each; left out, the most in which no name comes twice.

    Groups of the same names that began together are devices of one recording, though. InputError where the file holds
    no channels, or none of ``columns`` together.
    """
    groups = file.groups
    if not groups:
        raise InputError(str(file.path), "holds no channels", "export it again, with its channels")
    sizes = {name: len(file.group(name)) for name in groups}
    whole = GroupedRun(file, groups, False)
    if columns is None:
        alike = _of_the_same_names(file)
        as_runs = len(alike) > 1 and not _begin_together([file.group(name) for name in alike])
    else:
        alike = [name for name in groups if sizes[name] == columns]
        as_runs = sum(sizes.values()) != columns
        if as_runs and not alike:
            counts = ", ".join(f"{name!r} has {size}" for name, size in sizes.items())
            raise InputError(
                str(file.path),
                f"no group has {columns} channels, nor have all of them together ({counts})",
                "correct --columns: the channels of the groups that are runs, or those of the whole file",
            )
    if not as_runs:
        return (whole,)
    return tuple(GroupedRun(file, (name,), True) for name in alike)


def _of_the_same_names(file: TdmsFile) -> list[str]:
    """The groups whose channels are called alike: the most there are of one kind."""
    called = {name: frozenset(channel.name for channel in file.group(name)) for name in file.groups}
    (most, _), *_ = Counter(called.values()).most_common(1)
    return [name for name, names in called.items() if names == most]


def _begin_together(groups: Sequence[Sequence[TdmsChannel]]) -> bool:
    """True where clocks say that a group began before another one was half over: those are no two runs."""
    begins = [next((moment for moment in map(_moment, group) if moment is not None), None) for group in groups]
    known = sorted(moment for moment in begins if moment is not None)
    if len(known) < len(groups):
        return False
    half_s = max(_length_s(channel) for group in groups for channel in group) / 2
    return any((b - a) / np.timedelta64(1, "s") <= half_s for a, b in pairwise(known))


def _moment(channel: TdmsChannel) -> np.datetime64 | None:
    stated = channel.properties.get("wf_start_time")
    return stated if isinstance(stated, np.datetime64) and stated > _EARLIEST else None


def _length_s(channel: TdmsChannel) -> float:
    try:
        return channel.samples * (increment_s(channel, "") or 0.0)
    except InputError:  # No function of time lasts no time.
        return 0.0
