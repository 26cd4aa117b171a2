"""The root joint that nonlinear effects act on: given to a beam whose root is rigid, kept where there is one.

What several effects say of one joint is one law: cubic stiffness, friction and gaps add.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from vgvt.data import InputError
from vgvt.effects.action import Action
from vgvt.effects.beams import Side, chosen_beams, on_side, plain_name, with_beams
from vgvt.effects.elements import GivenRoot, JointLaw
from vgvt.scenario.airframe import Beam, mirrored_names
from vgvt.scenario.model import Scenario

__all__ = ["Kind", "RootJoint", "Side", "one_law", "require_one_stiffness", "root_joints"]

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


def require_one_stiffness(actions: Sequence[Action]) -> None:
    """InputError where what effects do to one run gives a rigid root two stiffnesses.

    For those that a scenario states: which of its tables comes first must not matter. Not asked of hypotheses, of
    which each has a stiffness to be fitted: there the first one's stands.
    """
    said: dict[tuple[str, Kind], list[GivenRoot]] = {}
    for law in (e for action in actions for e in action.elements if isinstance(e, JointLaw)):
        if law.root is not None:
            said.setdefault((law.beam, law.kind), []).append(law.root)
    for (beam, kind), roots in said.items():
        for maker in (root for root in roots if root.was_rigid):
            for other in roots:
                if other.stiffness_n_m_per_rad != maker.stiffness_n_m_per_rad:
                    raise InputError(
                        f"effects {maker.effect} and {other.effect} on beam {beam}",
                        f"they give its root, which is rigid in {kind}, {maker.stiffness_n_m_per_rad:g} and "
                        f"{other.stiffness_n_m_per_rad:g} N m/rad",
                        "Give both the same root_stiffness_n_m_per_rad, or the beam a root joint of its own: "
                        f"{_FIELD[kind]}.",
                    )


def one_law(laws: Sequence[JointLaw]) -> JointLaw:
    """What effects make together of one joint, whose stiffness is what the first of them has found, or made."""
    return replace(
        laws[0],
        cubic_n_m_per_rad3=sum(law.cubic_n_m_per_rad3 for law in laws),
        friction_n_m=sum(law.friction_n_m for law in laws),
        play_rad=sum(law.play_rad for law in laws),
    )
