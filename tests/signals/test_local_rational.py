"""The local rational method on systems of one and two modes, exact, noisy and with too few lines."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.signals.local_polynomial import local_polynomial_fit
from vgvt.signals.local_rational import RunLines, local_rational_fit, rational_half_width

STEP, LINES = 0.05, 400
FREQUENCY = np.arange(LINES) * STEP
POLES = 2j * np.pi * np.array([8.0, 8.3]) * (1 + 0.005j)  # half-power widths of 1.6 lines, six lines apart


def responses(frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Three responses to two forces, (3, 2, lines)."""
    generator = np.random.default_rng(4)
    shapes = generator.standard_normal((2, 3))
    drives = generator.standard_normal((2, 2))
    gain = 1 / (2j * np.pi * frequency - POLES[:, None])
    return np.einsum("mc,mr,ml->crl", shapes, drives, gain)


def run(seed: int, noise: float = 0.0, step: float = STEP, forces: int = 2) -> RunLines:
    """Two random forces, what follows them, smooth leakage and noise."""
    generator = np.random.default_rng(seed)
    frequency = np.arange(round(LINES * STEP / step)) * step
    drawn = generator.standard_normal((forces + 3, 2, frequency.size))
    force, error = (drawn[:forces, 0] + 1j * drawn[:forces, 1]), drawn[forces:, 0] + 1j * drawn[forces:, 1]
    force = np.array([force[0], force[-1]])
    leaked = 3 / (2j * np.pi * frequency - POLES[0])
    moved = np.einsum("crl,rl->cl", responses(frequency), force) + leaked + noise / np.sqrt(2) * error
    return RunLines(step, force, moved)


def test_two_narrow_modes_in_one_window_are_followed() -> None:
    """Where a polynomial over the same lines is wrong by a tenth and more, the ratio is right to a thousandth."""
    at = FREQUENCY[100:240]
    record = run(1)
    half = rational_half_width(2, 1)
    fit = local_rational_fit([record], at, half_width=half)
    exact = responses(at)
    size = np.sqrt((np.abs(exact) ** 2).mean())
    assert np.sqrt((np.abs(fit.values - exact) ** 2).mean()) < 1e-3 * size
    plain = local_polynomial_fit(record.responses, record.references, np.arange(100, 240), half_width=half)
    assert np.sqrt((np.abs(plain.values - exact) ** 2).mean()) > 0.1 * size


def test_the_variance_is_the_mean_square_error() -> None:
    """Of 40 draws of 54 values at lines 14 apart, within a sixth."""
    at = FREQUENCY[110:240:14]
    exact = responses(at)
    fits = [local_rational_fit([run(seed, 0.02)], at, half_width=10) for seed in range(40)]
    ratio = np.mean([(np.abs(f.values - exact) ** 2 / f.variance).mean() for f in fits])
    assert ratio == pytest.approx(1.0, rel=1 / 6)


def test_runs_with_lines_of_their_own_are_one_fit() -> None:
    """One run has 1.3 times as many lines as the other; either drives the same way throughout, so neither suffices."""
    at = FREQUENCY[110:240:3]
    runs = []
    for seed, step, sign in ((1, STEP, 1.0), (2, STEP / 1.3, -1.0)):
        one = run(seed, step=step, forces=1)
        frequency = np.arange(one.references.shape[1]) * step
        forces = one.references * np.array([[1.0], [sign]])
        runs.append(RunLines(step, forces, np.einsum("crl,rl->cl", responses(frequency), forces)))
    fit = local_rational_fit(runs, at, half_width=8)
    np.testing.assert_allclose(fit.values, responses(at), rtol=0.02, atol=1e-2)
    assert np.isnan(local_rational_fit(runs[:1], at, half_width=10).values).all()


def test_a_record_shorter_than_the_window_is_refused() -> None:
    record = run(1)
    short = RunLines(STEP, record.references[:, :20], record.responses[:, :20])
    with pytest.raises(InputError, match="19 frequency lines, the window needs 21"):
        local_rational_fit([short], FREQUENCY[5:10], half_width=10)
    with pytest.raises(ValueError, match="cannot hold the unknowns"):
        local_rational_fit([record], FREQUENCY[100:110], half_width=5)
