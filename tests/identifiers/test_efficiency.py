"""How close `auto` comes to the Cramér-Rao bound in a few campaigns; the study's test asks many."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.stats import chi2

from vgvt.identification import run_identifier
from vgvt.identification.bound import cramer_rao_bound
from vgvt.identification.example import Example
from vgvt_identifiers.auto import Auto

EXAMPLE = Example(
    frequency_hz=(6.3, 13.7, 13.974, 26.9),  # the two in the middle are 2 % apart
    damping_ratio=(0.012, 0.009, 0.011, 0.007),
    stations=2,
    noise_m_s2=0.5,
)
TRUTH = np.array([*EXAMPLE.frequency_hz, *EXAMPLE.damping_ratio])


def errors_and_deviations(method: Auto, seeds: range) -> tuple[np.ndarray, np.ndarray]:
    """Errors of frequencies, then damping ratios, and stated standard deviations, (seeds, 8) each."""
    errors, deviations = [], []
    for seed in seeds:
        model = run_identifier(method, replace(EXAMPLE, seed=seed).campaign())
        assert len(model) == 4, f"seed {seed}: {model.natural_frequency_hz}, {model.advice}"
        assert model.natural_frequency_std_hz is not None and model.damping_ratio_std is not None
        errors.append(np.concatenate([model.natural_frequency_hz, model.damping_ratio]) - TRUTH)
        deviations.append(np.concatenate([model.natural_frequency_std_hz, model.damping_ratio_std]))
    return np.array(errors), np.array(deviations)


def test_a_few_campaigns_scatter_as_the_bound_says() -> None:
    bound = np.concatenate(cramer_rao_bound(EXAMPLE))
    errors, deviations = errors_and_deviations(Auto(), range(3))
    # Normalised squares add up to a chi-square; 1.15 squared is the efficiency that is asked for.
    assert ((errors / bound) ** 2).sum() < 1.15**2 * chi2.isf(1e-3, errors.size)
    assert ((errors / deviations) ** 2).sum() < chi2.isf(1e-4, errors.size)
    assert np.median(deviations / bound) < 1.15
