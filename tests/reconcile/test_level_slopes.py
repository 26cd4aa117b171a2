"""Slopes of responses that depend on level against differences of the responses themselves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from vgvt.reconcile.mechanics.level_slopes import level_accelerance_slopes
from vgvt.reconcile.mechanics.response import Matrices, Slopes
from vgvt.reconcile.prediction.levels import Joints, level_accelerances

Array = NDArray[np.float64]
COORDINATES, SENSORS, JOINTS, RUNS = 5, 4, 2, (np.array([0, 1]), np.array([2, 3]))
OMEGA = 2 * np.pi * np.linspace(2, 30, 25)
STEP = 1e-6


def case(roving: bool) -> tuple[Matrices, Joints, NDArray[np.complex128], tuple[Array, ...]]:
    """A structure, what its joints show in two runs, and the sensors' masses; nothing in it is zero by chance."""
    g = np.random.default_rng(8)
    a, b = g.standard_normal((2, COORDINATES, COORDINATES))
    matrices = Matrices(
        b @ b.T + np.eye(COORDINATES), 0.5 * np.eye(COORDINATES), 4000 * (a @ a.T + np.eye(COORDINATES)),
        g.standard_normal(COORDINATES), g.standard_normal((SENSORS, COORDINATES)),
        g.standard_normal((SENSORS, COORDINATES)), 1e-4 * g.standard_normal(SENSORS),
    )  # fmt: skip
    between = 1e-4 * g.standard_normal((JOINTS, JOINTS))
    joints = Joints(
        ((), ()), g.standard_normal((JOINTS, COORDINATES)), 1e-4 * g.standard_normal(JOINTS),
        1e-4 * g.standard_normal((SENSORS, JOINTS)), between + between.T,
    )  # fmt: skip
    shown = 300 * (g.standard_normal((2, JOINTS, OMEGA.size)) + 0.3j * g.standard_normal((2, JOINTS, OMEGA.size)))
    masses = (np.array([0.02, 0.03]), np.array([0.05, 0.01])) if roving else (np.zeros(2), np.zeros(2))
    return matrices, joints, shown, masses


def along(name: str, roving: bool) -> tuple[Slopes, NDArray[np.complex128], Callable[[float], NDArray[np.complex128]]]:
    """One matrix moved in a random direction: slopes that say so, those of the joints, and the response there."""
    matrices, joints, shown, masses = case(roving)
    g = np.random.default_rng(9)
    parts = {f.name: np.zeros((1, *getattr(matrices, f.name).shape)) for f in fields(matrices)}
    heavier, firmer = np.zeros((1, SENSORS)), np.zeros((1, *shown.shape), dtype=complex)
    if name == "masses":
        heavier += g.standard_normal((1, SENSORS))
    elif name == "joints":
        firmer += 100 * (g.standard_normal(firmer.shape) + 1j * g.standard_normal(firmer.shape))
    else:
        parts[name] += g.standard_normal(parts[name].shape) * np.abs(getattr(matrices, name)).mean()

    def response(step: float) -> NDArray[np.complex128]:
        there = replace(matrices, **{n: getattr(matrices, n) + step * p[0] for n, p in parts.items()})
        loads = tuple(m + step * heavier[0, rows] for m, rows in zip(masses, RUNS, strict=True))
        return level_accelerances(there, joints, shown + step * firmer[0], OMEGA, RUNS, loads)

    return Slopes(**parts, masses_kg=heavier), firmer, response


@pytest.mark.parametrize("roving", [True, False])
@pytest.mark.parametrize("name", ["mass", "damping", "stiffness", "drive", "axis", "tilt", "spare", "masses", "joints"])
def test_slopes_are_differences_of_the_response(name: str, roving: bool) -> None:
    slopes, firmer, response = along(name, roving)
    matrices, joints, shown, masses = case(roving)
    found = level_accelerance_slopes(matrices, joints, shown, firmer, OMEGA, RUNS, masses, slopes)[0]
    wanted = (response(STEP) - response(-STEP)) / (2 * STEP)
    assert np.linalg.norm(wanted) > 0
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-5 * np.abs(wanted).max())
