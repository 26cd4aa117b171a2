"""Slopes of A/F by the adjoint against differences, for any matrices: every term as large as the others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from vgvt.reconcile.mechanics.ending import accelerance_slopes
from vgvt.reconcile.mechanics.response import Matrices, Slopes, accelerances

COORDINATES, ROWS, LINES, PARAMETERS = 5, 6, 9, 4
RUNS = (np.array([0, 1, 2]), np.array([3, 4, 5]))
OMEGA = np.linspace(0.4, 2.0, LINES)
NAMES = ("mass", "damping", "stiffness", "drive", "axis", "tilt", "spare")


def drawn(seed: int, masses: float) -> tuple[Matrices, Slopes, np.ndarray]:
    """A damped structure, its changes in some parameters, and what its sensors weigh."""
    g = np.random.default_rng(seed)

    def square() -> np.ndarray:
        a = g.standard_normal((COORDINATES, COORDINATES))
        return np.asarray(a @ a.T / COORDINATES)

    shapes = {"drive": (COORDINATES,), "axis": (ROWS, COORDINATES), "tilt": (ROWS, COORDINATES)}
    rest = {n: g.standard_normal(s) for n, s in shapes.items()}
    spare = 0.1 * g.standard_normal(ROWS)
    matrices = Matrices(square() + np.eye(COORDINATES), 0.5 * square(), square(), **rest, spare=spare)
    changes = {n: g.standard_normal((PARAMETERS, *getattr(matrices, n).shape)) for n in NAMES}
    return (
        matrices,
        Slopes(**changes, masses_kg=masses * g.standard_normal((PARAMETERS, ROWS))),
        masses * g.uniform(0.5, 1.0, ROWS),
    )


def twins(matrices: Matrices) -> Matrices:
    """Two coordinates that do not know of each other and are alike: each pole of theirs is there twice."""
    square = {n: getattr(matrices, n).copy() for n in ("mass", "damping", "stiffness")}
    for changed, value in zip(square.values(), (1.5, 0.2, 1.1), strict=True):
        changed[:2] = changed[:, :2] = 0.0
        changed[0, 0] = changed[1, 1] = value
    return replace(matrices, **square)


def overdamped(matrices: Matrices) -> Matrices:
    return replace(matrices, damping=40 * matrices.damping)


@pytest.mark.parametrize("masses", [0.0, 0.3])
@pytest.mark.parametrize("made", [lambda m: m, twins, overdamped])
def test_every_term_agrees_with_differences(masses: float, made: Callable[[Matrices], Matrices]) -> None:
    matrices, slopes, own = drawn(1, masses)
    matrices = made(matrices)
    found = accelerance_slopes(matrices, OMEGA, RUNS, tuple(own[r] for r in RUNS), slopes)
    step = 1e-5
    for k in range(PARAMETERS):
        sides = []
        for sign in (1, -1):
            moved = {n: getattr(matrices, n) + sign * step * getattr(slopes, n)[k] for n in NAMES}
            there = own + sign * step * slopes.masses_kg[k]
            sides.append(accelerances(replace(matrices, **moved), OMEGA, RUNS, tuple(there[r] for r in RUNS)))
        np.testing.assert_allclose(found[k], (sides[0] - sides[1]) / (2 * step), rtol=1e-5, atol=1e-6)
