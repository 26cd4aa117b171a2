"""The root joint that nonlinear effects act on: given to a beam whose root is rigid, kept where there is one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from vgvt.data import InputError
from vgvt.effects.beams import Side, chosen_beams, on_side, plain_name, with_beams
from vgvt.scenario.airframe import Beam, mirrored_names
from vgvt.scenario.model import Scenario

__all__ = ["Kind", "RootJoint", "Side", "root_joints"]

Kind = Literal["bending", "torsion"]
_FIELD = {
    "bending": "root_bending_stiffness_n_m_per_rad",
    "torsion": "root_torsional_stiffness_n_m_per_rad",
}


@dataclass(frozen=True, slots=True)
class RootJoint:
    """The root joint of one beam (a name after mirroring), and its linear stiffness."""

    beam: str
    stiffness_n_m_per_rad: float


def root_joints(
    scenario: Scenario, beam: str, side: Side, kind: Kind, spare_stiffness_n_m_per_rad: float, effect: str
) -> tuple[Scenario, tuple[RootJoint, ...]]:
    """The scenario with root joints at a beam, and these: its own, or for a rigid root new ones of the spare stiffness.

    ``beam`` is the name of a table, a plain name, or '' for the first beam. One ``side`` alone is
    jointed: the root of the other stays as it is. InputError, naming the ``effect``, for an unknown
    beam or a side without one.
    """
    airframe = scenario.airframe
    if not airframe.beam:
        where = f"scenario {scenario.name}: effect {effect}"
        raise InputError(where, "the airframe has no beam to joint", "Leave the effect out.")
    names = chosen_beams(airframe, beam or plain_name(airframe.beam[0].name), effect)

    def jointed(table: Beam) -> Beam:
        if getattr(table, _FIELD[kind]) is not None:
            return table
        return table.model_copy(update={_FIELD[kind]: spare_stiffness_n_m_per_rad})

    sided, names = on_side(scenario, names, side, effect)
    changed = with_beams(sided, names, jointed)
    joints = tuple(
        RootJoint(copy, getattr(table, _FIELD[kind]))
        for table in changed.airframe.beam
        if table.name in names
        for copy in mirrored_names(table.name, table.mirror)
    )
    return changed, joints
