"""Sensors that load the structure in their own run only, against that structure with their masses in it."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.reconcile.mechanics.response import Matrices, accelerances, loaded_by

COORDINATES = 5
OMEGA = np.linspace(0.4, 2.0, 9)


@pytest.mark.parametrize("sensors", [1, 2, 3])
def test_they_act_as_masses_that_are_there(sensors: int) -> None:
    g = np.random.default_rng(sensors)
    a, c = (g.standard_normal((COORDINATES, COORDINATES)) for _ in range(2))
    axis, tilt = (g.standard_normal((2 * sensors, COORDINATES)) for _ in range(2))
    matrices = Matrices(
        a @ a.T + np.eye(COORDINATES), 0.1 * c @ c.T, c @ c.T, g.standard_normal(COORDINATES), axis, tilt,
        np.zeros(2 * sensors),
    )  # fmt: skip
    runs = (np.arange(sensors), np.arange(sensors, 2 * sensors))
    masses = tuple(g.uniform(0.1, 0.4, sensors) for _ in runs)
    found = accelerances(matrices, OMEGA, runs, masses)
    bare = accelerances(matrices, OMEGA, runs, tuple(np.zeros(sensors) for _ in runs))
    for rows, mass in zip(runs, masses, strict=True):
        wanted = accelerances(loaded_by(matrices, rows, mass), OMEGA, runs, tuple(np.zeros(sensors) for _ in runs))
        np.testing.assert_allclose(found[rows], wanted[rows], rtol=1e-9)
        assert np.abs(found[rows] - bare[rows]).max() > 0.01 * np.abs(bare[rows]).max()
