"""What a sidecar is written from: channels, places and runs, as far as record files state them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from vgvt.data import ChannelRole, Dof
from vgvt.files.axes import Axes


@dataclass(frozen=True, slots=True)
class ProposedChannel:
    """One channel; what the files do not state is empty or None."""

    name: str
    role: ChannelRole
    quantity: str
    """As sidecars spell it."""
    unit: str
    label: str
    """Of the unit, as the file spells it."""
    column: int | None
    """None where it stands at another place in every run, and is to be found by its DOF or by its name."""
    places: tuple[Dof | None, ...]
    """Along aircraft axes, one a run."""
    variable: str = ""
    """The name that it has in every file; empty where it is found by its column or its DOF."""

    @property
    def stays(self) -> bool:
        """True where it has one place in all runs."""
        return len(set(self.places)) == 1

    @property
    def has_places(self) -> bool:
        """True where every run states its place."""
        return None not in self.places


@dataclass(frozen=True, slots=True)
class DescribedRun:
    """One run, and which channels of its file it is made of."""

    path: Path
    file: str
    """Relative to the folder of the records."""
    index: int | None
    """Which run of the file, counted from 1; None where it is the only one."""
    first: int
    """The column of its first channel in the file, counted from 1."""
    last: int
    samples: int
    sample_rate_hz: float | None
    """None where the file does not state it."""
    words: str
    """Where it stands in the file."""


@dataclass(frozen=True, slots=True)
class Kind:
    """What sidecars of a kind of file say in a way of their own."""

    format: Literal["uff", "tdms"]
    columns: str
    """What is counted in a run."""
    axes: str
    """Which axes are guessed, where nobody says."""


@dataclass(frozen=True, slots=True, eq=False)
class Draft:
    """Everything that a sidecar is written from."""

    kind: Kind
    name: str
    band_hz: tuple[float, float] | None
    """None where nothing says what it could be."""
    band_is_guessed: bool
    folder: str
    """Of the files, relative to the sidecar; empty where it is the same."""
    columns: int | None
    """How many channels a run has in its file; None where the number is not the same in all runs."""
    axes: Axes
    axes_are_guessed: bool
    unit_is_guessed: bool
    positions: dict[int, tuple[float, float, float]]
    """By node, in the files' axes and unit."""
    lines: tuple[tuple[int, ...], ...]
    channels: tuple[ProposedChannel, ...]
    runs: tuple[DescribedRun, ...]
    hashes: dict[str, str]
    remarks: tuple[str, ...]
    group: str = ""
    """The one that holds the channels of every run, where files have several."""
    time: str = ""
    """The channel that holds the time axis of every run."""

    @property
    def places(self) -> tuple[Dof, ...]:
        """Every DOF that the channels state, in order of appearance."""
        return tuple(dict.fromkeys(place for c in self.channels for place in c.places if place is not None))


@dataclass(frozen=True, slots=True)
class Description:
    """A sidecar that was written, and what a person should know of it."""

    path: Path
    name: str
    band_hz: tuple[float, float] | None
    channels: tuple[ProposedChannel, ...]
    runs: tuple[DescribedRun, ...]
    missing: tuple[str, ...]
    """What is to be written by hand before it can be read."""
    remarks: tuple[str, ...]
