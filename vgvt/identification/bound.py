"""The Cramér-Rao bound of an example: how well anybody could know its modes from its noisy records.

For white noise of known level the Fisher information is J^T J / s^2, with J the
derivatives of all clean records by all unknowns: frequencies, damping ratios and
a complex gain per mode and response. Kay, Fundamentals of Statistical Signal
Processing: Estimation Theory, 1993, chapter 3. The structure starts from rest and the
force is known without error, which is the best case for any method.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.identification.example import Example

_STEP = 1e-6


def cramer_rao_bound(example: Example) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Smallest standard deviations of natural frequencies in Hz and of damping ratios, (M,) each, over all runs.

    ValueError for an example without noise, or with noise of the force, which this bound leaves out.
    """
    if not example.noise_m_s2 > 0 or example.force_noise_n > 0:
        raise ValueError("the bound needs noise on the responses, and none on the force")
    modes = len(example.frequency_hz)
    by_pole = np.array([_slope(example, hertz, mode) for hertz in (True, False) for mode in range(modes)])
    by_gain = np.array([_gain_slope(example, part, mode) for part in (1, 1j) for mode in range(modes)])
    information = np.zeros((2 * modes, 2 * modes))
    for response in range(by_pole.shape[1]):
        slopes = by_pole[:, response].T
        basis = np.linalg.qr(by_gain.T)[0]
        free = slopes - basis @ (basis.T @ slopes)
        information += free.T @ free / example.noise_m_s2**2
    size = np.sqrt(np.diag(information))
    variance = np.diag(np.linalg.inv(information / size[:, None] / size)) / size**2
    return np.sqrt(variance[:modes]), np.sqrt(variance[modes:])


def _slope(example: Example, hertz: bool, mode: int) -> NDArray[np.float64]:
    """Derivative of the clean accelerations (responses, samples), gains held, by a frequency or a damping ratio."""
    values = np.array(example.frequency_hz if hertz else example.damping_ratio)
    step = _STEP * values[mode]
    sides = []
    for sign in (1, -1):
        moved = values.copy()
        moved[mode] += sign * step
        changed = replace(example, frequency_hz=tuple(moved)) if hertz else replace(example, damping_ratio=tuple(moved))
        sides.append(changed._accelerations(example._force(), example._gains()))
    return np.asarray((sides[0] - sides[1]) / (2 * step))


def _gain_slope(example: Example, part: complex, mode: int) -> NDArray[np.float64]:
    """Derivative (samples,) of a response by the real or the imaginary ``part`` of its gain of one mode."""
    gains = np.zeros((len(example.frequency_hz), len(example.dofs)), complex)
    gains[mode] = part
    return np.asarray(example._accelerations(example._force(), gains)[0])
