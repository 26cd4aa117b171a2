"""Many weighted rows on one design, each against a least-squares solver that knows nothing of the others."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt_identifiers.weighted_rows import solve_rows

LINES, COLUMNS = 80, 7


def problem(rows: int, decades: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Design (K, m), values (R, K) and variances (R, K) that span ``decades`` from line to line."""
    generator = np.random.default_rng(rows)
    design = generator.standard_normal((LINES, COLUMNS)) + 1j * generator.standard_normal((LINES, COLUMNS))
    design *= 10.0 ** np.arange(-3, 4)
    values = generator.standard_normal((rows, LINES)) + 1j * generator.standard_normal((rows, LINES))
    return design, values, 10 ** generator.uniform(-decades, 0, (rows, LINES))


def alone(design: np.ndarray, value: np.ndarray, variance: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Coefficients, their variance and chi-square a freedom by `numpy.linalg.lstsq` and the covariance's definition."""
    keep = np.isfinite(variance)
    weight = np.tile(np.sqrt(2 / variance[keep]), 2)
    matrix = weight[:, None] * np.vstack([design.real[keep], design.imag[keep]])
    right = weight * np.concatenate([value.real[keep], value.imag[keep]])
    found = np.linalg.lstsq(matrix, right, rcond=1e-14)[0]
    size = np.linalg.norm(matrix, axis=0)
    covariance = np.linalg.pinv((matrix / size).T @ (matrix / size)) / np.outer(size, size)
    freedom = max(right.size - np.linalg.matrix_rank(matrix / size), 1)
    return found, np.diag(covariance), float(((right - matrix @ found) ** 2).sum() / freedom)


@pytest.mark.parametrize("rows", [1, 2, 6])
@pytest.mark.parametrize("decades", [0.0, 2.0, 10.0])
def test_every_row_is_the_one_of_its_own_least_squares(rows: int, decades: float) -> None:
    design, values, variance = problem(rows, decades)
    solved = solve_rows(design, values, variance)
    for row in range(rows):
        found, spread, chi_square = alone(design, values[row], variance[row])
        np.testing.assert_allclose(solved.coefficients[row], found, rtol=1e-8)
        np.testing.assert_allclose(solved.variance[row], spread, rtol=1e-8)
        np.testing.assert_allclose(solved.chi_square[row], chi_square, rtol=1e-8)


def test_lines_that_one_row_lacks_change_no_other_row() -> None:
    design, values, variance = problem(4, 1.0)
    whole = solve_rows(design, values, variance)
    variance[1, 10:40], variance[3] = np.inf, np.inf
    cut = solve_rows(design, values, variance)
    np.testing.assert_allclose(cut.coefficients[[0, 2]], whole.coefficients[[0, 2]], rtol=1e-9)
    np.testing.assert_allclose(cut.coefficients[1], alone(design, values[1], variance[1])[0], rtol=1e-9)
    assert not cut.coefficients[3].any()


def test_a_column_that_another_makes_up_shares_with_it() -> None:
    design, values, variance = problem(5, 0.0)
    design = np.hstack([design, design[:, :1]])
    solved = solve_rows(design, values, variance)
    np.testing.assert_allclose(solved.coefficients[:, 0], solved.coefficients[:, -1], rtol=1e-9)
    for row in range(5):
        found = alone(design[:, :-1], values[row], variance[row])[0]
        np.testing.assert_allclose(2 * solved.coefficients[row, 0], found[0], rtol=1e-9)
