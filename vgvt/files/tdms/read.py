"""A TDMS file as a whole: its groups and channels with what they state, and the samples of those asked for."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.files.tdms.segments import check_segments

if TYPE_CHECKING:
    import nptdms

Kind = Literal["numbers", "times", "others"]
"""What samples are: real numbers, moments, or neither."""

_AGAIN = "export or copy the file again"
# Of texts that are not UTF-8, which are no samples.
_HARMLESS = "nptdms.types"


@dataclass(frozen=True, slots=True, eq=False)
class TdmsChannel:
    """One channel as the file states it; its samples are read when they are asked for."""

    group: str
    name: str
    samples: int
    properties: dict[str, Any]

    @property
    def path(self) -> str:
        """How TDMS writes its place: ``/'group'/'channel'``, with quotes doubled."""
        return "/" + "/".join("'" + part.replace("'", "''") + "'" for part in (self.group, self.name))

    @property
    def unit(self) -> str:
        """Label of its unit, as LabVIEW and DIAdem keep it; empty where there is none."""
        stated = (self.properties.get(key) for key in ("unit_string", "NI_UnitDescription"))
        return next((str(label).strip() for label in stated if label), "")


@dataclass(frozen=True, slots=True, eq=False)
class TdmsFile:
    """What a TDMS file states."""

    path: Path
    channels: tuple[TdmsChannel, ...]
    """In order of appearance."""

    @property
    def groups(self) -> tuple[str, ...]:
        """Names of the groups that have channels, in order of appearance."""
        return tuple(dict.fromkeys(channel.group for channel in self.channels))

    def group(self, name: str) -> tuple[TdmsChannel, ...]:
        """The channels of a group, none where there is no such group."""
        return tuple(channel for channel in self.channels if channel.group == name)


def read_tdms(path: Path) -> TdmsFile:
    """Read what a TDMS file states of its channels.

    InputError when it is missing, empty, truncated, damaged or of another kind, or when npTDMS is not installed.
    """
    with _opened(path) as file:
        return TdmsFile(
            path,
            tuple(
                TdmsChannel(group.name, channel.name, len(channel), dict(channel.properties))
                for group in file.groups()
                for channel in group.channels()
            ),
        )


def read_kinds(path: Path, channels: Sequence[TdmsChannel]) -> list[Kind]:
    """What the samples of some channels of a file are, scaled as it says; InputError when the file is damaged."""
    with _opened(path) as file:
        return [_kind(file[channel.group][channel.name]) for channel in channels]


def read_samples(path: Path, channels: Sequence[TdmsChannel]) -> list[NDArray[Any]]:
    """The samples (N,) of some channels of a file, scaled as it says; times in seconds from the first on.

    InputError when the file is damaged, or a channel holds no real numbers.
    """
    with _opened(path) as file:
        return [_numbers(file[channel.group][channel.name], f"{path}, {channel.path}") for channel in channels]


def _kind(channel: nptdms.TdmsChannel) -> Kind:
    kind = channel.dtype.kind
    if kind == "M":
        return "times"
    return "numbers" if kind in "fiu" else "others"


def _numbers(channel: nptdms.TdmsChannel, where: str) -> NDArray[Any]:
    if not len(channel):
        return np.empty(0)
    kind = _kind(channel)
    if kind == "times":
        times = np.asarray(channel[:])
        return np.asarray((times - times[0]) / np.timedelta64(1, "s"), dtype=np.float64)
    if kind == "others":
        raise InputError(where, f"holds no real numbers ({channel.dtype})", "name another channel")
    return np.asarray(channel[:])


@contextmanager
def _opened(path: Path) -> Iterator[nptdms.TdmsFile]:
    """A file with its headers read; InputError for whatever is wrong with it, then or when samples are read."""
    check_segments(path)
    try:
        import nptdms
    except ImportError as error:
        raise InputError(
            str(path), "TDMS files are read by npTDMS, which is not installed", "pip install 'vgvt[tdms]'"
        ) from error
    # As a stream: by its path npTDMS would believe an index beside it, which may be of another day.
    try:
        with path.open("rb") as stream, _without_warnings(), nptdms.TdmsFile.open(stream) as file:
            yield file
    except InputError:
        raise
    except Exception as error:  # What npTDMS raises of a damaged file has no common kind.
        raise InputError(str(path), f"damaged ({str(error) or type(error).__name__})", _AGAIN) from error


@contextmanager
def _without_warnings() -> Iterator[None]:
    """ValueError where npTDMS would log a warning and go on with fewer samples, or with some that are not scaled."""
    from nptdms.log import log_manager

    said: list[str] = []

    def keep(record: logging.LogRecord) -> bool:
        if record.name != _HARMLESS:
            said.append(record.getMessage())
        return False

    loggers = list(log_manager.loggers.values())
    for logger in loggers:
        logger.addFilter(keep)
    try:
        yield
    finally:
        for logger in loggers:
            logger.removeFilter(keep)
    if said:
        raise ValueError(said[0])
