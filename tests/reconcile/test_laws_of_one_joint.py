"""What several effects say of one joint is one law, whichever comes first: the last one had counted alone."""

from __future__ import annotations

import pytest
from effect_rig import effect_rig

from vgvt.reconcile.mechanics.joints import joint_laws
from vgvt.scenario.effect import EffectTable
from vgvt.simulation.assembly import plans
from vgvt.simulation.reduced import structure

CUBIC = EffectTable(name="cubic-root-stiffness", cubic_n_m_per_rad3=1e7, kind="bending", side="right")
FRICTION = EffectTable(name="root-friction", friction_n_m=0.2, kind="bending", side="right")
PLAY = EffectTable(name="root-freeplay", gap_rad=2e-3, kind="bending", side="right")


@pytest.mark.parametrize("tables", [(CUBIC, FRICTION, PLAY), (PLAY, FRICTION, CUBIC)])
def test_laws_of_one_joint_are_one(tables: tuple[EffectTable, ...]) -> None:
    (layout,) = plans(effect_rig().model_copy(update={"effect": tables}))
    (law,) = joint_laws(layout, structure(layout, layout.grid)).values()
    assert (law.cubic, law.friction, law.play) == (1e7, 0.2, 1e-3)
    assert law.stiffness > 0
