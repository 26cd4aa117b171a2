"""Several things may give between shaker and aircraft at once: they are in series, in whichever order they are told."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from effect_rig import FREQUENCY_HZ, clear_error, effect_rig, having, largest_error, responses

from vgvt.scenario import Scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import simulated_campaign, truth_of
from vgvt.simulation.assembly import driven_rig, plans
from vgvt.simulation.effect_conformance import ENGINES_AGREE, example_scenario
from vgvt.simulation.reduced import structure
from vgvt.simulation.state_space import state_space

CLAY = EffectTable(name="mount-compliance", compliance_m_per_n=1e-4)
GLUE = EffectTable(name="mount-compliance", compliance_m_per_n=2e-7, loss_factor=0.05)
CREPT = EffectTable(name="mount-creep", compliance_m_per_n=2.5e-4, shape="step")
LIFTING = EffectTable(name="mount-lift-off", stiffness_loss=0.5)
PLAY = EffectTable(name="shaker-backlash", gap_m=1e-4)
GIVING = (CLAY, GLUE, CREPT, LIFTING, PLAY)


def two_runs(*tables: EffectTable) -> Scenario:
    """The rig to try effects on with these, its run made twice: what creeps has crept in the second."""
    rig = effect_rig()
    acquisition = rig.acquisition.model_copy(update={"runs": rig.acquisition.run_nodes * 2})
    return rig.model_copy(update={"effect": tables, "acquisition": acquisition})


@pytest.mark.parametrize(("one", "other"), [*itertools.combinations(GIVING, 2)])
def test_any_two_are_one_stable_rig_in_either_order(one: EffectTable, other: EffectTable) -> None:
    """A mass matrix without an inverse had let none of them through, or some with poles that grow."""
    layouts = [plans(two_runs(*tables))[1] for tables in ((one, other), (other, one))]
    models = [state_space(layout, driven_rig(layout, 1), layout.run_points(1)) for layout in layouts]
    poles = [np.linalg.eigvals(m.state_matrix) for m in models]
    assert max(p.real.max() for p in poles) < 0
    # The aircraft's own, and not those that hang on how many digits a ratio of masses leaves.
    slow = [np.sort_complex(p[np.abs(p) < 2 * np.pi * 50]) for p in poles]
    np.testing.assert_allclose(*slow, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("tables", [(CLAY, GLUE), (CLAY, LIFTING), (PLAY, LIFTING), (CLAY, PLAY, LIFTING)])
def test_a_fit_assembles_what_is_driven(tables: tuple[EffectTable, ...]) -> None:
    """A/F of the structure alone is that of the rig."""
    scenario = effect_rig().model_copy(update={"effect": tables})
    (layout,) = plans(scenario)
    s = structure(layout, layout.run_points(0))
    omega = 2 * np.pi * FREQUENCY_HZ[:, None, None]
    motion = np.linalg.solve(s.stiffness + 1j * omega * s.damping - omega**2 * s.mass, s.drive[None, :, None])
    got = ((s.tilt - omega**2 * s.axis) @ motion)[..., 0].T
    assert largest_error(got, responses(scenario)[0][:-1]) < 1e-5


def test_two_mounts_are_one_of_both_compliances() -> None:
    """With one loss factor at one frequency the sum is a mount like them: force per volt, and A/F."""
    like = {"loss_factor": 0.3, "frequency_hz": 10.0}
    halves = tuple(EffectTable(name="mount-compliance", compliance_m_per_n=c, **like) for c in (5e-5, 1.5e-4))
    rig = effect_rig()
    one, together = (
        responses(rig.model_copy(update={"effect": tables}))
        for tables in ((EffectTable(name="mount-compliance", compliance_m_per_n=2e-4, **like),), halves)
    )
    assert clear_error(together[0][:-1], one[0][:-1]) < 5e-4
    assert clear_error(together[1], one[1]) < 5e-3
    first = responses(having(rig, "mount-compliance", compliance_m_per_n=1.5e-4, **like))
    assert clear_error(first[0][:-1], one[0][:-1]) > 0.01
    assert clear_error(first[1], one[1]) > 0.1


@pytest.mark.parametrize("tables", [(CLAY, GLUE), (PLAY, LIFTING)])
def test_stepped_in_time_they_are_what_the_linear_model_says(tables: tuple[EffectTable, ...]) -> None:
    scenario = example_scenario().model_copy(update={"effect": tables})
    stepped, solved = (simulated_campaign(scenario, engine=engine).runs[0].samples for engine in ("mujoco", "linear"))
    for got, wanted in zip(stepped[1:], solved[1:], strict=True):
        assert np.linalg.norm(got - wanted) < ENGINES_AGREE * np.linalg.norm(wanted)


def test_what_is_added_between_mounts_leaves_the_aircraft_as_it_is() -> None:
    """It weighs nothing, and its own modes are none of the aircraft's."""
    rig = effect_rig()
    alone, both = (truth_of(rig.model_copy(update={"effect": t})).as_tested[0] for t in ((CLAY,), (CLAY, GLUE)))
    np.testing.assert_allclose(both.band(1.0, 40.0).poles, alone.band(1.0, 40.0).poles, rtol=1e-5)


@pytest.mark.parametrize("angle_rad", [0.0, 0.3])
def test_a_mount_gives_along_the_push(angle_rad: float) -> None:
    """The gauge, which goes by what its mount gives, moves by all of it along a push that leans."""
    lean = EffectTable(name="lateral-force", angle_rad=angle_rad, azimuth_rad=0.7)
    (layout,) = plans(effect_rig().model_copy(update={"effect": (lean, CLAY)}))
    s = structure(layout, layout.run_points(0))
    assert s.drive[s.joints.index("effect-1-0")] == pytest.approx(1.0, abs=1e-12)
