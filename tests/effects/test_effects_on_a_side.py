"""An effect acts on the side that it names, or that its beam's name says, and leaves the other as it is."""

from __future__ import annotations

import numpy as np
import pytest
from hung_hati import hung_hati, made, with_effect

from vgvt.data import InputError
from vgvt.effects.beams import on_side, written_out
from vgvt.effects.elements import BendTwist, GroundSpring
from vgvt.effects.root_compliance import beam_compliance
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import truth_of

SIZES: dict[str, dict[str, object]] = {
    "cubic-root-stiffness": {"cubic_n_m_per_rad3": 1e5},
    "root-friction": {"friction_n_m": 0.5},
    "root-freeplay": {"gap_rad": 1e-3, "kind": "bending"},
}
STIFFNESS = 1500.0


@pytest.fixture(scope="module")
def hati() -> Scenario:
    """Hati with the rigid roots that it is stated with."""
    return hung_hati()


@pytest.mark.parametrize("name", SIZES)
def test_the_root_of_the_other_side_stays_rigid(hati: Scenario, name: str) -> None:
    sized = SIZES[name] | {"root_stiffness_n_m_per_rad": STIFFNESS, "side": "right"}
    action = made(name, **sized).act(hati, 0)
    assert action.scenario is not None
    roots = {b.name: b.root_bending_stiffness_n_m_per_rad for b in action.scenario.airframe.beam}
    assert roots == {"wing-right": STIFFNESS, "wing-left": None}
    assert [law.beam for law in action.elements] == ["wing-right"]


@pytest.mark.parametrize("name", ["cubic-root-stiffness", "root-friction"])
def test_about_rest_a_law_of_one_root_is_its_compliance(hati: Scenario, name: str) -> None:
    """Bare modes are those of a root that gives way by 1/k on that side alone, stated as a share of the wing's own."""
    wing = hati.airframe.beam[0]
    share = 1 / (STIFFNESS * beam_compliance(wing, wing.stations.bending_stiffness_n_m2))
    sized = SIZES[name] | {"root_stiffness_n_m_per_rad": STIFFNESS, "side": "right"}
    got, wanted, both = (
        truth_of(scenario).bare.natural_frequency_hz
        for scenario in (
            with_effect(hati, name, **sized),
            with_effect(hati, "root-compliance", bending=share, side="right"),
            with_effect(hati, "root-compliance", bending=share),
        )
    )
    np.testing.assert_allclose(got, wanted, rtol=1e-9)
    assert np.abs(both[: got.size] / wanted[: both.size] - 1).max() > 0.01


def test_a_beam_without_two_sides_has_no_asymmetry() -> None:
    with pytest.raises(InputError, match=r"beam: there is no right and left copy of fin"):
        made("stiffness-asymmetry", bending=0.1, beam="fin").act(load_scenario("garteur-sm-ag19"), 0)


def test_a_wing_that_is_named_by_its_side_is_that_one(hati: Scenario) -> None:
    """On an aircraft with both wings written out; by its plain name it is both."""
    split = written_out(hati)
    for beam, wanted in (("wing-right", {"wing-right"}), ("wing", {"wing-right", "wing-left"})):
        air = made("entrained-air", drag_n_s_per_m3=1.0, beam=beam).act(split, 0).elements
        assert {e.part for e in air if isinstance(e, GroundSpring)} == wanted
        coupled = made("bend-twist-coupling", coupling=0.2, beam=beam).act(split, 0).elements
        assert {e.beam for e in coupled if isinstance(e, BendTwist)} == wanted


def test_a_side_that_a_named_beam_is_not_on_is_refused(hati: Scenario) -> None:
    split = written_out(hati)
    with pytest.raises(InputError, match="there is no right copy of the beam"):
        on_side(split, ("wing-left",), "right", "test")
    changed, names = on_side(split, ("wing-left",), "left", "test")
    assert names == ("wing-left",)
    assert changed.airframe == split.airframe
