"""A campaign stepped in time once more, each run as hard as it was measured: a joint that depends on level asks for it.

No scenario states how hard each run was shaken. The measured force does; what the linear engine makes of the drive as
stated says how much more or less of it that is.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign
from vgvt.reconcile.question.data import Measured, level_of
from vgvt.reconcile.question.spectra import spectra_of
from vgvt.scenario.model import Scenario
from vgvt.signals.usable import usable_runs
from vgvt.simulation.campaign import simulated_campaign, stepping_work

MOST_WORK = 1e10
"""Of steps times degrees of freedom squared: some three minutes of one core."""
# The joint changes the force that a command makes: farther from the measured one than this another aircraft is stepped.
_NEAR = 0.15


def too_much_work(scenario: Scenario) -> bool:
    """Whether stepping a scenario takes too long to be done beside a verdict."""
    return stepping_work(scenario) > MOST_WORK


def stepped_again(
    scenario: Scenario, measured: Measured, progress: Callable[[float, str], None] | None = None
) -> tuple[Campaign, str]:
    """The campaign, and in words at which level it was stepped, and where that is not the measured one."""
    linear = _levels_n(simulated_campaign(scenario, engine="linear"), scenario)
    drives = measured.level_n / linear
    campaign = simulated_campaign(scenario, engine="mujoco", levels=tuple(drives), progress=progress)
    harder = _levels_n(campaign, scenario) / measured.level_n
    worst = harder[np.argmax(np.abs(np.log(harder)))]
    low, high = (f"{d:.2g}" for d in (drives.min(), drives.max()))
    said = f"It was stepped in time at {low if low == high else f'{low} to {high}'} times the scenario's drive, "
    near = abs(np.log(worst)) < _NEAR
    said += "as hard as it was measured" if near else f"which makes {worst:.2g} times the force that was measured"
    return campaign, said


def _levels_n(campaign: Campaign, scenario: Scenario) -> NDArray[np.float64]:
    """The level of every run (R,), N, as that of a measured one is told."""
    runs, _ = usable_runs(campaign, every_run=True)
    spectra, _ = spectra_of(runs, scenario.acquisition.sample_rate_hz)
    return level_of(spectra.pushed)
