"""Where shakers push beams: a cell of the chain is to end there, on the beam and on its mirror image."""

from __future__ import annotations

import numpy as np

from vgvt.scenario.airframe import Beam
from vgvt.scenario.mirror import expanded_beams, mirrored_point, other_side, part_name
from vgvt.scenario.model import Scenario
from vgvt.simulation.airframe import ROOT, Pushed
from vgvt.simulation.stations import StationTable


def pushed_beams(scenario: Scenario) -> Pushed:
    """Where a scenario's shakers push beams as built, then the same places on the other side of mirrored ones.

    So both sides stay alike, but where each has a shaker of its own. A mirrored table and the two tables that it is
    written out to are one aircraft: sides are told by names and places, not by what a table says.
    """
    airframe = scenario.airframe
    beams = {beam.name: beam for beam in expanded_beams(airframe)}
    own: list[tuple[str, float]] = []
    for shaker in scenario.shakers:
        part = part_name(airframe, shaker.attached_to, shaker.position_m[1])
        if part != ROOT:
            own.append((part, StationTable.of(beams[part]).nearest_arc_m(np.array(shaker.position_m))))
    return (*own, *((side, arc) for part, arc in own for side in _other_side(beams, part)))


def _other_side(beams: dict[str, Beam], name: str) -> tuple[str, ...]:
    """The beam whose stations lie as those of the named one do on the other side of the aircraft; none where none."""
    other = beams.get(other_side(name) or "")
    if other is None:
        return ()
    mirrored = tuple(map(mirrored_point, beams[name].stations.position_m))
    return (other.name,) if mirrored == tuple(map(tuple, other.stations.position_m)) else ()
