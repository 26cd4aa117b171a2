"""The test once more with what was found: the augmented scenario simulated, and its A/F held against the measured.

A fit predicts with a linear model of its own, its beams without cells and its structure followed by slopes. What a
scenario says is what its simulation does: this is asked here, from the drive signal on, as somebody would who goes on
with the file.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy.signal
from numpy.typing import NDArray

from vgvt.data import Campaign, InputError
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.outcome.measured_levels import told_levels
from vgvt.reconcile.question.data import Measured
from vgvt.reconcile.question.figures_of_merit import Comparison, Resimulation, compare
from vgvt.reconcile.question.level_grid import depends_on_level
from vgvt.reconcile.question.spectra import OwnSpectra, spectra_of
from vgvt.reconcile.question.thresholds import Limits, Thresholds, limits_for, noise_share
from vgvt.scenario.model import Scenario
from vgvt.scenario.points import sensor_points
from vgvt.signals.usable import usable_runs
from vgvt.simulation.campaign import simulated_campaign, stepping_work

ComplexArray = NDArray[np.complex128]
_QUIET_BITS = 32
# Beside the measured force, whose shape it should have: so much less than at its loud lines is no excitation, and of
# this share of the lines it may be missing.
_WEAK_FORCE, _LOUD, _UNEXCITED = 0.03, 0.9, 0.05
# Samples of all channels of all runs: some minutes' work.
_MOST_SAMPLES = 1e8
MOST_WORK = 1e10
"""Steps in time, times degrees of freedom squared, that a verdict waits for: some three minutes of one core."""


def resimulated(
    scenario: Scenario,
    found: Fit,
    thresholds: Thresholds | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> Resimulation:
    """Simulate a scenario as the campaign of a fit was made, without noise; why not, where that cannot be done.

    Where a name is a joint that depends on level it is stepped in time, at the levels that the scenario states.
    Where it misses more than the ``thresholds`` let, and the fit does not, the remark says so.
    """
    problem = found.problem
    nonlinear = [h for h in found.hypotheses if not h.linear]
    untold = [h.name for h in nonlinear if not depends_on_level(problem, h)]
    if untold:
        return Resimulation.skipped(
            f"{' and '.join(untold)} was foretold as it is at rest, and no record told what makes it nonlinear; state "
            "that and step it with --engine mujoco"
        )
    rate = scenario.acquisition.sample_rate_hz
    samples = scenario.excitation.record_s * rate * (len(problem.measured.channels) + len(problem.measured.runs))
    if samples > _MOST_SAMPLES:
        return Resimulation.skipped(f"{samples:.0e} samples are too many to be simulated beside a verdict")
    asked, said = quiet(scenario), list[str]()
    try:
        if not nonlinear:
            campaign = simulated_campaign(asked, engine="linear")
        elif stepping_work(asked) > MOST_WORK:
            return Resimulation.skipped(
                f"the linear engine has not all of what {' and '.join(h.name for h in nonlinear)} does, and stepping "
                "it in time takes too long beside a verdict; step it with --engine mujoco"
            )
        else:
            campaign = simulated_campaign(asked, engine="mujoco", progress=progress)
            said.append(told_levels(campaign, asked, problem.measured))
        values, excited = accelerances(campaign, asked, problem.measured)
    except (InputError, ArithmeticError, RuntimeError, ValueError, np.linalg.LinAlgError) as error:
        return Resimulation.skipped(f"it cannot be simulated: {' '.join(str(error).split())}")
    if excited < 1 - _UNEXCITED:
        return Resimulation.skipped(
            f"the scenario's excitation has no force on {100 * (1 - excited):.0f} % of the campaign's lines"
        )
    measured, used = problem.measured, problem.measured.used
    fitted, again = found.foretold, replace(found, predicted=values).foretold
    size = np.abs(measured.values[used])
    scale = size**2 + np.median(size, axis=1, keepdims=True) ** 2
    apart = float(np.sqrt(np.mean(np.abs(again - fitted)[used] ** 2 / scale)))
    floor = noise_share(measured, problem.split.train).floor
    if apart > floor:
        said.append(
            f"The simulation of reconciled.toml is {100 * apart:.2g} % from what was fitted, more than the model_form "
            f"of {100 * floor:.2g} %: trust the file no further than that"
        )
    there = compare(again, measured, problem.split)
    if thresholds is not None:
        limits = limits_for(thresholds, measured, problem.split)
        said += beyond_limits(there, compare(fitted, measured, problem.split), limits)
    return Resimulation(there, apart, floor, "; ".join(said))


def beyond_limits(again: Comparison, fitted: Comparison, limits: Limits) -> list[str]:
    """What a simulation misses by more than a limit that its fit keeps, in words.

    A quarter of the floor, at sharp peaks, is no distance and may be as much χ² again.
    """
    pairs = (
        ("fitted", again.train, fitted.train, limits.chi2_per_dof),
        ("held-out", again.held_out, fitted.held_out, limits.held_out_per_dof),
    )
    return [
        f"The simulation of reconciled.toml misses the {what} data by {there.chi2_per_dof:.2f} per degree of freedom, "
        f"where the fit has {here.chi2_per_dof:.2f} and {limit:.2f} is the limit"
        for what, there, here, limit in pairs
        if there is not None and here is not None and here.chi2_per_dof <= limit < there.chi2_per_dof
    ]


def quiet(scenario: Scenario) -> Scenario:
    """The scenario with instruments that add no noise of their own."""
    return scenario.model_copy(
        update={
            "accelerometers": scenario.accelerometers.model_copy(update={"noise": None}),
            "transducer": scenario.transducer.model_copy(update={"noise": None}),
            "acquisition": scenario.acquisition.model_copy(update={"noise_v_per_rthz": 0.0, "bits": _QUIET_BITS}),
        }
    )


def accelerances(campaign: Campaign, scenario: Scenario, measured: Measured) -> tuple[ComplexArray, float]:
    """A/F (C, L) of a scenario's campaign at the lines of a measured one, and the share of them that it excites."""
    runs, _ = usable_runs(campaign, every_run=True)
    rate = scenario.acquisition.sample_rate_hz
    # Without noise fewer ends are loud enough to be tapered, and one that is not reads another A/F.
    tapers_s = [end.last.size * end.sample_s for end in measured.endings]
    spectra, _ = spectra_of(runs, rate, tapers_s or None)
    stated = {p.dof.node: p.dof.direction.sign for p in sensor_points(scenario)}
    values = np.zeros(measured.values.shape, dtype=complex)
    excited = []
    for r, (run, own) in enumerate(zip(runs, spectra.own, strict=True)):
        force, *responses = _at_lines(own, rate, measured)
        size = np.abs(force / measured.force[r])
        excited.append(float(np.mean(size > _WEAK_FORCE * np.quantile(size, _LOUD))))
        there = {c.dof.node: x for c, x in zip(run.responses, responses, strict=True) if c.dof is not None}
        for k, channel in enumerate(measured.channels):
            if channel.run == r and measured.used[k]:
                if channel.dof.node not in there:
                    raise InputError(f"scenario {scenario.name}", f"{channel.label} is cut off when it is simulated")
                sign = channel.dof.direction.sign * stated[channel.dof.node]
                values[k] = sign * there[channel.dof.node] / force
    return values, min(excited)


def _at_lines(own: OwnSpectra, rate: float, measured: Measured) -> ComplexArray:
    """Force and responses of a run, (1 + C_r, L), at the lines of records of another length or rate."""
    samples = np.fft.irfft(np.vstack([own.force, own.responses]), own.samples, axis=1)
    first, step = measured.frequency_hz[0] / rate, measured.resolution_hz / rate
    count = int(measured.lines[-1] - measured.lines[0]) + 1
    transform = scipy.signal.CZT(own.samples, count, np.exp(-2j * np.pi * step), np.exp(2j * np.pi * first))
    return np.asarray(transform(samples, axis=1)[:, measured.lines - measured.lines[0]])
