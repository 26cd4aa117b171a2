"""Mirrored tables written out: what a scenario says once for two wings becomes two beams."""

from __future__ import annotations

from vgvt.scenario.airframe import Airframe, Beam, Item, mirrored_names
from vgvt.scenario.base import Point
from vgvt.scenario.recent import Recent


def expanded_beams(airframe: Airframe) -> tuple[Beam, ...]:
    """Every beam as built, in the order of the tables, right copy before left.

    A table with ``mirror`` becomes NAME-right as written and NAME-left with y
    negated; their parents are the names of expanded beams or 'body'.
    """
    return _beams_recently(airframe)


def expanded_items(airframe: Airframe) -> tuple[Item, ...]:
    """Every lumped item as built; ``attached_to`` names expanded beams or 'body'."""
    return _items_recently(airframe)


def part_name(airframe: Airframe, name: str, y_m: float) -> str:
    """The expanded name of a part: a mirrored beam's plain name means the copy on the side of ``y_m``."""
    if any(b.mirror and b.name == name for b in airframe.beam):
        return mirrored_names(name, True)[0 if y_m >= 0 else 1]
    return name


def other_side(name: str) -> str | None:
    """The name of the other copy of a mirrored table, from that of one; None for a name that is neither's."""
    for side, other in (("-right", "-left"), ("-left", "-right")):
        if name.endswith(side):
            return name.removesuffix(side) + other
    return None


def mirrored_point(point: Point) -> Point:
    """The point on the other side of the plane y = 0."""
    return (point[0], 0.0 - point[1], point[2])


def _beam_copies(airframe: Airframe, beam: Beam) -> tuple[Beam, ...]:
    root_y = beam.stations.position_m[0][1]
    if not beam.mirror:
        parent = part_name(airframe, beam.parent, root_y)
        return (beam if parent == beam.parent else beam.model_copy(update={"parent": parent}),)
    right, left = mirrored_names(beam.name, True)
    stations = beam.stations.model_copy(
        update={"position_m": tuple(mirrored_point(p) for p in beam.stations.position_m)}
    )
    return (
        beam.model_copy(update={"name": right, "mirror": False, "parent": part_name(airframe, beam.parent, 1.0)}),
        beam.model_copy(
            update={
                "name": left,
                "mirror": False,
                "parent": part_name(airframe, beam.parent, -1.0),
                "normal": mirrored_point(beam.normal),
                "stations": stations,
            }
        ),
    )


def _item_copies(airframe: Airframe, item: Item) -> tuple[Item, ...]:
    if not item.mirror:
        part = part_name(airframe, item.attached_to, item.position_m[1])
        return (item if part == item.attached_to else item.model_copy(update={"attached_to": part}),)
    right, left = mirrored_names(item.name, True)
    return (
        item.model_copy(
            update={"name": right, "mirror": False, "attached_to": part_name(airframe, item.attached_to, 1.0)}
        ),
        item.model_copy(
            update={
                "name": left,
                "mirror": False,
                "attached_to": part_name(airframe, item.attached_to, -1.0),
                "position_m": mirrored_point(item.position_m),
            }
        ),
    )


def _all_beams(airframe: Airframe) -> tuple[Beam, ...]:
    return tuple(copy for beam in airframe.beam for copy in _beam_copies(airframe, beam))


def _all_items(airframe: Airframe) -> tuple[Item, ...]:
    return tuple(copy for item in airframe.item for copy in _item_copies(airframe, item))


# Whatever cuts, weighs or edits an airframe asks for them, each of the same one.
_beams_recently: Recent[Airframe, tuple[Beam, ...]] = Recent(_all_beams)
_items_recently: Recent[Airframe, tuple[Item, ...]] = Recent(_all_items)
