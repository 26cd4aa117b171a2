"""The smallest size that a campaign could see is one that would move its data by five honest standard deviations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.effects.added_mass import AddedMass
from vgvt.reconcile.fit import calibrate, fit
from vgvt.reconcile.hypothesis import Hypothesis
from vgvt.reconcile.power import power
from vgvt.reconcile.stand import Stand
from vgvt.reconcile.thresholds import SMOOTHED, noise_share


def test_the_smallest_size_moves_the_data_by_five_deviations(tmp_path: Path) -> None:
    """Beyond what the unknowns imitate, with the model's own error counted once for some lines: 25 of χ²."""
    null = calibrate(problem(tmp_path, 1))
    heavier = Hypothesis(AddedMass, {"x_m": 0.9, "y_m": 1.1})
    (found,) = power(null, [heavier])
    stand = Stand.of(null)
    part = 0.01
    moved = stand.change(heavier, {"mass_kg": part * found.smallest})
    assert moved is not None
    left = stand.projected(moved) / part
    measured, train = null.problem.measured, null.problem.split.train
    noise = float(np.mean(measured.noise[train] / measured.sigma[train] ** 2))
    assert noise < 0.9
    assert (noise + (1 - noise) / SMOOTHED) * float(left @ left) == pytest.approx(25.0, rel=0.05)


def test_what_grows_with_the_square_of_its_size_is_seen_at_its_root(tmp_path: Path) -> None:
    """A loose sensor far above the band reads (1 + (f T)²) times too much: twice the period, four times the change."""
    case = problem(tmp_path, 1)
    null = fit(case, (), np.zeros(case.size), np.zeros(0), ())
    loose = Hypothesis(available_effects()["loose-sensor-mount"], {"node": 6})
    found = next(p for p in power(null, [loose]) if p.parameter == "period_s")
    stand = Stand.of(null)
    change = stand.change(loose, {"period_s": found.smallest, "damping_ratio": 0.05})
    assert change is not None
    worth = noise_share(case.measured, case.split.train).worth ** 0.5
    assert worth * np.linalg.norm(stand.projected(change)) == pytest.approx(5.0, rel=0.05)
    # Amounts and structures grow as slopes.
    gain = Hypothesis(available_effects()["channel-gain"], {"channels": "6+Z"})
    mass = Hypothesis(available_effects()["added-mass"], {"x_m": 0.9, "y_m": 1.1})
    for hypothesis in (gain, mass):
        assert stand.squared(hypothesis, {}, hypothesis.parameters[0]) is None
