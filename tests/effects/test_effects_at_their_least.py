"""At the least that it takes, a parameter means something, or is refused by name: no numbers that are none."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from hung_hati import made
from numpy.typing import NDArray
from small_rig import revised

from vgvt.data import Channel, ChannelRole, Direction, Dof, InputError, Quantity
from vgvt.effects import Action, ChannelFilter, ChannelTransform, available_effects, make_effect
from vgvt.effects.parameter import parameters_of
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import simulated_campaign
from vgvt.simulation.assembly import plans
from vgvt.simulation.channel_effects import changed_by_effects

OWN = {name: cls for name, cls in available_effects().items() if cls.__module__.startswith("vgvt.effects.")}
LEAST = [(name, p.name, p.least) for name, cls in OWN.items() for p in parameters_of(cls) if p.least is not None]
DIVIDES = [
    ("base-strain", "frequency_hz"),
    ("frame-resonance", "frequency_hz"),
    ("local-absorber", "frequency_hz"),
    ("loose-sensor-mount", "damping_ratio"),
    ("mains-hum", "frequency_hz"),
    ("mount-compliance", "frequency_hz"),
    ("mount-creep", "frequency_hz"),
    ("mount-lift-off", "frequency_hz"),
    ("shaker-backlash", "frequency_hz"),
    ("stinger-moment", "frequency_hz"),
]
"""Effects with what they divide by, or what means nothing at zero."""


@lru_cache(maxsize=1)
def coarse(name: str) -> Scenario:
    """The scenario that shows an effect, of few links and a short sweep."""
    whole = load_scenario(f"spoiled-{name}")
    first, *others = whole.airframe.beam
    sweep = {"duration_s": 2.0, "ring_down_s": 1.0}
    beams = (first.model_copy(update={"cells": 3}), *others)
    return revised(whole, airframe={"beam": beams}, excitation=sweep)


@pytest.mark.parametrize(("name", "parameter", "least"), LEAST)
def test_the_least_is_simulated_or_refused(name: str, parameter: str, least: float) -> None:
    """By the exact solution, which takes what is linear of an effect: records hold numbers, and nothing else fails."""
    *others, own = coarse(name).effect
    values = own.model_dump() | {parameter: least}
    scenario = coarse(name).model_copy(update={"effect": (*others, EffectTable(**values))})
    try:
        records = simulated_campaign(scenario, engine="linear").runs
    except InputError as refused:
        assert parameter in str(refused)
        return
    assert all(np.isfinite(record.samples).all() for record in records)


@pytest.mark.parametrize(("name", "parameter"), DIVIDES)
def test_nothing_is_divided_by_zero(name: str, parameter: str) -> None:
    """The place comes first: a file's, and the key in it. A hair above zero is taken."""
    with pytest.raises(InputError, match=rf"^file.toml: effect '{name}': {parameter} must be above 0"):
        make_effect(name, "file.toml", **{parameter: 0.0})
    made(name, **{parameter: 1e-9})


def test_hum_has_a_frequency() -> None:
    with pytest.raises(InputError, match="frequency_hz must be above 0"):
        made("mains-hum", amplitude_v=1e-3, frequency_hz=-50.0)


def _not_above_10_hz(frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
    return np.where(frequency_hz < 10.0, 1.0, np.nan).astype(complex)


def _not_in_the_end(
    samples: NDArray[np.float64], rate_hz: float, generator: np.random.Generator
) -> NDArray[np.float64]:
    del rate_hz, generator
    return np.append(samples[:-1], np.inf)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (ChannelFilter("response", _not_above_10_hz), r"first at 10(\.0\d*)? Hz"),
        (ChannelTransform("response", _not_in_the_end), "first at sample 1999"),
    ],
)
def test_a_bundled_effect_writes_no_number_that_is_none(change: ChannelFilter | ChannelTransform, words: str) -> None:
    """Whatever slipped through its constructor: the effect and the channel are named, and nothing is written."""
    layout = replace(plans(coarse("loose-sensor-mount"))[0], actions=(Action(channels=(change,)),))
    tip = Channel("acceleration 9+Z", Quantity.ACCELERATION, ChannelRole.RESPONSE, Dof(9, Direction.PLUS_Z))
    with pytest.raises(InputError, match=rf"effect\[0\] loose-sensor-mount: .* acceleration 9\+Z .* {words}"):
        changed_by_effects(layout, tip, 0, "sensor", np.ones(2000))
