"""Slopes by partial fractions, and by the adjoint line by line; run with `pytest tests/benchmarks --benchmark-only`.

Of ten runs with two sensors each, eighteen coordinates, fifty parameters, five hundred lines: quote the ratio.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from vgvt.reconcile.mechanics.ending import accelerance_slopes
from vgvt.reconcile.mechanics.level_slopes import _by_real
from vgvt.reconcile.mechanics.response import Matrices, Slopes, loaded_by

M, K, RUNS, EACH, LINES = 18, 50, 10, 2, 500
OMEGA = np.linspace(0.3, 3.0, LINES)
ROWS = tuple(np.arange(EACH) + EACH * r for r in range(RUNS))
Case = tuple[Matrices, tuple[np.ndarray, ...], Slopes]


@pytest.fixture(scope="module")
def case() -> Case:
    """A lightly damped structure, its sensors' masses and its changes in some parameters."""
    g = np.random.default_rng(4)

    def square() -> np.ndarray:
        a = g.standard_normal((M, M))
        return np.asarray(a @ a.T / M)

    shapes = {"drive": (M,), "axis": (EACH * RUNS, M), "tilt": (EACH * RUNS, M)}
    rest = {n: g.standard_normal(s) for n, s in shapes.items()}
    matrices = Matrices(square() + np.eye(M), 0.02 * square(), square(), **rest, spare=np.zeros(EACH * RUNS))
    names = ("mass", "damping", "stiffness", *shapes)
    changes = {n: g.standard_normal((K, *getattr(matrices, n).shape)) for n in names}
    masses = tuple(g.uniform(0.01, 0.02, EACH) for _ in ROWS)
    return matrices, masses, Slopes(**changes, masses_kg=0.01 * g.standard_normal((K, EACH * RUNS)))


def line_by_line(matrices: Matrices, masses: tuple[np.ndarray, ...], slopes: Slopes) -> np.ndarray:
    """The adjoint: p (dh - dZ q) + db q at every line, where Z q = h and p Z = b, of the structure with its sensors."""
    out = np.empty((K, EACH * RUNS, LINES), dtype=complex)
    s = 1j * OMEGA[:, None]
    joined = np.concatenate([slopes.stiffness, slopes.damping, slopes.mass], axis=2)
    changes = np.ascontiguousarray(joined.reshape(K * M, 3 * M).T)
    for rows, mass in zip(ROWS, masses, strict=True):
        there = loaded_by(matrices, rows, mass)
        z = there.stiffness + s[:, :, None] * there.damping + s[:, :, None] ** 2 * there.mass
        inverse = np.linalg.inv(z)
        q = inverse @ there.drive
        adjoint = (s[:, :, None] ** 2 * there.axis[rows] + there.tilt[rows]) @ inverse
        right = slopes.drive - (np.concatenate([q, s * q, s**2 * q], axis=1) @ changes).reshape(LINES, K, M)
        moved = np.einsum("kam,lm->lka", slopes.axis[:, rows], q, optimize=True)
        here = q @ there.axis[rows].T
        right -= s[:, :, None] ** 2 * (
            np.einsum("kam,la->lkm", slopes.axis[:, rows], mass * here, optimize=True)
            + (mass * moved + slopes.masses_kg[:, rows] * here[:, None]) @ there.axis[rows]
        )
        read = right @ adjoint.transpose(0, 2, 1) + s[:, :, None] ** 2 * moved
        read += np.einsum("kam,lm->lka", slopes.tilt[:, rows], q, optimize=True)
        out[:, rows] = read.transpose(1, 2, 0)
    return out


@pytest.mark.benchmark(group="slopes of twenty accelerances")
def test_line_by_line(benchmark: BenchmarkFixture, case: Case) -> None:
    assert benchmark(line_by_line, *case).shape == (K, EACH * RUNS, LINES)


@pytest.mark.benchmark(group="slopes of twenty accelerances")
def test_by_partial_fractions(benchmark: BenchmarkFixture, case: Case) -> None:
    matrices, masses, slopes = case
    found = benchmark(accelerance_slopes, matrices, OMEGA, ROWS, masses, slopes)
    wanted = line_by_line(*case)
    np.testing.assert_allclose(found, wanted, atol=1e-8 * np.abs(wanted).max())


@pytest.mark.parametrize("multiplied", [np.matmul, _by_real], ids=["as complex", "as real"])
@pytest.mark.benchmark(group="a law's slopes: what moves at every line, times what parameters change")
def test_complex_values_times_a_real_matrix(benchmark: BenchmarkFixture, multiplied: Callable[..., np.ndarray]) -> None:
    g = np.random.default_rng(4)
    values, matrix = g.standard_normal((2, LINES, 3 * M)), g.standard_normal((3 * M, K * M))
    found = benchmark(multiplied, values[0] + 1j * values[1], matrix)
    assert found.shape == (LINES, K * M)
