"""Checks that need the assembled aircraft: is everything that is attached to it really on it?"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from vgvt.scenario.explain import Key, Problem
from vgvt.scenario.mirror import part_name
from vgvt.scenario.model import Scenario
from vgvt.scenario.planform import distance_off_m, part_at

EDGE_TOLERANCE_M = 0.03
"""How far outside the planform a sensor may sit: real ones stand on edges, and outlines are drawn by a few corners."""

HOOK_TOLERANCE_M = 0.1
"""The same for the hook, which may stand on a bracket."""

_FOREIGN_UNITS = {"inches": 0.0254, "centimetres": 0.01, "millimetres": 0.001, "feet": 0.3048}


def placement_problems(scenario: Scenario) -> tuple[Problem, ...]:
    """Sensors, shaker and hook that are off the aircraft, each with its distance and the nearest part.

    Parts without an outline are not checked; nor is height, since outlines have none.
    """
    grid, shaker = scenario.accelerometers.grid, scenario.shaker
    problems: list[Problem | None] = []
    heights: Sequence[float] | None = grid.z_m
    for i, node in enumerate(grid.node):
        point = (grid.x_m[i], grid.y_m[i]) if heights is None else (grid.x_m[i], grid.y_m[i], heights[i])
        part = grid.attached_to[i] if grid.attached_to else None
        column: Key = ("accelerometers", "grid", "x_m", i)
        problems.append(_off_the_aircraft(scenario, column, f"sensor point {node}", point, part, EDGE_TOLERANCE_M))
    key: Key = ("shaker", "position_m")
    problems.append(
        _off_the_aircraft(scenario, key, "the drive point", shaker.position_m, shaker.attached_to, EDGE_TOLERANCE_M)
    )
    key = ("suspension", "hook_m")
    problems.append(_off_the_aircraft(scenario, key, "the hook", scenario.suspension.hook_m, None, HOOK_TOLERANCE_M))
    return tuple(p for p in problems if p is not None)


def _off_the_aircraft(
    scenario: Scenario,
    key: Key,
    what: str,
    point: Sequence[float],
    attached_to: str | None,
    tolerance_m: float,
) -> Problem | None:
    airframe = scenario.airframe

    def distance(position: Sequence[float]) -> tuple[float, str]:
        part = part_at(airframe, position) if attached_to is None else part_name(airframe, attached_to, position[1])
        return distance_off_m(airframe, part, position) or 0.0, part

    off, part = distance(point)
    if off <= tolerance_m:
        return None
    place = ", ".join(f"{c:g}" for c in point)
    where = "the aircraft; nearest is" if attached_to is None else "the part it is attached to,"
    return Problem(
        key,
        f"{what} at ({place}) m is {_length(off)} off {where} {part!r}",
        "Write metres: x aft of the nose, y to the right, z up." + _unit_guess(distance, point, tolerance_m),
    )


def _unit_guess(
    distance: Callable[[Sequence[float]], tuple[float, str]], point: Sequence[float], tolerance_m: float
) -> str:
    """A hint where the numbers would be on the aircraft in another unit."""
    for unit, metres in _FOREIGN_UNITS.items():
        if max(abs(c) for c in point[:2]) * metres > tolerance_m and distance([c * metres for c in point])[0] == 0.0:
            inside = ", ".join(f"{c * metres:.4g}" for c in point)
            return f" Were these {unit}? Then write ({inside})."
    return ""


def _length(metres: float) -> str:
    return f"{metres * 1000:.0f} mm" if metres < 1 else f"{metres:.2f} m"
