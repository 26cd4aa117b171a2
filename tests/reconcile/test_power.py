"""The smallest size that a campaign could see is one that would move its data by five honest standard deviations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects.added_mass import AddedMass
from vgvt.reconcile.fit import calibrate
from vgvt.reconcile.hypothesis import Hypothesis
from vgvt.reconcile.power import power
from vgvt.reconcile.stand import Stand
from vgvt.reconcile.thresholds import SMOOTHED


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
