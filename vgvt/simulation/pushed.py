"""Where shakers push beams: a cell of the chain is to end there, on the beam and on its mirror image."""

from __future__ import annotations

import numpy as np

from vgvt.scenario.airframe import mirrored_names
from vgvt.scenario.mirror import expanded_beams, part_name
from vgvt.scenario.model import Scenario
from vgvt.simulation.airframe import ROOT, Pushed
from vgvt.simulation.stations import StationTable


def pushed_beams(scenario: Scenario) -> Pushed:
    """Where a scenario's shakers push beams as built, then the same places on the other side of mirrored ones.

    So both sides stay alike, but where each has a shaker of its own.
    """
    airframe = scenario.airframe
    beams = {beam.name: beam for beam in expanded_beams(airframe)}
    sides = {name: names for b in airframe.beam for names in [mirrored_names(b.name, b.mirror)] for name in names}
    own: list[tuple[str, float]] = []
    for shaker in scenario.shakers:
        part = part_name(airframe, shaker.attached_to, shaker.position_m[1])
        if part != ROOT:
            own.append((part, StationTable.of(beams[part]).nearest_arc_m(np.array(shaker.position_m))))
    return (*own, *((side, arc) for part, arc in own for side in sides[part] if side != part))
