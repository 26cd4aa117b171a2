"""Effects that give one joint a law: what they say adds, and they may not give a rigid root two stiffnesses."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from effect_rig import effect_rig
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.effects.beams import with_beams
from vgvt.reconcile.mechanics.joints import joint_laws
from vgvt.scenario import Scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import truth_of
from vgvt.simulation.assembly import driven_rig, plans
from vgvt.simulation.linear import joint_force
from vgvt.simulation.reduced import structure

RIGHT, LEFT = "wing-right-root/bending", "wing-left-root/bending"
OWN = {"root_bending_stiffness_n_m_per_rad": 1500.0}


def play(gap_rad: float, side: str = "both", **more: object) -> EffectTable:
    return EffectTable(name="root-freeplay", kind="bending", gap_rad=gap_rad, side=side, **more)


def cubic(**more: object) -> EffectTable:
    return EffectTable(name="cubic-root-stiffness", cubic_n_m_per_rad3=1e7, **more)


def friction(**more: object) -> EffectTable:
    return EffectTable(name="root-friction", friction_n_m=0.2, **more)


def with_effects(*tables: EffectTable, scenario: Scenario | None = None) -> Scenario:
    return (scenario or effect_rig()).model_copy(update={"effect": tables})


def torque(scenario: Scenario, joint: str, angle_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """What a joint's own law pulls back with at angles (A,), N m."""
    model = driven_rig(plans(scenario)[0], 0).model
    data = mujoco.MjData(model)
    model.opt.gravity[:] = 0.0
    found = np.zeros(angle_rad.size)
    for k, angle in enumerate(angle_rad):
        # Its own share: what is left when the springs of all else are where they were.
        data.qpos[:] = 0.0
        rest = joint_force(model, data)[model.joint(joint).dofadr[0]]
        data.qpos[model.joint(joint).qposadr[0]] = angle
        found[k] = rest - joint_force(model, data)[model.joint(joint).dofadr[0]]
    return found


@pytest.mark.parametrize("turned", [False, True])
def test_gaps_of_one_joint_add(turned: bool) -> None:
    """1 mrad on both sides and 2 mrad more on the right: 3 mrad there, and no second spring beside the first."""
    tables = (play(1e-3), play(2e-3, "right"), cubic())
    scenario = with_effects(*(reversed(tables) if turned else tables))
    angle = np.array([-4e-3, -1.4e-3, 0.3e-3, 1.4e-3, 2.5e-3])
    for joint, half in ((RIGHT, 1.5e-3), (LEFT, 0.5e-3)):
        beyond = np.sign(angle) * np.maximum(np.abs(angle) - half, 0.0)
        np.testing.assert_allclose(torque(scenario, joint, angle), 2000.0 * beyond + 1e7 * beyond**3, atol=1e-3)


def test_a_fit_has_the_same_sum() -> None:
    """It had taken the larger gap for both."""
    (layout,) = plans(with_effects(play(1e-3), play(2e-3, "right")))
    laws = sorted(law.play for law in joint_laws(layout, structure(layout, layout.grid)).values())
    assert laws == pytest.approx([0.5e-3, 1.5e-3])


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    "tables",
    [
        (cubic(), friction(root_stiffness_n_m_per_rad=500.0)),
        (play(1e-3), friction(root_stiffness_n_m_per_rad=500.0, side="left")),
        (cubic(root_stiffness_n_m_per_rad=900.0), cubic(root_stiffness_n_m_per_rad=901.0)),
    ],
)
def test_two_stiffnesses_of_a_rigid_root_are_refused(tables: tuple[EffectTable, ...], turned: bool) -> None:
    """Whichever stood first had its own, 7.07 Hz or 6.35, and the other was not heard."""
    scenario = with_effects(*(reversed(tables) if turned else tables))
    with pytest.raises(InputError, match=r"wing-(right|left)") as refused:
        truth_of(scenario)
    with pytest.raises(InputError):
        structure(plans(scenario)[0], ())
    for word in (*(t.name for t in tables), "root_stiffness_n_m_per_rad", *OWN):
        assert word in str(refused.value)


def test_what_they_agree_on_or_the_scenario_says_stands() -> None:
    """And so does one stiffness on the right, another on the left."""
    for tables in (
        (cubic(root_stiffness_n_m_per_rad=500.0), friction(root_stiffness_n_m_per_rad=500.0)),
        (cubic(side="right"), friction(side="left", root_stiffness_n_m_per_rad=500.0)),
    ):
        assert driven_rig(plans(with_effects(*tables))[0], 0).model.nq > 0
    jointed = with_beams(effect_rig(), ("wing",), lambda b: b.model_copy(update=OWN))
    model = driven_rig(
        plans(with_effects(cubic(), friction(root_stiffness_n_m_per_rad=500.0), scenario=jointed))[0], 0
    ).model
    assert model.joint(RIGHT).stiffness[0] == 1500.0
