"""The wing moves air with it: mass that no scale shows, and a little drag."""

from __future__ import annotations

import dataclasses
import math
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.beams import chosen_beams, copies_of, with_beams, with_columns
from vgvt.effects.elements import Element, GroundSpring, Vector
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.airframe import Beam, Stations
from vgvt.scenario.axis import beam_axis
from vgvt.scenario.mirror import expanded_beams
from vgvt.scenario.model import Scenario

AIR_KG_PER_M3 = 1.225
"""Standard atmosphere at sea level."""
_AIR = ("air_kg_per_m", "air_offset_m", "air_pitch_inertia_kg_m")
# Columns are linear between stations and c² is not: where a chord changes by this share of itself from one to the next,
# a straight line holds a sixth of its square too much, 1.5e-4 of the air. Next to a point it may be a share of more.
_CHORD_STEP = 0.03
_POINTED = 0.1


@dataclasses.dataclass(frozen=True, slots=True)
class EntrainedAir:
    """A flat plate of chord c moves ¼πρc² of air a length at its mid-chord, with ρπc⁴/128 of pitch inertia.

    It is inertia without weight beside the section tables, which have stations in between for it where a chord tapers:
    exact for motion out of the plane; in the plane, which is rigid here, there are a few grams too much of it. Drag is
    a dashpot for each area of wing.
    """

    name: ClassVar[str] = "entrained-air"
    summary: ClassVar[str] = "The wing carries air along: added mass and drag"
    family: ClassVar[Family] = Family.AIRFRAME
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "all bending frequencies 1 to 4 % low and low modes better damped than high ones"
    confused_with: ClassVar[tuple[str, ...]] = ("added-mass", "suspension-damping", "nonproportional-damper")
    separating_test: ClassVar[str] = "weigh the aircraft: air has no weight; a vacuum chamber, for those who have one"
    reference: ClassVar[str] = (
        "Theodorsen, NACA report 496, 1935 (apparent mass); Blevins, Formulas for Natural Frequency, 1979"
    )

    mass_fraction: float = parameter(
        "",
        0.3,
        1.2,
        "added mass as a fraction of ¼πρc²",
        neutral=0.0,
        source="1 for a plate of high aspect ratio",
        least=0.0,
    )
    drag_n_s_per_m3: float = parameter(
        "N s/m^3", 0.05, 5.0, "drag force per normal speed and per area of wing", neutral=0.0, scale="log"
    )
    beam: str = dataclasses.field(default="", metadata={"doc": "a beam; '' for all on the body that have edges"})

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add the air to the sections and dashpots along the axis of mid-chord, in every run."""
        del run
        if self.mass_fraction == self.drag_n_s_per_m3 == 0:
            return NOTHING
        names = chosen_beams(scenario.airframe, self.beam, self.name)
        edged = [b.name for b in scenario.airframe.beam if b.name in names and _has_edges(b.stations)]
        if not edged:
            raise InputError(
                f"effect {self.name}: beam",
                "no chosen beam has edges, so nobody knows its chord",
                "Give its stations forward_edge_m and aft_edge_m.",
            )
        copies = copies_of(scenario.airframe, edged)
        beams = [b for b in expanded_beams(scenario.airframe) if b.name in copies]
        dashpots = tuple(e for b in beams for e in self._dashpots(b)) if self.drag_n_s_per_m3 > 0 else ()
        if self.mass_fraction == 0:
            return Action(elements=dashpots)
        return Action(with_beams(scenario, edged, self._with_air), dashpots)

    def _with_air(self, beam: Beam) -> Beam:
        beam = _finer(beam)
        stations, density = beam.stations, self.mass_fraction * math.pi * AIR_KG_PER_M3
        chord, middle = chord_m(stations), mid_chord_m(stations)
        plate, turning = density * chord**2 / 4, density * chord**4 / 128
        stated, offset, pitch = (_column(stations, name) for name in _AIR)
        air = stated + plate
        # Where there is none at all its centre is anywhere.
        together = np.divide(stated * offset + plate * middle, air, out=middle.copy(), where=air > 0)
        steiner = stated * (offset - together) ** 2 + plate * (middle - together) ** 2
        return with_columns(beam, **dict(zip(_AIR, (air, together, pitch + turning + steiner), strict=True)))

    def _dashpots(self, beam: Beam) -> list[Element]:
        """One in the middle of each of as many equal pieces as the beam has cells, with its area."""
        axis, stations = beam_axis(beam), beam.stations
        length = float(axis.arc_length_m[-1])
        found: list[Element] = []
        for arc in (np.arange(beam.cells) + 0.5) * length / beam.cells:
            segment = min(int(np.searchsorted(axis.arc_length_m, arc)) - 1, len(axis.tangent) - 1)
            along = (arc - axis.arc_length_m[segment]) * axis.tangent[segment]
            aft = np.interp(arc, axis.arc_length_m, mid_chord_m(stations)) * axis.aft[segment]
            area = length / beam.cells * float(np.interp(arc, axis.arc_length_m, chord_m(stations)))
            place, normal = _vector(axis.position_m[segment] + along + aft), _vector(axis.normal[segment])
            damper = self.drag_n_s_per_m3 * area
            found.append(GroundSpring(beam.name, place, 0.0, damper, normal, owner="airframe", turns_with_part=True))
        return found


# A fit asks for the air of the same beams at hundreds of sizes: cutting them is most of the work.
@lru_cache(maxsize=64)
def _finer(beam: Beam) -> Beam:
    """The same beam with stations in between, so many that the chord changes by small steps."""
    chord = chord_m(beam.stations)
    smaller, larger = np.minimum(chord[:-1], chord[1:]), np.maximum(chord[:-1], chord[1:])
    step = _CHORD_STEP * np.maximum(np.maximum(smaller, _POINTED * larger), np.finfo(float).tiny)
    # Rounding must not cut once more what is fine enough already.
    pieces = np.ceil(np.abs(np.diff(chord)) / step - 1e-9).astype(int).clip(1)
    rows = np.concatenate([*(i + np.arange(n) / n for i, n in enumerate(pieces)), [len(chord) - 1.0]])
    stated = np.arange(len(chord))

    def column(values: NDArray[np.float64]) -> tuple[float, ...]:
        return tuple(float(v) for v in np.interp(rows, stated, values))

    columns: dict[str, object] = {}
    for name in type(beam.stations).model_fields:
        values = getattr(beam.stations, name)
        if name == "position_m":
            columns[name] = tuple(zip(*(column(along) for along in np.array(values).T), strict=True))
        elif values is not None:
            columns[name] = column(np.array(values))
    return beam.model_copy(update={"stations": beam.stations.model_copy(update=columns)})


def chord_m(stations: Stations) -> NDArray[np.float64]:
    """Chord at right angles to the axis at the stations, shape (N,)."""
    forward, aft = _edges(stations)
    return forward + aft


def mid_chord_m(stations: Stations) -> NDArray[np.float64]:
    """Mid-chord aft of the axis at the stations, shape (N,)."""
    forward, aft = _edges(stations)
    return (aft - forward) / 2


def _column(stations: Stations, name: str) -> NDArray[np.float64]:
    values = getattr(stations, name)
    return np.zeros(len(stations.position_m)) if values is None else np.array(values)


def _edges(stations: Stations) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return _column(stations, "forward_edge_m"), _column(stations, "aft_edge_m")


def _has_edges(stations: Stations) -> bool:
    return stations.forward_edge_m is not None or stations.aft_edge_m is not None


def _vector(values: NDArray[np.float64]) -> Vector:
    x, y, z = (float(v) for v in values)
    return (x, y, z)
