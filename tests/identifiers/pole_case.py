"""Five responses of four modes, two of them closer than their widths, as lines of a swept force."""

from __future__ import annotations

import numpy as np

from vgvt_identifiers.pole_fit import FitRows, PoleProblem

FREQUENCY = np.arange(4.0, 20.0, 1 / 20)
S = 2j * np.pi * FREQUENCY
FORCE = 10.0 * np.exp(-1j * np.pi * (FREQUENCY - 4.0) ** 2 * 20 / 16)


def poles_of(frequency_hz: list[float], damping: list[float]) -> np.ndarray:
    """Poles (N,), rad/s."""
    omega, ratio = 2 * np.pi * np.array(frequency_hz), np.array(damping)
    return np.asarray(omega * (-ratio + 1j * np.sqrt(1 - ratio**2)))


POLES = poles_of([7.0, 11.0, 11.2, 16.0], [0.02, 0.01, 0.012, 0.0005])
GAINS = np.random.default_rng(1).uniform(0.3, 1.0, (5, 4)) * np.array([1, -1, 1, 1]) / (2j * POLES.imag)
GAINS[3:, 1] *= -1


def accelerance(poles: np.ndarray, gains: np.ndarray) -> np.ndarray:
    """A/F (responses, lines) of modes with residues (responses, N)."""
    parts = gains[:, :, None] / (S - poles[:, None]) + gains.conj()[:, :, None] / (S - poles.conj()[:, None])
    return np.asarray(S**2 * parts.sum(axis=1))


def problem(values: np.ndarray, std: float | np.ndarray = 0.01, own: bool = False) -> PoleProblem:
    """Rows with weights 1 / std; with ``own`` one row of weights for each response, though they are the same."""
    rows = values.shape[0] if own else 1
    weight = np.broadcast_to(1 / np.asarray(std), (rows, FREQUENCY.size))
    return PoleProblem(FREQUENCY, (FitRows(values, weight, np.ones(values.shape[0]), 1 / FORCE),))
