"""What the runs of a campaign share: an airframe is cut and damped once, however many rigs it hangs in.

A fit asks for thousands of airframes, and for the rigs of each within moments: what is recent is known again by being
the same object, as telling that two of its size are equal takes longer than a copy.
"""

from __future__ import annotations

from functools import lru_cache, partial

import mujoco

from vgvt.scenario.airframe import Airframe
from vgvt.scenario.recent import Recent
from vgvt.simulation.airframe import AirframeParts, Pushed, airframe_spec, cut_airframe, hinge_name
from vgvt.simulation.damping import StructuralDamping, add_structural_damping
from vgvt.simulation.halves import CARRY_THROUGH


@lru_cache(maxsize=4)
def cut_once(airframe: Airframe, pushed: Pushed = ()) -> AirframeParts:
    """The airframe cut into chains, whose cells end where they are ``pushed``. To be read, not changed."""
    return cut_airframe(airframe, pushed)


def damped_airframe(airframe: Airframe, pushed: Pushed = ()) -> mujoco.MjSpec:
    """Airframe and structural damping, dear to find. To be copied, not changed."""
    return _damped_once(airframe, pushed)[0]


def damping_once(airframe: Airframe, pushed: Pushed = ()) -> StructuralDamping:
    """The structural damping of :func:`damped_airframe`."""
    return _damped_once(airframe, pushed)[1]


@lru_cache(maxsize=4)
def _damped_once(airframe: Airframe, pushed: Pushed) -> tuple[mujoco.MjSpec, StructuralDamping]:
    parts = cut_once(airframe, pushed)
    spec = airframe_spec(parts)
    damping = structural_damping(parts, spec)
    add_structural_damping(spec, damping)
    return spec, damping


def _with_dampers(parts: AirframeParts) -> tuple[mujoco.MjSpec, StructuralDamping]:
    spec = airframe_spec(parts)
    damped = structural_damping(parts, spec)
    damped.damp_joints(spec)
    return spec, damped


@lru_cache(maxsize=8)
def cut_recently(pushed: Pushed) -> Recent[Airframe, AirframeParts]:
    """What cuts an airframe into chains, once for the same object, so that cells end where they are ``pushed``."""
    return Recent(partial(cut_airframe, pushed=pushed))


_damped_recently: Recent[AirframeParts, tuple[mujoco.MjSpec, StructuralDamping]] = Recent(_with_dampers)


def with_damped_joints(parts: AirframeParts) -> tuple[mujoco.MjSpec, StructuralDamping]:
    """The bare airframe, the caller's own, with its joints' dampers; and its damping, whose modes are left to others.

    Differences of forces would ask for rows of the modes' dampers over and over.
    """
    spec, damped = _damped_recently(parts)
    return spec.copy(), damped


def structural_damping(parts: AirframeParts, spec: mujoco.MjSpec) -> StructuralDamping:
    """The damping of parts whose specification is ``spec``, before anything was added."""
    locked = spec if not parts.airframe.hinged else airframe_spec(parts.locked)
    return StructuralDamping.of(locked, parts.airframe.damping, _connecting(parts))


def _connecting(parts: AirframeParts) -> tuple[str, ...]:
    """Names of the joints that are no cells of a beam: at roots, and between the halves of the body."""
    # Alone a root's link begins where its beam does, and ends there.
    roots = (link for chain in parts.chains.values() for link in chain.links[:1] if link.twist_arc_m == 0)
    hinges = tuple(hinge_name(link, hinge) for link in roots for hinge in link.hinges)
    return (*((CARRY_THROUGH,) if parts.halved else ()), *hinges)
