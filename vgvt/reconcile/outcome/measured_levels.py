"""How hard each run of a campaign was driven, as a scenario says it: a joint that depends on level answers to that.

The measured force tells it; what the linear engine makes of the drive as stated says how much more or less of it that
is.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, InputError
from vgvt.reconcile.question.data import Measured, level_of
from vgvt.reconcile.question.spectra import spectra_of
from vgvt.scenario.base import MisfitError
from vgvt.scenario.generator import check_generator
from vgvt.scenario.model import Scenario
from vgvt.signals.usable import usable_runs
from vgvt.simulation.campaign import simulated_campaign

# Of a factor: a joint changes the force that a command makes, and farther off it is another answer.
_NEAR = 0.15
_DIGITS = 4


def with_measured_levels(scenario: Scenario, measured: Measured) -> Scenario:
    """The scenario with every run driven as hard as it was measured; as it is where it cannot be.

    That is where it cannot be simulated, pushes nothing, or its generator does not give so much.
    """
    alike = scenario.model_copy(update={"acquisition": scenario.acquisition.with_runs(measured.runs)})
    try:
        made = _levels_n(simulated_campaign(alike, engine="linear"), alike)
    except (InputError, RuntimeError, ValueError, np.linalg.LinAlgError):
        return scenario
    if not (made > 0).all():
        return scenario
    levels = tuple(float(f"{level:.{_DIGITS}g}") for level in measured.level_n / made)
    driven = alike.model_copy(update={"acquisition": alike.acquisition.with_runs(measured.runs, levels)})
    try:
        check_generator(driven.generator, driven.excitation, driven.acquisition)
    except MisfitError:
        return scenario
    return driven


def told_levels(campaign: Campaign, scenario: Scenario, measured: Measured) -> str:
    """In words how hard the runs of a scenario's campaign are driven, and whether that makes the measured force."""
    levels = scenario.acquisition.levels or (1.0,)
    harder = _levels_n(campaign, scenario) / measured.level_n
    worst = float(harder[np.argmax(np.abs(np.log(harder)))])
    low, high = (f"{level:.2g}" for level in (min(levels), max(levels)))
    said = f"It was stepped in time at {low if low == high else f'{low} to {high}'} times the scenario's drive, "
    near = abs(np.log(worst)) < _NEAR
    return said + ("as hard as it was measured" if near else f"which makes {worst:.2g} times the measured force")


def _levels_n(campaign: Campaign, scenario: Scenario) -> NDArray[np.float64]:
    """The level of every run (R,), N, as that of a measured one is told."""
    runs, _ = usable_runs(campaign, every_run=True)
    spectra, _ = spectra_of(runs, scenario.acquisition.sample_rate_hz)
    return level_of(spectra.pushed)
