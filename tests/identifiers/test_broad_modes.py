"""Modes of 5 to 15 % damping, which overlap: what a model of fixed order has to spare is no mode without a doubt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vgvt.data import Campaign
from vgvt.identification import make_identifier, run_identifier
from vgvt.identification.example import Example


def broad(seed: int) -> Example:
    """Three to six modes of 5 to 15 % damping anywhere in the band, six sensors."""
    generator = np.random.default_rng(seed)
    modes = int(generator.integers(3, 7))
    frequency = np.sort(generator.uniform(5.0, 36.0, modes))
    return Example(
        tuple(frequency),
        tuple(generator.uniform(0.05, 0.15, modes)),
        stations=3,
        noise_m_s2=float(10 ** generator.uniform(-2.0, -0.3)),
        seed=seed,
    )


def at_once(example: Example) -> Campaign:
    """The campaign with all sensors in one run."""
    campaign = example.campaign()
    first = campaign.runs[0]
    rows = [first.samples, *(r.samples[1:] for r in campaign.runs[1:])]
    channels = (*first.channels, *(c for r in campaign.runs[1:] for c in r.channels[1:]))
    return replace(campaign, runs=(replace(first, channels=channels, samples=np.vstack(rows)),))


def test_poles_that_are_no_modes_are_doubtful_and_few_modes_are() -> None:
    """A pole counts as a mode within half of the half width of a true one; shifted ones may be further off."""
    distance: list[float] = []
    doubtful: list[bool] = []
    there = 0
    for seed in range(30):
        example = broad(seed)
        model = run_identifier(make_identifier("pem"), at_once(example))
        true = example.modes().poles
        distance += list((np.abs(model.poles[:, None] - true) / -true.real).min(axis=1))
        doubtful += [any("doubtful" in flag for flag in flags) for flags in model.flags]
        there += true.size
    near, far, doubt = np.array(distance) < 0.5, np.array(distance) > 0.8, np.array(doubtful)
    assert far.sum() >= 10
    assert near.sum() > 0.8 * there
    assert doubt[near].mean() < 0.15
    assert doubt[~near].mean() > 0.9
    assert doubt[far].all()
