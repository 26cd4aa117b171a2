"""Where the accelerometers sit: the grid's columns as points on parts of the aircraft."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from vgvt.data import Direction, Dof
from vgvt.scenario.airframe import Airframe
from vgvt.scenario.base import Point
from vgvt.scenario.instruments import Grid
from vgvt.scenario.mirror import part_name
from vgvt.scenario.model import Scenario
from vgvt.scenario.planform import part_at, planform_of, surface_height_m


@dataclass(frozen=True, slots=True)
class SensorPoint:
    """A place for an accelerometer: its DOF, the part that it is on (a name after mirroring), and its position.

    The position is in aircraft axes.
    """

    dof: Dof
    part: str
    position_m: Point


def sensor_points(scenario: Scenario) -> tuple[SensorPoint, ...]:
    """The points of the grid in its order; what the scenario leaves out is taken from the planform."""
    return _points(planform_of(scenario.airframe), scenario.accelerometers.grid)


@lru_cache(maxsize=64)
def _points(airframe: Airframe, grid: Grid) -> tuple[SensorPoint, ...]:
    points = []
    for k, node in enumerate(grid.node):
        x, y = grid.x_m[k], grid.y_m[k]
        height = grid.z_m[k] if grid.z_m is not None else 0.0
        stated = grid.attached_to[k] if grid.attached_to is not None else part_at(airframe, (x, y, height))
        part = part_name(airframe, stated, y)
        if grid.z_m is None:
            height = surface_height_m(airframe, part, x, y)
        direction = Direction.from_label(grid.direction[k] if grid.direction is not None else "+Z")
        points.append(SensorPoint(Dof(node, direction), part, (x, y, height)))
    return tuple(points)
