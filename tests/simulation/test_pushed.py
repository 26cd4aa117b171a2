"""Where shakers push beams, cells end: on both sides of a mirrored beam, each side's own shaker first."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.effects.beams import with_airframe, written_out
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.effect import EffectTable
from vgvt.scenario.mirror import expanded_beams
from vgvt.simulation.assembly import plan
from vgvt.simulation.pushed import pushed_beams
from vgvt.simulation.truth import truth_of


def pushed_at(*places_m: tuple[float, float]) -> Scenario:
    """The teaching beam with a shaker at every place (x, y)."""
    scenario = load_scenario("teaching-beam")
    first, *further = (
        scenario.shaker.model_copy(update={"position_m": (x, y, 0.0), "node": 100 + k})
        for k, (x, y) in enumerate(places_m)
    )
    return scenario.model_copy(update={"shaker": first, "further_shaker": tuple(further)})


def edges(scenario: Scenario, beam: str) -> list[float]:
    """Where the cells of a beam as built end, arc lengths in m."""
    return [link.twist_arc_m for link in plan(scenario).parts.chains[beam].links]


def test_a_shaker_on_the_body_pushes_no_beam() -> None:
    assert pushed_beams(load_scenario("hati-unsymmetric")) == ()


@pytest.mark.parametrize("y_m", [0.537, -0.537])
def test_both_sides_of_a_mirrored_beam_are_cut_alike(y_m: float) -> None:
    one = pushed_at((0.08, y_m))
    assert edges(one, "beam-right") == edges(one, "beam-left")
    assert any(arc == pytest.approx(0.537, abs=1e-12) for arc in edges(one, "beam-left"))


def test_a_side_with_a_shaker_of_its_own_is_cut_for_that() -> None:
    """Nearer to each other than half a cell, and each under its own side."""
    two = pushed_at((0.08, 0.537), (0.08, -0.549))
    assert any(arc == pytest.approx(0.537, abs=1e-12) for arc in edges(two, "beam-right"))
    assert any(arc == pytest.approx(0.549, abs=1e-12) for arc in edges(two, "beam-left"))


def test_sides_written_out_are_cut_alike_too() -> None:
    """An effect on one side has a mirrored table written out: that is the same aircraft."""
    one = pushed_at((0.08, 0.537))
    written = written_out(one)
    assert [beam.mirror for beam in written.airframe.beam] == [False, False]
    assert pushed_beams(written) == pushed_beams(one)
    for side in ("beam-right", "beam-left"):
        assert edges(written, side) == edges(one, side)


def test_sides_that_are_not_mirrored_are_cut_each_for_itself() -> None:
    """A left beam that is longer has no place for the right one's shaker."""
    one = pushed_at((0.08, 0.537))
    right, left = expanded_beams(one.airframe)
    *inner, (x, y, z) = left.stations.position_m
    stations = left.stations.model_copy(update={"position_m": (*inner, (x, 1.1 * y, z))})
    beams = (right, left.model_copy(update={"stations": stations}))
    uneven = with_airframe(written_out(one), beam=beams)
    assert [part for part, _ in pushed_beams(uneven)] == ["beam-right"]


def test_an_effect_of_size_nothing_on_one_side_changes_nothing() -> None:
    """It had left the other side's cells uncut: 2.5 % of A/F where the shaker is half a cell off an edge."""
    one = pushed_at((0.08, 0.537))
    soft = EffectTable(name="root-compliance", beam="beam", side="right", bending=1e-9, torsion=0.0)
    modes = [truth_of(s).bare.natural_frequency_hz for s in (one, one.model_copy(update={"effect": (soft,)}))]
    assert np.allclose(modes[0], modes[1], rtol=1e-6)


def test_a_hammer_s_beam_is_cut_as_the_shaker_s() -> None:
    """One aircraft, one truth, whatever excites it."""
    assert edges(load_scenario("teaching-beam-hammer"), "beam-right") == edges(
        load_scenario("teaching-beam"), "beam-right"
    )
