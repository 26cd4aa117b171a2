"""What the runs of a campaign share: an airframe is cut and damped once, however many rigs it hangs in."""

from __future__ import annotations

from functools import lru_cache

import mujoco

from vgvt.scenario.airframe import Airframe
from vgvt.simulation.airframe import AirframeParts, airframe_spec, cut_airframe
from vgvt.simulation.damping import add_structural_damping


@lru_cache(maxsize=4)
def cut_once(airframe: Airframe) -> AirframeParts:
    """The airframe cut into chains. To be read, not changed."""
    return cut_airframe(airframe)


@lru_cache(maxsize=4)
def damped_airframe(airframe: Airframe) -> mujoco.MjSpec:
    """Airframe and structural damping, dear to find. To be copied, not changed."""
    spec = airframe_spec(cut_once(airframe))
    add_structural_damping(spec, airframe.damping)
    return spec
