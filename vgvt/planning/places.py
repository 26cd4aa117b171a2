"""Where a shaker or an accelerometer could go: a lattice over the horizontal surfaces of the aircraft."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vgvt.scenario import (
    Airframe,
    Scenario,
    beam_axis,
    edge_lines_m,
    expanded_beams,
    outlines_m,
    part_at,
    sensor_points,
    surface_height_m,
)
from vgvt.scenario.planform import distance_off_m

_SENSOR_SPAN = (0.06, 0.19, 0.32, 0.45, 0.58, 0.71, 0.84, 0.97)
_SENSOR_CHORD = (0.08, 0.92)
_SHAKER_SPAN = (0.08, 0.25, 0.42, 0.59, 0.76, 0.93)
_SHAKER_CHORD = (0.15, 0.85)
_BODY = ((0.15, 0.5, 0.85), (0.1, 0.3, 0.5, 0.7, 0.9))  # fractions of its box, along x and across
_HORIZONTAL = 0.7
_APART = 1 / 40  # of the largest extent of the airframe: two sensors nearer than this tell the same


@dataclass(frozen=True, slots=True)
class Place:
    """A point on a part of the aircraft, aircraft axes; ``node`` is its number, 0 while it has none."""

    position_m: tuple[float, float, float]
    part: str
    node: int = 0
    direction: str = "+Z"


def sensor_places(scenario: Scenario) -> tuple[Place, ...]:
    """The grid of a scenario and, between its points, the lattice; new places get numbers of their own."""
    grid = tuple(
        Place((float(p.position_m[0]), float(p.position_m[1]), float(p.position_m[2])), p.part, p.dof.node, label)
        for p, label in zip(
            sensor_points(scenario), scenario.accelerometers.grid.direction or _all_up(scenario), strict=True
        )
    )
    apart = _APART * _extent_m(scenario.airframe)
    drives = {s.node for s in scenario.shakers}
    places = list(grid)
    number = max(scenario.accelerometers.grid.node)
    for place in _lattice(scenario.airframe, _SENSOR_SPAN, _SENSOR_CHORD):
        if all(np.linalg.norm(np.subtract(place.position_m, p.position_m)) >= apart for p in places):
            number = next(n for n in range(number + 1, number + 2 + len(drives)) if n not in drives)
            places.append(Place(place.position_m, place.part, number))
    return tuple(places)


def shaker_places(scenario: Scenario) -> tuple[Place, ...]:
    """The scenario's own drive point, then the lattice; of a mirrored aircraft the right half."""
    shaker = scenario.shaker
    own = Place(shaker.position_m, shaker.attached_to, shaker.node)
    mirrored = any(beam.mirror for beam in scenario.airframe.beam)
    found = [
        Place(p.position_m, p.part, shaker.node)
        for p in _lattice(scenario.airframe, _SHAKER_SPAN, _SHAKER_CHORD)
        if not mirrored or p.position_m[1] >= -1e-9
    ]
    return (own, *found)


def with_places(scenario: Scenario, places: Sequence[Place], runs: Sequence[Sequence[int]]) -> Scenario:
    """The scenario with accelerometers at other places, in these runs of nodes."""
    grid: dict[str, Any] = {
        "node": tuple(p.node for p in places),
        "x_m": tuple(round(p.position_m[0], 4) for p in places),
        "y_m": tuple(round(p.position_m[1], 4) for p in places),
        "z_m": tuple(round(p.position_m[2], 4) for p in places),
        "direction": tuple(p.direction for p in places),
        "attached_to": tuple(p.part for p in places),
    }
    sensors, acquisition = scenario.accelerometers, scenario.acquisition
    return scenario.model_copy(
        update={
            "accelerometers": sensors.model_copy(update={"grid": sensors.grid.model_copy(update=grid)}),
            "acquisition": acquisition.model_copy(update={"runs": tuple(tuple(run) for run in runs), "levels": None}),
        }
    )


def with_shaker_at(scenario: Scenario, place: Place) -> Scenario:
    """The scenario with its shaker at another place."""
    x, y, z = (round(c, 4) for c in place.position_m)
    shaker = scenario.shaker.model_copy(update={"position_m": (x, y, z), "attached_to": place.part})
    return scenario.model_copy(update={"shaker": shaker})


def _all_up(scenario: Scenario) -> tuple[str, ...]:
    return ("+Z",) * len(scenario.accelerometers.grid.node)


def _extent_m(airframe: Airframe) -> float:
    points = [np.array(beam.stations.position_m) for beam in expanded_beams(airframe)]
    points += [*outlines_m(airframe), np.array([airframe.body.centre_of_gravity_m])]
    return float(np.ptp(np.vstack(points), axis=0).max())


def _lattice(airframe: Airframe, spans: Sequence[float], chords: Sequence[float]) -> Iterator[Place]:
    """Points of the body, then of every horizontal beam, that are on the part they are meant for."""
    for x, y in _body_points(airframe):
        if part_at(airframe, (x, y)) == "body":
            yield Place((x, y, surface_height_m(airframe, "body", x, y)), "body")
    for beam in expanded_beams(airframe):
        axis, (forward, aft) = beam_axis(beam), edge_lines_m(beam)
        if np.abs(axis.normal[:, 2]).min() < _HORIZONTAL:
            continue
        wide = bool(np.linalg.norm(aft - forward, axis=1).max() > 0)
        for span in spans:
            arc = span * axis.arc_length_m[-1]
            edges = [np.array([np.interp(arc, axis.arc_length_m, e[:, k]) for k in range(3)]) for e in (forward, aft)]
            for chord in chords if wide else (0.5,):
                point = edges[0] + chord * (edges[1] - edges[0])
                yield Place((float(point[0]), float(point[1]), float(point[2])), beam.name)


def _body_points(airframe: Airframe) -> Iterator[tuple[float, float]]:
    if len(airframe.body.outline_m) < 3:
        return
    outline = np.array(airframe.body.outline_m)
    low, size = outline.min(axis=0), np.ptp(outline, axis=0)
    for along in _BODY[0]:
        for across in _BODY[1]:
            point = low + size * (along, across)
            if distance_off_m(airframe, "body", (float(point[0]), float(point[1]))) == 0:
                yield float(point[0]), float(point[1])
