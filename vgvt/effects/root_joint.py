"""The root joint that nonlinear effects act on: given to a beam whose root is rigid, kept where there is one.

What several effects say of one joint is one law: cubic stiffness, friction and gaps add.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from vgvt.data import InputError
from vgvt.effects.beams import Side, chosen_beams, on_side, plain_name, with_beams
from vgvt.effects.elements import GivenRoot, JointLaw
from vgvt.scenario.airframe import Beam, mirrored_names
from vgvt.scenario.model import Scenario

__all__ = ["Kind", "RootJoint", "Side", "one_law", "root_joints"]

Kind = Literal["bending", "torsion"]
_FIELD = {
    "bending": "root_bending_stiffness_n_m_per_rad",
    "torsion": "root_torsional_stiffness_n_m_per_rad",
}


@dataclass(frozen=True, slots=True)
class RootJoint:
    """The root joint of one beam (a name after mirroring), its linear stiffness, and what is said of it."""

    beam: str
    stiffness_n_m_per_rad: float
    root: GivenRoot


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
    found = {b.name: getattr(b, _FIELD[kind]) for b in sided.airframe.beam}
    joints = tuple(
        RootJoint(
            copy,
            getattr(table, _FIELD[kind]),
            GivenRoot(effect, spare_stiffness_n_m_per_rad, was_rigid=found[table.name] is None),
        )
        for table in changed.airframe.beam
        if table.name in names
        for copy in mirrored_names(table.name, table.mirror)
    )
    return changed, joints


def one_law(laws: Sequence[JointLaw]) -> JointLaw:
    """What effects make together of one joint, whose stiffness all of them have found, or made.

    InputError where one made it and another would have made it otherwise: which of them acts first must not matter.
    """
    said = [law.root for law in laws if law.root is not None]
    for maker in (root for root in said if root.was_rigid):
        for other in said:
            if other.stiffness_n_m_per_rad != maker.stiffness_n_m_per_rad:
                raise InputError(
                    f"effects {maker.effect} and {other.effect} on beam {laws[0].beam}",
                    f"they give its root, which is rigid in {laws[0].kind}, {maker.stiffness_n_m_per_rad:g} and "
                    f"{other.stiffness_n_m_per_rad:g} N m/rad",
                    "Give both the same root_stiffness_n_m_per_rad, or the beam a root joint of its own: "
                    f"{_FIELD[laws[0].kind]}.",
                )
    return replace(
        laws[0],
        cubic_n_m_per_rad3=sum(law.cubic_n_m_per_rad3 for law in laws),
        friction_n_m=sum(law.friction_n_m for law in laws),
        play_rad=sum(law.play_rad for law in laws),
    )
