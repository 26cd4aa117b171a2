"""The root joint that nonlinear effects act on: given to a beam whose root is rigid, kept where there is one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from vgvt.data import InputError
from vgvt.data.suggestion import choose_one_of
from vgvt.scenario.airframe import Beam, mirrored_names
from vgvt.scenario.model import Scenario

Kind = Literal["bending", "torsion"]
Side = Literal["both", "right", "left"]
_FIELD = {
    "bending": "root_bending_stiffness_n_m_per_rad",
    "torsion": "root_torsional_stiffness_n_m_per_rad",
}


@dataclass(frozen=True, slots=True)
class RootJoints:
    """A scenario in which a beam has root joints, the names of the beam's copies, and the joints' stiffness."""

    scenario: Scenario
    beams: tuple[str, ...]
    stiffness_n_m_per_rad: float


def root_joints(
    scenario: Scenario, beam: str, side: Side, kind: Kind, spare_stiffness_n_m_per_rad: float
) -> RootJoints:
    """The root joints of a beam: its own, or for a rigid root new ones of the spare stiffness.

    ``beam`` is a plain name, or '' for the first beam. New joints are on both sides of a
    mirrored beam; ``side`` chooses the copies that are named. InputError for an unknown beam.
    """
    airframe = scenario.airframe
    chosen = _chosen(scenario, beam)
    names = mirrored_names(chosen.name, chosen.mirror)
    if chosen.mirror and side != "both":
        names = (names[0 if side == "right" else 1],)
    stiffness = getattr(chosen, _FIELD[kind])
    if stiffness is not None:
        return RootJoints(scenario, names, stiffness)
    jointed = chosen.model_copy(update={_FIELD[kind]: spare_stiffness_n_m_per_rad})
    beams = tuple(jointed if b is chosen else b for b in airframe.beam)
    changed = scenario.model_copy(update={"airframe": airframe.model_copy(update={"beam": beams})})
    return RootJoints(changed, names, spare_stiffness_n_m_per_rad)


def _chosen(scenario: Scenario, name: str) -> Beam:
    beams = {b.name: b for b in scenario.airframe.beam}
    if not beams:
        raise InputError(f"scenario {scenario.name}", "the airframe has no beam to joint", "Leave the effect out.")
    if name and name not in beams:
        where = f"scenario {scenario.name}: effect.beam"
        raise InputError(where, f"there is no beam {name!r}", choose_one_of(name, tuple(beams)))
    return beams[name] if name else next(iter(beams.values()))
