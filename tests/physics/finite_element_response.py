"""Frequency response of the independent finite-element model, by modes and by direct solve.

Ewins, Modal Testing: Theory, Practice and Application, 2nd ed., 2000, chapter 2.
"""

from __future__ import annotations

import numpy as np
from finite_element import Array
from numpy.typing import NDArray


def modal_damping_matrix(mass: Array, frequency_hz: Array, shapes: Array, damping_ratio: Array) -> Array:
    """C (N, N) that gives each mass-normalised mode (columns of ``shapes``) its damping ratio."""
    weighted = mass @ shapes
    return (weighted * (2 * damping_ratio * 2 * np.pi * frequency_hz)) @ weighted.T


def accelerance_by_modes(
    lines_hz: Array, frequency_hz: Array, shapes: Array, damping_ratio: Array, response: Array, drive: Array
) -> NDArray[np.complex128]:
    """A/F (responses, lines) by superposition; ``response`` (R, N) and ``drive`` (N,) pick motions."""
    omega, natural = 2 * np.pi * lines_hz[:, None], 2 * np.pi * frequency_hz[None, :]
    gain = -(omega**2) / (natural**2 - omega**2 + 2j * damping_ratio * natural * omega)
    return np.asarray(((response @ shapes) * (drive @ shapes)) @ gain.T)


def accelerance_by_solve(
    lines_hz: Array, mass: Array, damping: Array, stiffness: Array, response: Array, drive: Array
) -> NDArray[np.complex128]:
    """A/F (responses, lines) by solving (K + i w C - w^2 M) q = f at each line."""
    columns = []
    for omega in 2 * np.pi * lines_hz:
        motion = np.linalg.solve(stiffness + 1j * omega * damping - omega**2 * mass, drive)
        columns.append(-(omega**2) * (response @ motion))
    return np.array(columns).T
