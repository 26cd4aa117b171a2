"""The airframe: a rigid centre body, beams by station tables, lumped items and damping.

Aircraft axes: x aft from the nose, y right, z up, metres.
"""

from __future__ import annotations

import difflib
from typing import Any, Self

from pydantic import Field, field_validator, model_validator
from pydantic.json_schema import SkipJsonSchema

from vgvt.scenario.base import Finite, MisfitError, NonNegative, Point, Positive, Switch, Table, Whole

MOST_CELLS = 200
"""Into which a beam can be cut."""


class Body(Table):
    """The rigid centre body; every beam chain ends on it."""

    mass_kg: Positive
    """Mass of the centre body alone."""
    centre_of_gravity_m: Point
    """Its centre of gravity in aircraft axes."""
    inertia_kg_m2: tuple[Positive, Positive, Positive]
    """Ixx, Iyy, Izz about its own centre of gravity."""
    outline_m: tuple[tuple[Finite, Finite], ...] = ()
    """Planform corners (x, y) of the centre body, for drawings and for 'is this point on the aircraft'."""
    carry_through_stiffness_n_m_per_rad: Positive | None = None
    """Torsion spring in the plane of symmetry that joins a right and a left half of the body; left out, it is rigid."""


class Stations(Table):
    """A station table: columns of equal length, from the root to the tip, linear in between.

    Left out columns are constant zero unless their text says otherwise.
    """

    position_m: tuple[Point, ...] = Field(min_length=2)
    """Points of the elastic axis (x, y, z)."""
    bending_stiffness_n_m2: tuple[Positive, ...]
    """EI, out of the plane of the surface (flapwise)."""
    torsional_stiffness_n_m2: tuple[Positive, ...]
    """GJ."""
    in_plane_stiffness_n_m2: tuple[Positive, ...] | None = None
    """EI in the plane of the surface (fore-and-aft for a wing); left out, the beam is rigid in its plane."""
    mass_kg_per_m: tuple[Positive, ...]
    """Mass per length of the axis."""
    pitch_inertia_kg_m: tuple[Positive, ...]
    """Inertia per length about the section's centre of gravity and an axis along the beam."""
    cg_offset_m: tuple[Finite, ...] | None = None
    """Section centre of gravity aft of the elastic axis, at right angles to it."""
    forward_edge_m: tuple[NonNegative, ...] | None = None
    """Leading edge ahead of the elastic axis, at right angles to it; for drawings and point checks."""
    aft_edge_m: tuple[NonNegative, ...] | None = None
    """Trailing edge behind the elastic axis, at right angles to it."""
    air_kg_per_m: tuple[NonNegative, ...] | None = None
    """Air that the section moves with it, per length of the axis: inertia without weight."""
    air_offset_m: tuple[Finite, ...] | None = None
    """Centre of that air aft of the elastic axis, at right angles to it."""
    air_pitch_inertia_kg_m: tuple[NonNegative, ...] | None = None
    """Inertia of that air per length about its centre and an axis along the beam."""

    @model_validator(mode="after")
    def _columns_of_equal_length(self) -> Self:
        rows = len(self.position_m)
        for name in type(self).model_fields:
            column = getattr(self, name)
            if column is not None and len(column) != rows:
                raise MisfitError(
                    (name,), f"has {len(column)} entries but position_m has {rows}", "Give one entry a station."
                )
        for i in range(1, rows):
            if self.position_m[i] == self.position_m[i - 1]:
                raise MisfitError(
                    ("position_m", i),
                    f"is {list(self.position_m[i])} like the station before it",
                    "Give every station a point of its own, from the root to the tip.",
                )
        return self


class Beam(Table):
    """A flexible surface along an elastic axis, cut into cells."""

    name: str
    """Name of the beam; a mirrored beam becomes NAME-right and NAME-left."""
    mirror: Switch = False
    """Build a second one, mirrored in the plane y = 0; the table then describes the right one (y > 0)."""
    parent: str = "body"
    """What the root is fixed to: 'body' or the name of a beam (then at the nearest point of its axis)."""
    cells: Whole = Field(default=12, ge=1, le=MOST_CELLS)
    """Rigid links with a bending and a torsion spring between them, cut where the axis bends and a shaker pushes; more
    cells, more exact and slower."""
    normal: Point = (0.0, 0.0, 1.0)
    """Normal of the surface: the direction of bending."""
    root_bending_stiffness_n_m_per_rad: Positive | None = None
    """Bending spring of the root joint; left out, the root is rigid."""
    root_torsional_stiffness_n_m_per_rad: Positive | None = None
    """Torsion spring of the root joint; left out, the root is rigid."""
    stations: Stations
    """Axis, stiffness, mass and edges along the beam."""

    @model_validator(mode="after")
    def _bends_across_its_axis(self) -> Self:
        axis = zip(self.stations.position_m, self.stations.position_m[1:], strict=False)
        for i, (start, end) in enumerate(axis):
            along = [b - a for a, b in zip(start, end, strict=True)]
            square = sum(c * c for c in along) * sum(c * c for c in self.normal)
            if square - sum(a * n for a, n in zip(along, self.normal, strict=True)) ** 2 <= 1e-4 * square:
                raise MisfitError(
                    ("normal",),
                    f"is {list(self.normal)}, along the axis between position_m[{i}] and position_m[{i + 1}]",
                    "Give the direction that the surface bends in, like [0, 0, 1] for a wing or [0, 1, 0] for a fin.",
                )
        return self

    @model_validator(mode="after")
    def _mirrored_table_is_the_right_one(self) -> Self:
        sides = [point[1] for point in self.stations.position_m]
        if self.mirror and (min(sides) < 0 or max(sides) == 0):
            raise MisfitError(
                ("stations", "position_m"),
                "is not on the right, but mirror = true copies the right beam to the left",
                "Write stations with y > 0, or mirror = false.",
            )
        return self


class Item(Table):
    """A lumped mass: a servo, a flap, a fitting, a winglet."""

    name: str
    """Name of the item; a mirrored item becomes NAME-right and NAME-left."""
    mass_kg: Positive
    """Its mass."""
    position_m: Point
    """Its centre of gravity."""
    inertia_kg_m2: tuple[NonNegative, NonNegative, NonNegative] = (0.0, 0.0, 0.0)
    """Ixx, Iyy, Izz about its own centre of gravity."""
    attached_to: str = "body"
    """'body' or the name of a beam; on a beam the two links around it share it."""
    mirror: Switch = False
    """Add a second one at -y, on the mirrored beam."""

    @model_validator(mode="after")
    def _mirrored_item_is_the_right_one(self) -> Self:
        if self.mirror and self.position_m[1] <= 0:
            raise MisfitError(
                ("position_m",),
                f"is {list(self.position_m)}, but mirror = true copies the right item to the left",
                "Write y > 0, or mirror = false.",
            )
        return self


class Damping(Table):
    """Structural damping of the bare airframe, as modal damping ratios.

    Elastic modes up to ``limit_hz`` get the ratio given for them exactly; above, damping is
    proportional to stiffness and grows with frequency, from ``damping_ratio`` at the limit or from
    less, where a lightly damped mode below the limit leaves no room for it. Beyond three times the
    limit a fine chain has less, so that its highest modes can be stepped.
    """

    damping_ratio: Positive = 0.01
    """Ratio of the modes not named in ``modal``."""
    modal: tuple[Positive, ...] = ()
    """Ratios of the first elastic modes of the bare airframe, in order of frequency."""
    limit_hz: Positive = 60.0
    """Highest frequency with exact modal ratios; every mode below it costs simulation time, and in fine chains up to
    three times it."""

    @model_validator(mode="after")
    def _ratios_below_critical(self) -> Self:
        ratios = {("damping_ratio",): self.damping_ratio} | {("modal", i): r for i, r in enumerate(self.modal)}
        for key, ratio in ratios.items():
            if ratio >= 0.5:
                raise MisfitError(key, f"is {ratio:g}, at or above one half", "Write a fraction: 0.02 for 2 %.")
        return self


class Airframe(Table):
    """Everything that is weighed: the aircraft without instruments."""

    name: str
    """What the aircraft is called in reports."""
    configuration: str = ""
    """Which one of several (centre body 2 + wing set 3, fuel, …), in words."""
    body: Body
    """The rigid centre body."""
    beam: tuple[Beam, ...] = ()
    """The flexible surfaces."""
    item: tuple[Item, ...] = ()
    """The lumped masses."""
    hinged: SkipJsonSchema[tuple[Item, ...]] = ()
    """What effects have hung on hinges of their own: weighed there, and locked where structural damping is found.
    No file can write it: it takes the effect's hinge to weigh it."""
    damping: Damping = Damping()
    """Structural damping."""
    sources: tuple[str, ...] = ()
    """Where the numbers come from."""

    @property
    def beam_names(self) -> tuple[str, ...]:
        """Names after mirroring."""
        return tuple(name for b in self.beam for name in mirrored_names(b.name, b.mirror))

    @model_validator(mode="after")
    def _names_are_known(self) -> Self:
        names = self.beam_names
        for i, beam in enumerate(self.beam):
            if any(names.count(n) > 1 or n == "body" for n in mirrored_names(beam.name, beam.mirror)):
                raise MisfitError(
                    ("beam", i, "name"), f"is {beam.name!r}, which is taken", "Give it a name of its own."
                )
            self.require_part(("beam", i, "parent"), beam.parent, both_sides=beam.mirror)
        for i, item in enumerate(self.item):
            if item.name in (other.name for other in self.item[:i]):
                raise MisfitError(
                    ("item", i, "name"), f"is {item.name!r}, which is taken", "Give it a name of its own."
                )
            self.require_part(("item", i, "attached_to"), item.attached_to, both_sides=item.mirror)
        return self

    @field_validator("hinged", mode="before")
    @classmethod
    def _hinges_are_of_effects(cls, value: Any) -> Any:
        if value:
            raise MisfitError(
                (),
                "has no hinge to hang on, and would weigh nothing",
                "Write [[airframe.item]], and an [[effect]] with name = 'control-surface' and item = the item's name.",
            )
        return value

    @model_validator(mode="after")
    def _beams_end_on_the_body(self) -> Self:
        parents = {name: b.parent for b in self.beam for name in (b.name, *mirrored_names(b.name, b.mirror))}
        for i, beam in enumerate(self.beam):
            chain = [beam.name]
            while chain[-1] != "body":
                if chain[-1] in chain[:-1]:
                    held = " -> ".join(chain)
                    raise MisfitError(("beam", i, "parent"), f"leads in a circle: {held}", "One must be on 'body'.")
                chain.append(parents[chain[-1]])
        return self

    def require_part(self, key: tuple[str | int, ...], name: str, *, both_sides: bool = False) -> None:
        """MisfitError at ``key`` unless ``name`` is 'body' or a beam; for ``both_sides`` not just one copy."""
        plain = ("body", *(b.name for b in self.beam))
        known = tuple(dict.fromkeys((*plain, *self.beam_names)))
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1)
            advice = f"Did you mean {near[0]}?" if near else f"Write one of {', '.join(known)}."
            raise MisfitError(key, f"is {name!r}, which is not a part of the aircraft", advice)
        if both_sides and name not in plain:
            raise MisfitError(key, f"is {name!r}, but there are two copies, one a side", "Write the beam's plain name.")


def mirrored_names(name: str, mirror: bool) -> tuple[str, ...]:
    """The names that a table becomes: itself, or its right and left copies."""
    return (f"{name}-right", f"{name}-left") if mirror else (name,)
