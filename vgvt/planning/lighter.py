"""A scenario that is quicker to simulate and whose records have the same noise."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from vgvt.planning.budget import MOUNT_EFFECT
from vgvt.scenario.model import Scenario
from vgvt.simulation.assembly import plans
from vgvt.simulation.noise_floor import force_noise, response_noise

_SAMPLES_PER_CYCLE = 8
_LOWEST_RATE_HZ = 100.0
_NOTICED = 0.01  # of the noise power: half of that in a scatter, which so few campaigns cannot show
_LINES = 200


def lighter(scenario: Scenario) -> Scenario:
    """The scenario sampled no faster than its band needs, where that leaves its noise as it is.

    The noise of sensors and of the converter's inputs is a density, the same at any rate. Rounding is not: its
    density grows as the rate falls, so a coarse converter keeps its rate. An effect may act on the samples
    themselves; a scenario with one keeps its rate, too.
    """
    if any(effect.name != MOUNT_EFFECT for effect in scenario.effect):
        return scenario
    enough = max(_SAMPLES_PER_CYCLE * scenario.excitation.band_hz[1], _LOWEST_RATE_HZ)
    rate = min(scenario.acquisition.sample_rate_hz, float(math.ceil(enough)))
    light = scenario.model_copy(
        update={"acquisition": scenario.acquisition.model_copy(update={"sample_rate_hz": rate})}
    )
    return light if _noise_grows(scenario, light) < _NOTICED else scenario


def _noise_grows(scenario: Scenario, light: Scenario) -> float:
    """By which share at most the noise power of any channel in the band is larger in a light version of a scenario."""
    layout = plans(scenario)[0]
    lighter_layout = replace(layout, scenario=light)
    line_hz = np.linspace(*scenario.excitation.band_hz, _LINES)
    ratios = [noise(lighter_layout, line_hz) / noise(layout, line_hz) for noise in (response_noise, force_noise)]
    return float(np.max(ratios)) - 1
