"""Effects that a test cannot have are refused in their own name, and not simulated as nothing."""

from __future__ import annotations

import pytest
from hung_hati import made, with_effect

from vgvt.data import InputError
from vgvt.effects.under_a_hammer import act_on
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation.assembly import plans


def hammered(*nodes: int) -> Scenario:
    """The teaching beam under a hammer, which roves over nodes if there are any."""
    scenario = load_scenario("teaching-beam-hammer")
    assert scenario.hammer is not None
    run = scenario.acquisition.runs[0]
    runs = scenario.acquisition.model_copy(update={"runs": (run,) * max(len(nodes), 1)})
    return scenario.model_copy(
        update={"hammer": scenario.hammer.model_copy(update={"nodes": nodes}), "acquisition": runs}
    )


def test_a_leaning_push_is_refused_where_the_hammer_roves() -> None:
    """It leans the push at the drive point, where such a hammer does not hit; one that stays there does lean."""
    effect = made("lateral-force", angle_rad=0.05)
    grid = load_scenario("teaching-beam-hammer").accelerometers.grid.node
    with pytest.raises(InputError, match=r"lateral-force: acts on the shaker.* hammer"):
        act_on(effect, hammered(grid[0], grid[1]), 0)
    still, leaning = (
        plans(s)[0].strike for s in (hammered(), with_effect(hammered(), "lateral-force", angle_rad=0.05))
    )
    assert still is not None
    assert leaning is not None
    assert float(still.axis @ leaning.axis) == pytest.approx(0.99875, abs=1e-5)
    # What leans a sensor has nothing to do with the hammer.
    act_on(made("sensor-tilt", angle_rad=0.05), hammered(grid[0], grid[1]), 0)


def test_an_effect_on_a_mount_that_is_not_there_says_so() -> None:
    """And not that the transducer, which is not there either, lacks a mass."""
    scenario = hammered()
    gauge = scenario.transducer.model_copy(update={"end_mass_kg": 0.0})
    without = scenario.model_copy(update={"transducer": gauge})
    creep = made("mount-creep", compliance_m_per_n=1e-4, shape="step", from_run=2)
    with pytest.raises(InputError, match=r"mount-creep: acts on the shaker, its stinger or its force transducer"):
        act_on(creep, without, 1)


@pytest.mark.parametrize("name", ["control-surface", "control-surface-freeplay"])
@pytest.mark.parametrize(
    ("scenario", "advice"), [("teaching-beam", "No beam has any item"), ("hati-unsymmetric", "flap-")]
)
def test_a_surface_that_is_not_there_is_named_by_its_own_effect(name: str, scenario: str, advice: str) -> None:
    size = {"control-surface": {"compliance_rad_per_n_m": 5.0}, "control-surface-freeplay": {"gap_rad": 0.01}}[name]
    with pytest.raises(InputError, match=rf"effect {name}: item") as refused:
        made(name, item="rudder", **size).act(load_scenario(scenario), 0)
    assert advice in refused.value.advice
    assert not refused.value.advice.rstrip(". ").endswith("of:")


@pytest.mark.parametrize("where", [{"beam": "fuselage"}, {"side": "left", "beam": "fin"}])
def test_a_creeping_root_that_is_not_there_is_named_by_its_own_effect(where: dict[str, str]) -> None:
    creep = made("root-creep", bending=0.1, shape="step", from_run=2, **where)
    scenario = load_scenario("garteur-sm-ag19" if where["beam"] == "fin" else "hati-unsymmetric")
    with pytest.raises(InputError, match=r"effect root-creep: (beam|side)"):
        creep.act(scenario, 1)


def test_a_carry_through_between_wings_that_do_not_hang_on_the_body_is_refused() -> None:
    """All beams on the body of this aircraft are in its plane of symmetry, on one half of it: nothing would rock."""
    effect = made("carry-through-torsion", compliance_rad_per_n_m=1e-3)
    with pytest.raises(InputError, match=r"carry-through-torsion: the body carries no beam to the right and one to"):
        effect.act(load_scenario("garteur-sm-ag19"), 0)
    assert effect.act(load_scenario("hati-unsymmetric"), 0).scenario is not None
