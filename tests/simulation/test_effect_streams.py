"""What an effect draws is its own: another effect beside it changes none of its numbers."""

from __future__ import annotations

import numpy as np
from small_rig import revised

from vgvt.scenario import Scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import simulated_campaign

HUM = EffectTable(name="mains-hum", amplitude_v=1e-3, second=0.0, third=0.0)
NOTHING = EffectTable(name="channel-gain", gain_error=0.0)


def samples(scenario: Scenario, *effects: EffectTable) -> np.ndarray:
    brief = revised(scenario, excitation={"duration_s": 2.0, "ring_down_s": 0.0})
    return simulated_campaign(brief.model_copy(update={"effect": effects}), engine="linear").runs[0].samples


def test_an_effect_that_does_nothing_redraws_no_other(small: Scenario) -> None:
    alone = samples(small, HUM)
    assert np.abs(alone - samples(small)).max() > 1e-4
    np.testing.assert_array_equal(samples(small, NOTHING, HUM), alone)
    np.testing.assert_array_equal(samples(small, HUM, NOTHING), alone)


def test_a_second_one_of_a_name_draws_for_itself(small: Scenario) -> None:
    """Two hums of one phase would add up to twice the first."""
    clean, one, two = samples(small), samples(small, HUM), samples(small, HUM, HUM)
    first, second = one - clean, two - one
    likeness = (first * second).sum(axis=1) / np.linalg.norm(first, axis=1) / np.linalg.norm(second, axis=1)
    assert (np.abs(likeness) < 0.99).any()
    assert np.linalg.norm(second) > 0.5 * np.linalg.norm(first)
