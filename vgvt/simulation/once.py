"""What the runs of a campaign share: an airframe is cut and damped once, however many rigs it hangs in."""

from __future__ import annotations

from functools import lru_cache

import mujoco

from vgvt.scenario.airframe import Airframe
from vgvt.simulation.airframe import AirframeParts, airframe_spec, cut_airframe
from vgvt.simulation.damping import StructuralDamping, add_structural_damping


@lru_cache(maxsize=4)
def cut_once(airframe: Airframe) -> AirframeParts:
    """The airframe cut into chains. To be read, not changed."""
    return cut_airframe(airframe)


@lru_cache(maxsize=4)
def damped_airframe(airframe: Airframe) -> mujoco.MjSpec:
    """Airframe and structural damping, dear to find. To be copied, not changed."""
    parts = cut_once(airframe)
    spec = airframe_spec(parts)
    add_structural_damping(spec, structural_damping(parts, spec))
    return spec


def structural_damping(parts: AirframeParts, spec: mujoco.MjSpec) -> StructuralDamping:
    """The damping of parts whose specification is ``spec``, before anything was added."""
    locked = spec if not parts.airframe.hinged else airframe_spec(parts.locked)
    return StructuralDamping.of(locked, parts.airframe.damping)
