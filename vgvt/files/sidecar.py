"""The sidecar: a small TOML file that says what measured records mean.

Which files, at which rate, which column is which sensor with which calibration,
where the sensors sat, and in whose axes. The how-to 'Describe your own
records' explains every key.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator, model_validator

from vgvt.data import ChannelRole, Direction, Dof, Quantity
from vgvt.files.axes import Axes
from vgvt.files.sidecar_records import Records, Source
from vgvt.files.strict import Finite, Positive, Table
from vgvt.files.units import QUANTITIES, Sensitivity, unit_in_si

Sha256 = Field(default=None, pattern="^[0-9a-f]{64}$")
_STATED = {"uff": ("dof", "quantity", "unit"), "tdms": ("unit",)}
"""What files of a format may state of a channel, and a sidecar may override."""


class Nodes(Table):
    """Positions: columns of equal length, in the axes and unit of [axes]."""

    node: tuple[int, ...] = Field(min_length=1)
    x: tuple[Finite, ...]
    y: tuple[Finite, ...]
    z: tuple[Finite, ...] | None = None
    """Left out, every point lies at z = 0."""
    lines: tuple[tuple[int, ...], ...] = ()
    """Polylines of node numbers, for drawings."""

    @model_validator(mode="after")
    def _columns_of_equal_length(self) -> Self:
        for name in ("x", "y", "z"):
            column = getattr(self, name)
            if column is not None and len(column) != len(self.node):
                raise ValueError(f"{name} has {len(column)} entries but node has {len(self.node)}; pair them")
        _once("node", self.node)
        unknown = sorted({n for line in self.lines for n in line} - set(self.node))
        if unknown:
            raise ValueError(f"lines name nodes without a position: {unknown}; add them to node, x and y")
        return self

    @property
    def table(self) -> NDArray[np.float64]:
        """Positions (P, 3) as written."""
        return np.column_stack([self.x, self.y, self.z or np.zeros(len(self.node))])


class ChannelRow(Table):
    """One column of a record."""

    name: str
    quantity: str
    role: ChannelRole
    column: int = Field(default=1, ge=1)
    """Counted from 1; of a Universal File the time history of the run, found by its DOF where this is left out; of
    TDMS the channel of the group."""
    variable: str = ""
    """The variable or array of this channel where it is not records.samples; of a Universal File the DOF it states;
    of TDMS the channel's name, or its path like \"/'group'/'channel'\"."""
    sensitivity: str | None = None
    """Volts per unit at the converter, like '10 mV/g'; the file then holds volts."""
    gain: Positive = 1.0
    """Of a conditioner, where the sensitivity does not include it."""
    unit: str | None = None
    """The unit of the samples where the file holds physical units already."""
    range_v: Positive | None = None
    """Full scale of the converter; samples that reach it are reported as clipped. For files that hold volts."""
    dof: str | None = None
    """Node and direction in aircraft axes, like '100+Z', of a sensor that stays."""
    direction: str | None = None
    """Direction, like '+Z', of a sensor that moves; the runs say to which node."""
    overrides: tuple[Literal["dof", "quantity", "unit"], ...] = ()
    """What the sidecar states against a Universal File that is wrong about it; of TDMS the unit alone."""

    @field_validator("quantity")
    @classmethod
    def _known_quantity(cls, value: str) -> str:
        if value not in QUANTITIES:
            raise ValueError(f"{value!r} is not a quantity; choose one of: {', '.join(QUANTITIES)}")
        return value

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if (self.sensitivity is None) == (self.unit is None):
            raise ValueError(
                "give either sensitivity (the file holds volts) or unit (the file holds physical units); "
                "like sensitivity = '10 mV/g' or unit = 'N'"
            )
        _ = self.v_per_si, self.si_per_sample
        if self.range_v is not None and self.unit is not None and self.kind is not Quantity.GENERAL:
            raise ValueError(
                f"range_v is in volts, but unit = {self.unit!r} says that the file holds none; leave range_v out, or "
                "give the sensitivity in place of unit where the file does hold volts"
            )
        if self.role is ChannelRole.DRIVE:
            return self
        if (self.dof is None) == (self.direction is None):
            raise ValueError(
                "give either dof (a sensor that stays) or direction (one that moves); like dof = '100+Z' or "
                "direction = '+Z'"
            )
        if self.dof is not None:
            Dof.from_label(self.dof)
        else:
            Direction.from_label(str(self.direction))
        return self

    @property
    def kind(self) -> Quantity:
        """The quantity as the rest of the program knows it."""
        return QUANTITIES[self.quantity]

    @property
    def has_column(self) -> bool:
        """True where the sidecar states the column."""
        return "column" in self.model_fields_set

    @property
    def v_per_si(self) -> float:
        """Volts per SI unit, conditioner included; 1 where the file holds physical units."""
        if self.sensitivity is None:
            return 1.0
        return Sensitivity.from_text(self.sensitivity).v_per_si(self.kind) * self.gain

    @property
    def si_per_sample(self) -> float:
        """Factor from the numbers in the file to SI."""
        return 1 / self.v_per_si if self.unit is None else unit_in_si(self.kind, self.unit)

    @property
    def v_per_sample(self) -> float:
        """Volts per number in the file, where it holds volts."""
        return 1.0 if self.unit is None else self.si_per_sample


class RunRow(Table):
    """One run: its file and where the moving sensors sat."""

    run: int
    file: str
    sha256: str | None = Sha256
    index: int | None = Field(default=None, ge=1)
    """Which run of a file that holds several, along the first axis of its arrays, one behind the other or, in TDMS, one
    a group; from 1."""
    sample_rate_hz: Positive | None = None
    """Where it differs from the other runs."""
    nodes: dict[str, int | str] = Field(default_factory=dict)
    """Channel name to node number, or to a full label like '12-Z' where a sensor was turned."""
    names: dict[str, str] = Field(default_factory=dict)
    """Channel name to what the channel is called in this run, where that is another name."""
    overloaded: tuple[str, ...] = ()
    """Channels that are known to have clipped, beside those that reach their range_v."""
    notes: tuple[str, ...] = ()

    def called(self, channel: ChannelRow) -> str:
        """The name of a channel in this run."""
        return self.names.get(channel.name, channel.name)


class Sidecar(Table):
    """A measured campaign, described."""

    name: str
    summary: str = ""
    band_hz: tuple[Positive, Positive]
    """The excited band."""
    traps: tuple[str, ...] = ()
    """What is known to be wrong in other descriptions of these records."""
    notes: dict[str, str] = Field(default_factory=dict)
    source: Source | None = None
    records: Records
    axes: Axes = Axes()
    nodes: Nodes
    outline_m: tuple[tuple[tuple[Finite, Finite, Finite], ...], ...] = ()
    """Closed polylines of the planform for drawings, in aircraft axes and metres."""
    channel: tuple[ChannelRow, ...] = Field(min_length=1)
    run: tuple[RunRow, ...] = Field(min_length=1)

    @field_validator("band_hz")
    @classmethod
    def _rising(cls, value: tuple[float, float]) -> tuple[float, float]:
        if not value[0] < value[1]:
            raise ValueError(f"{list(value)} does not increase; write band_hz = [lowest, highest]")
        return value

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        _once("channel.name", (c.name for c in self.channel))
        _once("run.run", (r.run for r in self.run))
        for channel in self.channel:
            self._check_place(channel)
        self._check_columns()
        self._check_files()
        for run in self.run:
            if run.index is not None:
                self._check_index(run)
            self._check_names(run)
            self._check_run(run)
        return self

    def _check_place(self, channel: ChannelRow) -> None:
        if self.records.format in ("mat", "npz") and not (channel.variable or self.records.samples):
            raise ValueError(f"channel {channel.name!r} has no variable; name it there or as records.samples")
        stated = _STATED.get(self.records.format, ())
        unstated = [what for what in channel.overrides if what not in stated]
        if unstated:
            raise ValueError(
                f"channel {channel.name!r}: a file of format {self.records.format} states no {unstated[0]} that could "
                "be overridden; leave it out of overrides"
            )
        if not stated:
            return
        if channel.variable and channel.has_column:
            raise ValueError(f"channel {channel.name!r} has a column and a variable; leave one of them out")
        if self.records.format == "tdms":
            return
        if channel.variable:
            Dof.from_label(channel.variable)
        elif not channel.has_column and (channel.role is ChannelRole.DRIVE or "dof" in channel.overrides):
            raise ValueError(
                f"channel {channel.name!r} cannot be found by its DOF in a Universal File; give its column"
            )

    def _check_index(self, run: RunRow) -> None:
        if self.records.format == "uff" and self.records.columns is None:
            raise ValueError(
                f"run {run.run} is one of several in a Universal File, and nothing says how many time histories "
                "a run has; write columns = ... in [records]"
            )
        placed = any(channel.variable.startswith("/'") for channel in self.channel)
        if self.records.format == "tdms" and (self.records.samples or placed):
            raise ValueError(
                f"run {run.run} is the group of that index, and another group is named; "
                "leave samples out of [records], and name channels without their group"
            )

    def _check_files(self) -> None:
        taken: dict[tuple[str, int | None], int] = {}
        for run in self.run:
            other = taken.setdefault((run.file, run.index), run.run)
            if other != run.run:
                row = "" if run.index is None else f", index {run.index}"
                raise ValueError(
                    f"runs {other} and {run.run} are the same record ({run.file}{row}), and it would count twice; "
                    "correct the file of one, or say by index which run of the file each is"
                )

    def _check_columns(self) -> None:
        taken: dict[tuple[str, int], str] = {}
        for channel in self.channel:
            if self.records.format == "uff" and not (channel.variable or channel.has_column):
                continue  # found by its DOF, which is compared run by run
            named = channel.variable or ("" if self.records.format in ("csv", "tdms") else self.records.samples)
            place = (named, channel.column)
            if place in taken:
                of = f" of {place[0]!r}" if place[0] else ""
                raise ValueError(
                    f"channels {taken[place]!r} and {channel.name!r} are both column {channel.column}{of}; "
                    "correct the column of one, or its variable"
                )
            taken[place] = channel.name

    def _check_names(self, run: RunRow) -> None:
        known = [channel.name for channel in self.channel]
        for key, names in (("names", run.names), ("overloaded", run.overloaded)):
            strangers = sorted(set(names) - set(known))
            if strangers:
                raise ValueError(
                    f"run {run.run}: {key} has {', '.join(map(repr, strangers))}; the channels are {', '.join(known)}"
                )
        _once(f"run {run.run}: names", (run.called(channel) for channel in self.channel))

    def _check_run(self, run: RunRow) -> None:
        moving = {c.name for c in self.channel if c.direction is not None}
        unknown, unplaced = sorted(set(run.nodes) - moving), sorted(moving - set(run.nodes))
        if unknown:
            raise ValueError(f"run {run.run}: nodes names {unknown}; the channels that move are {sorted(moving)}")
        if unplaced:
            raise ValueError(f"run {run.run}: no node for {', '.join(unplaced)}; add nodes = {{ {unplaced[0]} = 1 }}")
        taken: dict[tuple[ChannelRole, Dof], str] = {}
        for channel in self.channel:
            dof = self.dof(channel, run)
            if dof is None:
                continue
            if dof.node not in self.nodes.node:
                raise ValueError(
                    f"run {run.run}: {channel.name} is at node {dof.node}, which has no position; add it to [nodes]"
                )
            # Opposite directions are one degree of freedom, with its sign changed.
            other = taken.setdefault((channel.role, dof.unsigned), channel.name)
            if other != channel.name:
                raise ValueError(
                    f"run {run.run}: {other} and {channel.name} are both {channel.role.value}s at {dof.unsigned}, and "
                    "their average would be taken; correct the node or direction of one, or leave a channel out"
                )

    def dof(self, channel: ChannelRow, run: RunRow) -> Dof | None:
        """Where a channel measured in a run; None for the drive signal."""
        if channel.dof is not None:
            return Dof.from_label(channel.dof)
        if channel.direction is None:
            return None
        place = run.nodes[channel.name]
        return Dof.from_label(place) if isinstance(place, str) else Dof(place, Direction.from_label(channel.direction))


def _once(what: str, values: Iterable[object]) -> None:
    listed = list(values)
    twice = sorted({str(v) for v in listed if listed.count(v) > 1})
    if twice:
        raise ValueError(f"{what} must be unique; write each once, and not twice: {', '.join(twice)}")
