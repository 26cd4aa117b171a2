"""The likelihood fit of an example that is told the noise and where to start: what luck does to any method.

A method's errors share most of their chance with this fit of the same records. Its
variance is known from its information, so that the chance can be taken out of a method's mean square
(a control variate; Lavenberg and Welch, Management Science 27(3), 1981).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.identification.example import Example
from vgvt_identifiers.likelihood_fit import weighted_problem
from vgvt_identifiers.pole_covariance import pole_deviations
from vgvt_identifiers.pole_fit import PoleState, fit_poles
from vgvt_identifiers.run_noise import RunNoise
from vgvt_identifiers.spectra import campaign_spectra


def told_the_noise(example: Example, seeds: range) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Errors (seeds, 2 M) of frequencies in Hz, then damping ratios; their deviations (2 M,) by the information."""
    truth = np.array([*example.frequency_hz, *example.damping_ratio])
    modes = len(example.frequency_hz)
    errors = []
    for seed in seeds:
        states = _fits(replace(example, seed=seed), example.noise_m_s2)
        weight = sum(s.information for s in states)
        pull = sum(s.information @ np.concatenate([s.poles.real, s.poles.imag]) for s in states)
        mean = np.linalg.solve(weight, pull)
        poles = mean[:modes] + 1j * mean[modes:]
        errors.append(np.concatenate([np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)]) - truth)
    clean = _fits(replace(example, noise_m_s2=0.0), example.noise_m_s2)
    covariance = np.linalg.inv(sum(s.information for s in clean))
    return np.array(errors), np.concatenate(pole_deviations(example.modes().poles, covariance))


def _fits(example: Example, noise_m_s2: float) -> list[PoleState]:
    """The fit of every run of an example, weighted by a white noise of this standard deviation a sample."""
    campaign = example.campaign()
    spectra = campaign_spectra(campaign, example.band_hz)
    states = []
    for run, record in zip(spectra.runs, campaign.runs, strict=True):
        power = np.full(run.accelerance.shape, noise_m_s2**2 * record.samples.shape[1])
        noise = RunNoise(power, np.zeros(run.force.size), np.zeros(run.force.size))
        problem = weighted_problem(spectra.frequency_hz, (run,), (noise,), shared=True)
        still = replace(problem.rows[0], ringing=np.zeros(len(example.frequency_hz), bool))
        states.append(fit_poles(replace(problem, rows=(still,)), example.modes().poles))
    return states
