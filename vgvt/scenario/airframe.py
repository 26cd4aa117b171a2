"""The airframe: a rigid centre body, beams by station tables, lumped items and damping.

Aircraft axes: x aft from the nose, y right, z up, metres.
"""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from vgvt.scenario.base import Finite, NonNegative, Point, Positive, Table


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
    pitch_inertia_kg_m: tuple[NonNegative, ...]
    """Inertia per length about the section's centre of gravity and an axis along the beam."""
    cg_offset_m: tuple[Finite, ...] | None = None
    """Section centre of gravity aft of the elastic axis, at right angles to it."""
    forward_edge_m: tuple[NonNegative, ...] | None = None
    """Leading edge ahead of the elastic axis, at right angles to it; for drawings and point checks."""
    aft_edge_m: tuple[NonNegative, ...] | None = None
    """Trailing edge behind the elastic axis, at right angles to it."""

    @model_validator(mode="after")
    def _columns_of_equal_length(self) -> Self:
        rows = len(self.position_m)
        for name in type(self).model_fields:
            column = getattr(self, name)
            if column is not None and len(column) != rows:
                raise ValueError(
                    f"column {name} has {len(column)} entries but position_m has {rows}; give one entry a station"
                )
        for i in range(1, rows):
            if self.position_m[i] == self.position_m[i - 1]:
                raise ValueError(f"stations {i} and {i + 1} are at the same point {self.position_m[i]}")
        return self


class Beam(Table):
    """A flexible surface along an elastic axis, cut into cells."""

    name: str
    """Name of the beam; a mirrored beam becomes NAME-right and NAME-left."""
    mirror: bool = False
    """Build a second one, mirrored in the plane y = 0; the table then describes the right one (y > 0)."""
    parent: str = "body"
    """What the root is fixed to: 'body' or the name of a beam (then at the nearest point of its axis)."""
    cells: int = Field(default=12, ge=1, le=200)
    """Rigid links with a bending and a torsion spring between them; more cells, more exact and slower."""
    normal: Point = (0.0, 0.0, 1.0)
    """Normal of the surface: the direction of bending."""
    root_bending_stiffness_n_m_per_rad: Positive | None = None
    """Bending spring of the root joint; left out, the root is rigid."""
    root_torsional_stiffness_n_m_per_rad: Positive | None = None
    """Torsion spring of the root joint; left out, the root is rigid."""
    stations: Stations


class Item(Table):
    """A lumped mass: a servo, a flap, a fitting, a winglet."""

    name: str
    mass_kg: Positive
    position_m: Point
    """Its centre of gravity."""
    inertia_kg_m2: tuple[NonNegative, NonNegative, NonNegative] = (0.0, 0.0, 0.0)
    """Ixx, Iyy, Izz about its own centre of gravity."""
    attached_to: str = "body"
    """'body' or the name of a beam; on a beam it rides on the nearest link."""
    mirror: bool = False
    """Add a second one at -y, on the mirrored beam."""


class Damping(Table):
    """Structural damping of the bare airframe, as modal damping ratios.

    Elastic modes up to ``limit_hz`` get the ratio given for them exactly; above,
    stiffness-proportional damping takes over and grows with frequency.
    """

    damping_ratio: Positive = 0.01
    """Ratio of the modes not named in ``modal``."""
    modal: tuple[Positive, ...] = ()
    """Ratios of the first elastic modes of the bare airframe, in order of frequency."""
    limit_hz: Positive = 60.0
    """Highest frequency with exact modal ratios."""

    @model_validator(mode="after")
    def _ratios_below_critical(self) -> Self:
        if max((self.damping_ratio, *self.modal)) >= 0.5:
            raise ValueError("damping ratios are fractions of critical below 0.5; write 0.02 for 2 %")
        return self


class Airframe(Table):
    """Everything that is weighed: the aircraft without instruments."""

    name: str
    configuration: str = ""
    """Which one of several (centre body 2 + wing set 3, fuel, …), in words."""
    body: Body
    beam: tuple[Beam, ...] = ()
    item: tuple[Item, ...] = ()
    damping: Damping = Damping()
    sources: tuple[str, ...] = ()
    """Where the numbers come from."""

    @property
    def beam_names(self) -> tuple[str, ...]:
        """Names after mirroring."""
        return tuple(name for b in self.beam for name in mirrored_names(b.name, b.mirror))

    @model_validator(mode="after")
    def _names_are_known(self) -> Self:
        names = self.beam_names
        for name in names:
            if names.count(name) > 1 or name == "body":
                raise ValueError(f"beam name {name!r} is taken; every beam needs a name of its own")
        known = ("body", *names, *(b.name for b in self.beam if b.mirror))
        for beam in self.beam:
            if beam.parent not in known or beam.parent == beam.name:
                raise ValueError(f"beam {beam.name!r}: parent {beam.parent!r} is not one of {', '.join(known)}")
        for item in self.item:
            if item.attached_to not in known:
                raise ValueError(
                    f"item {item.name!r}: attached_to {item.attached_to!r} is not one of {', '.join(known)}"
                )
        return self


def mirrored_names(name: str, mirror: bool) -> tuple[str, ...]:
    """The names that a table becomes: itself, or its right and left copies."""
    return (f"{name}-right", f"{name}-left") if mirror else (name,)
