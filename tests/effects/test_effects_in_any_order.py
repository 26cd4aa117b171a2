"""An aircraft does not know in which order a scenario lists what is wrong with it."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest
from effect_rig import effect_rig

from vgvt.effects.acting import Turn, acted
from vgvt.effects.action import Action
from vgvt.scenario import Scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import truth_of
from vgvt.simulation.assembly import Rig, driven_rig, plans
from vgvt.simulation.linear import joint_force

TABLES = (
    EffectTable(name="viscoelastic-stiffness", rise=0.2),
    EffectTable(name="hysteretic-damping", loss_factor=0.05),
    EffectTable(name="bend-twist-coupling", coupling=0.2),
    EffectTable(name="cable-bundle", stiffness_n_per_m=50.0, damping_n_s_per_m=0.4),
    EffectTable(name="entrained-air", mass_fraction=1.0, drag_n_s_per_m3=1.0),
    EffectTable(name="section-cg-offset", offset_m=0.01, pitch_inertia_change=0.1),
    EffectTable(name="suspension-surge", mass_kg=0.5),
    EffectTable(name="suspension-stiffness", stiffness_change=0.2),
    EffectTable(name="hook-offset", right_m=0.02),
    EffectTable(name="root-compliance", bending=0.05, torsion=0.05),
    EffectTable(name="stiffness-asymmetry", bending=0.1, torsion=0.05),
    EffectTable(name="cubic-root-stiffness", cubic_n_m_per_rad3=1e7),
    EffectTable(name="root-friction", kind="bending", friction_n_m=0.2),
    EffectTable(name="root-freeplay", kind="bending", gap_rad=2e-3),
)
BY_NAME = {table.name: table for table in TABLES}
PLAY = "root-freeplay"


def with_effects(*names: str) -> Scenario:
    return effect_rig().model_copy(update={"effect": tuple(BY_NAME[name] for name in names)})


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("viscoelastic-stiffness", "bend-twist-coupling"),
        ("hysteretic-damping", "viscoelastic-stiffness"),
        ("hysteretic-damping", "cable-bundle"),
        ("entrained-air", "section-cg-offset"),
        ("root-compliance", "stiffness-asymmetry"),
        ("suspension-surge", "suspension-stiffness"),
        ("suspension-surge", "hook-offset"),
    ],
)
def test_two_effects_are_one_aircraft(one: str, other: str) -> None:
    """Which came first had moved natural frequencies by up to 0.4 %, and those of a surging spring by 9 %."""
    # Stiffness is a difference of forces, good to 1e-9.
    modes, turned = (truth_of(with_effects(*names)).as_tested[0] for names in ((one, other), (other, one)))
    np.testing.assert_allclose(turned.natural_frequency_hz, modes.natural_frequency_hz, rtol=1e-8)
    np.testing.assert_allclose(turned.damping_ratio, modes.damping_ratio, rtol=1e-6, atol=1e-9)
    alone = truth_of(with_effects(one)).as_tested[0]
    assert np.abs(alone.natural_frequency_hz[:8] / modes.natural_frequency_hz[:8] - 1).max() > 1e-5


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("root-compliance", "cubic-root-stiffness"),
        ("root-compliance", PLAY),
        ("stiffness-asymmetry", "root-friction"),
        ("cubic-root-stiffness", "root-friction"),
        ("cubic-root-stiffness", PLAY),
        ("root-friction", PLAY),
    ],
)
def test_laws_of_a_joint_are_one_law(one: str, other: str) -> None:
    """The force of every joint wherever it is, and what holds it by friction."""
    rig, turned = (driven_rig(plans(with_effects(*names))[0], 0) for names in ((one, other), (other, one)))
    np.testing.assert_allclose(turned.qpos, rig.qpos, atol=1e-10)
    for amount in (3e-4, 3e-3):
        np.testing.assert_allclose(forces(turned, amount), forces(rig, amount), rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(turned.model.dof_frictionloss, rig.model.dof_frictionloss)
    # And each of them is still in it.
    for name in (one, other):
        alone = driven_rig(plans(with_effects(name))[0], 0)
        same = alone.model.nq == rig.model.nq and np.allclose(forces(alone, 3e-3), forces(rig, 3e-3), rtol=1e-6)
        assert not (same and np.array_equal(alone.model.dof_frictionloss, rig.model.dof_frictionloss))


def forces(rig: Rig, amount: float) -> Any:
    """Forces of all joints, each moved by up to an amount."""
    data = mujoco.MjData(rig.model)
    data.qpos[:] = rig.qpos + amount * np.random.default_rng(1).uniform(-1, 1, rig.model.nq)
    return joint_force(rig.model, data)


def test_effects_act_in_their_turn_and_are_told_in_their_order() -> None:
    """One without a turn acts first; within a turn they keep their order."""
    seen: list[str] = []

    class Noted:
        def __init__(self, name: str, turn: Turn | None = None) -> None:
            self.name = name
            if turn is not None:
                self.turn = turn

        def act(self, scenario: Any, run: int) -> Action:
            seen.append(f"{self.name}{run} of {scenario}")
            changed: Any = f"{scenario}+{self.name}" if self.name != "d" else None
            return Action(scenario=changed)

    effects: Any = [Noted("a", Turn.IN_JOINTS), Noted("b"), Noted("c", Turn.AT_ROOTS), Noted("d", Turn.STATED)]
    stated: Any = "stated"
    changed, actions = acted(effects, stated, 2, lambda effect, scenario, run: effect.act(scenario, run))
    assert seen == ["b2 of stated", "d2 of stated+b", "c2 of stated+b", "a2 of stated+b+c"]
    assert [a.scenario for a in actions] == ["stated+b+c+a", "stated+b", "stated+b+c", None]
    assert changed == "stated+b+c+a"


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (EffectTable(name="suspension-hardening", hardening=0.5), BY_NAME["suspension-stiffness"]),
        (EffectTable(name="mount-lift-off", stiffness_loss=0.5), EffectTable(name="transducer-mass", mass_kg=0.05)),
        (EffectTable(name="shaker-backlash", gap_m=1e-4), EffectTable(name="transducer-mass", mass_kg=0.05)),
    ],
)
def test_what_is_in_the_rig_is_made_for_the_rig_that_is_there(one: EffectTable, other: EffectTable) -> None:
    """A law that a truth, linear about rest, does not know."""

    def elements(*tables: EffectTable) -> Any:
        plan = plans(effect_rig().model_copy(update={"effect": tables}))[0]
        return sorted(repr(e) for a in plan.actions for e in a.elements)

    assert elements(one, other) == elements(other, one) != elements(one)
