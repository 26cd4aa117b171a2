"""Harmonics that a structure makes are told from those of the force, and from noise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from added_noise import Noise
from reconciled_case import small_scenario, without_instrument_noise

from vgvt.data import Campaign, ChannelRole
from vgvt.reconcile.question.data import measured_frfs
from vgvt.reconcile.question.harmonics import Harmonic, answers_jaggedly, words_of
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import simulated_campaign

SHARE = 0.05


@cache
def swept(second: float = 0.0, third: float = 0.0) -> Campaign:
    """A linear structure under a sweep whose amplifier makes harmonics."""
    scenario = without_instrument_noise(small_scenario())
    if second or third:
        table = EffectTable(name="force-distortion", second_harmonic=second, third_harmonic=third)
        scenario = scenario.model_copy(update={"effect": (table,)})
    return simulated_campaign(scenario, engine="linear")


def bent(campaign: Campaign, law: Callable[[np.ndarray], np.ndarray]) -> Campaign:
    """Responses with a static curve added, in units of three times their root mean square."""
    runs = []
    for run in campaign.runs:
        samples = np.array(run.samples, dtype=float)
        for k, channel in enumerate(run.channels):
            if channel.role is ChannelRole.RESPONSE:
                size = 3 * samples[k].std()
                samples[k] += SHARE * size * law(samples[k] / size)
        runs.append(replace(run, samples=samples))
    return replace(campaign, runs=tuple(runs))


def seen(campaign: Campaign, noise: float, seed: int = 0) -> tuple[Harmonic, ...]:
    """The harmonics of a campaign with noise."""
    return measured_frfs(Noise(noise, False).on(campaign, np.random.default_rng(seed)), lines=60).harmonics


@pytest.mark.parametrize("noise", [0.003, 0.03])
def test_a_linear_structure_shows_none_whatever_the_force_holds(noise: float) -> None:
    for campaign in (swept(), swept(0.3, 0.1)):
        found = seen(campaign, noise)
        assert {h.order for h in found} == {2, 3}
        assert words_of(found) is None, found
        assert not answers_jaggedly(found)


@pytest.mark.parametrize(("order", "word"), [(2, "second"), (3, "third")])
def test_a_curve_shows_at_its_own_order(order: int, word: str) -> None:
    found = seen(bent(swept(), lambda s: s**order), 0.01)
    assert [h.order for h in found if h.unexplained] == [order]
    said = words_of(found)
    assert said is not None
    assert f"hold {word} harmonics" in said


def test_what_is_thrown_all_over_the_band_is_no_harmonic() -> None:
    """A curve has its multiples and nothing between; an answer that comes and goes with the level is jagged."""
    curved = seen(bent(swept(), lambda s: s**3), 0.01)
    assert words_of(curved) is not None
    assert not answers_jaggedly(curved)
    gone = seen(bent(swept(), lambda s: 20 * np.where(np.abs(s) > 0.3, s, 0.0)), 0.01)
    assert answers_jaggedly(gone)
    assert words_of((Harmonic(1, 3, 90.0, 95.0),)) is None
    assert not answers_jaggedly(())


def test_a_force_with_harmonics_does_not_hide_those_of_the_structure() -> None:
    found = seen(bent(swept(0.3, 0.1), lambda s: s**2), 0.01)
    assert [h.order for h in found if h.unexplained] == [2]


def test_a_force_that_is_everywhere_at_all_times_is_no_sweep() -> None:
    campaign = swept()
    run = campaign.runs[0]
    stirred = np.random.default_rng(1).standard_normal(run.samples.shape)
    random = replace(campaign, runs=(replace(run, samples=stirred),))
    assert measured_frfs(random, lines=60).harmonics == ()
