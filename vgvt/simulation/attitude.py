"""How the aircraft hangs: roll and pitch at rest, which a mass on one side shows before any mode does."""

from __future__ import annotations

import numpy as np

from vgvt.scenario.model import Scenario
from vgvt.simulation.assembly import hung_rig, plans


def attitudes_deg(scenario: Scenario) -> tuple[tuple[float, float], ...]:
    """Roll (left wing down is positive) and pitch (nose up is positive), degrees, of the hung aircraft in every run."""
    found = []
    for run, layout in enumerate(plans(scenario)):
        rig = hung_rig(layout, run)
        roll, pitch = (float(rig.qpos[rig.model.joint(name).qposadr[0]]) for name in ("roll", "pitch"))
        found.append((float(np.degrees(roll)), float(np.degrees(pitch))))
    return tuple(found)
