"""Checks that need the assembled aircraft: is everything that is attached to it really on it?"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.airframe import Airframe
from vgvt.scenario.base import MisfitError
from vgvt.scenario.explain import Key, Problem
from vgvt.scenario.instruments import Grid
from vgvt.scenario.mirror import expanded_beams, expanded_items, part_name
from vgvt.scenario.model import Scenario
from vgvt.scenario.planform import chord_m, distance_off_m, outlines_m, part_at
from vgvt.scenario.rig import Shaker, Suspension

EDGE_TOLERANCE_M = 0.03
"""How far outside the planform a sensor may sit: real ones stand on edges, and outlines are drawn by a few corners."""

HOOK_TOLERANCE_M = 0.1
"""The same for the hook, which may stand on a bracket."""

BOX_MARGIN = 0.25
"""A part without outline may reach beyond the box of all that is described by this share of its longest side."""

LEAST_BOX_MARGIN_M = 0.2
"""The same margin for a box that is small."""

_FOREIGN_UNITS = {"inches": 0.0254, "centimetres": 0.01, "millimetres": 0.001, "feet": 0.3048}


def scenario_placement_problems(scenario: Scenario) -> tuple[Problem, ...]:
    """All that a scenario attaches to its aircraft and that is off it: sensors, every shaker, the hook."""
    grid = scenario.accelerometers.grid
    return placement_problems(scenario.airframe, grid, scenario.shaker, scenario.suspension, scenario.further_shaker)


def placement_problems(
    airframe: Airframe,
    grid: Grid | None,
    shaker: Shaker | None,
    suspension: Suspension | None,
    further_shakers: Sequence[Shaker | None] = (),
) -> tuple[Problem, ...]:
    """Sensors, shakers, hook that are off the aircraft, each with its distance and the nearest part; None is skipped.

    Points on an outline are held to it in plan, since outlines have no height; points on a part
    without one are held to the box of all that is described, and a margin.
    """
    problems: list[Problem | None] = []
    if grid is not None:
        problems += [_sensor_problem(airframe, grid, i) for i in range(len(grid.node))]
    problems.append(_shaker_problem(airframe, ("shaker",), shaker))
    problems += [_shaker_problem(airframe, ("further_shaker", i), further) for i, further in enumerate(further_shakers)]
    if suspension is not None:
        key: Key = ("suspension", "hook_m")
        problems.append(_off_the_aircraft(airframe, key, "the hook", suspension.hook_m, None, HOOK_TOLERANCE_M))
    return tuple(p for p in problems if p is not None)


def place_problem(airframe: Airframe, key: Key, what: str, point: Sequence[float]) -> Problem | None:
    """A problem for what is tied to a part from more than the part's chord away: (x, y) of a payload that is not there.

    Parts without outline are held to the box, as sensors are; the body, which has no chord, to a hook's tolerance.
    """
    tolerance = max(HOOK_TOLERANCE_M, chord_m(airframe, part_at(airframe, point)))
    return _off_the_aircraft(airframe, key, what, point, None, tolerance)


def aircraft_box_m(airframe: Airframe) -> NDArray[np.float64]:
    """Lowest and highest (x, y, z) of all that an airframe describes, shape (2, 3).

    That is axes and edges of the beams, items, and outline and centre of gravity of the body.
    """
    points = [
        np.array([airframe.body.centre_of_gravity_m, *(item.position_m for item in expanded_items(airframe))]),
        *(np.array(beam.stations.position_m) for beam in expanded_beams(airframe)),
        *outlines_m(airframe),
    ]
    every = np.vstack(points)
    return np.array([every.min(axis=0), every.max(axis=0)])


def _sensor_problem(airframe: Airframe, grid: Grid, i: int) -> Problem | None:
    point = (grid.x_m[i], grid.y_m[i]) if grid.z_m is None else (grid.x_m[i], grid.y_m[i], grid.z_m[i])
    part = grid.attached_to[i] if grid.attached_to else None
    at: Key = ("accelerometers", "grid")
    return _unknown_part(airframe, (*at, "attached_to", i), part) or _off_the_aircraft(
        airframe, (*at, "x_m", i), f"sensor point {grid.node[i]}", point, part, EDGE_TOLERANCE_M
    )


def _shaker_problem(airframe: Airframe, at: Key, shaker: Shaker | None) -> Problem | None:
    if shaker is None:
        return None
    point, part = shaker.position_m, shaker.attached_to
    return _unknown_part(airframe, (*at, "attached_to"), part) or _off_the_aircraft(
        airframe, (*at, "position_m"), "the drive point", point, part, EDGE_TOLERANCE_M
    )


def _unknown_part(airframe: Airframe, key: Key, part: str | None) -> Problem | None:
    try:
        if part is not None:
            airframe.require_part(key, part)
    except MisfitError as error:
        return Problem(error.key, error.problem, error.advice)
    return None


def _off_the_aircraft(
    airframe: Airframe,
    key: Key,
    what: str,
    point: Sequence[float],
    attached_to: str | None,
    tolerance_m: float,
) -> Problem | None:
    def place_of(position: Sequence[float], margin_m: float = 0.0) -> tuple[float, str, bool]:
        part = part_at(airframe, position) if attached_to is None else part_name(airframe, attached_to, position[1])
        off = distance_off_m(airframe, part, position)
        return (_beyond_box_m(box, position, margin_m), part, False) if off is None else (off, part, True)

    box = aircraft_box_m(airframe)
    off, part, outlined = place_of(point, _margin_m(box))
    if off <= tolerance_m:
        return None
    place = ", ".join(f"{c:g}" for c in point)
    where = "the aircraft; nearest is" if attached_to is None else "the part it is attached to,"
    advice = "Write metres: x aft of the nose, y to the right, z up."
    if not outlined:
        where, advice = "the aircraft; it would be on", f"{advice} {_box_advice(box, part)}"
    if off > _longest_side_m(box):
        advice += _unit_guess(lambda position: place_of(position)[0], point, tolerance_m)
    return Problem(key, f"{what} at ({place}) m is {_length(off)} off {where} {part!r}", advice)


def _longest_side_m(box: NDArray[np.float64]) -> float:
    return float((box[1] - box[0]).max())


def _margin_m(box: NDArray[np.float64]) -> float:
    return max(BOX_MARGIN * _longest_side_m(box), LEAST_BOX_MARGIN_M)


def _beyond_box_m(box: NDArray[np.float64], position_m: Sequence[float], margin_m: float) -> float:
    """Distance of a point from a box, where that is more than the margin; 0 within it."""
    (low, high), point = box[:, : len(position_m)], np.array(position_m, dtype=float)
    beyond = float(np.linalg.norm(np.maximum(np.maximum(low - point, point - high), 0.0)))
    return beyond if beyond > margin_m else 0.0


def _box_advice(box: NDArray[np.float64], part: str) -> str:
    sides = ", ".join(f"{axis} {low:.3g} to {high:.3g}" for axis, low, high in zip("xyz", *box.tolist(), strict=True))
    outline = "outline_m in [airframe.body]" if part == "body" else "forward_edge_m and aft_edge_m in its stations"
    return (
        f"All that is described lies in {sides}, and {_length(_margin_m(box))} beyond are allowed for {part!r}, "
        f"which has no outline; if it reaches further, give it {outline}."
    )


def _unit_guess(distance: Callable[[Sequence[float]], float], point: Sequence[float], tolerance_m: float) -> str:
    """A hint where the numbers would be on the aircraft in another unit."""
    for unit, metres in _FOREIGN_UNITS.items():
        if max(abs(c) for c in point[:2]) * metres > tolerance_m and distance([c * metres for c in point]) == 0.0:
            inside = ", ".join(f"{c * metres:.4g}" for c in point)
            return f" Were these {unit}? Then write ({inside})."
    return ""


def _length(metres: float) -> str:
    return f"{metres * 1000:.0f} mm" if metres < 1 else f"{metres:.2f} m"
