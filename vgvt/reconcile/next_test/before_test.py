"""What a test could see before it is made: the scenario's own campaign, simulated, stands in for the measured one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.question.arguments import floor_for
from vgvt.reconcile.question.data import measured_frfs
from vgvt.reconcile.question.problem import problem_of
from vgvt.reconcile.question.suitable import check_excitation, within_excited
from vgvt.scenario.model import Scenario
from vgvt.simulation import simulate


def expected_fit(
    scenario: Scenario,
    *,
    lines: int = 500,
    floor: float | None = None,
    band_hz: tuple[float, float] | None = None,
    cache: Path | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> Fit:
    """The scenario as stated against its own campaign by the linear engine, noise included: where ``power`` can stand.

    Nothing is fitted. ``floor`` is the relative model-form error (default: the scenario's tolerance).
    InputError for a hammer, several shakers and a band that is not excited, as with a campaign.
    """
    check_excitation(scenario)
    if band_hz is not None:
        band_hz = within_excited(band_hz, scenario.excitation.band_hz, scenario.name)
    campaign = simulate(scenario, engine="linear", progress=progress).campaign
    measured = measured_frfs(campaign, lines=lines, floor=floor_for(scenario, floor), band_hz=band_hz)
    problem = problem_of(measured, scenario, cache=cache)
    return fit(problem, (), np.zeros(problem.size), np.zeros(0), ())
