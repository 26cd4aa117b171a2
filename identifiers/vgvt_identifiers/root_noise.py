"""What the noise of frequency response lines does to the roots of an impulse response, to first order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.impulse import ImpulseResponses


@dataclass(frozen=True, slots=True, eq=False)
class PoleSpread:
    """Poles (n,) in rad/s with the variances (n,) of their real and imaginary parts and their covariance."""

    poles: NDArray[np.complex128]
    real: NDArray[np.float64]
    imaginary: NDArray[np.float64]
    both: NDArray[np.float64]

    @property
    def frequency_std_hz(self) -> NDArray[np.float64]:
        """Standard deviation (n,) of the natural frequency |p| / 2 pi."""
        cosine, sine = self.poles.real / abs(self.poles), self.poles.imag / abs(self.poles)
        return self._std(cosine, sine) / (2 * np.pi)

    @property
    def damping_ratio_std(self) -> NDArray[np.float64]:
        """Standard deviation (n,) of the damping ratio -Re p / |p|."""
        cube = np.abs(self.poles) ** 3
        return self._std(-(self.poles.imag**2) / cube, self.poles.real * self.poles.imag / cube)

    def _std(self, by_real: NDArray[np.float64], by_imaginary: NDArray[np.float64]) -> NDArray[np.float64]:
        variance = by_real**2 * self.real + by_imaginary**2 * self.imaginary + 2 * by_real * by_imaginary * self.both
        return np.asarray(np.sqrt(np.maximum(variance, 0)))


def pole_spread(
    roots: NDArray[np.complex128],
    sensitivity: NDArray[np.complex128],
    impulse: ImpulseResponses,
    variance: NDArray[np.float64],
) -> PoleSpread:
    """Spread of the poles of discrete ``roots`` (n,) from ``variance`` E|e|^2 (R, K) of the lines of the responses.

    ``sensitivity`` (n, R, N) is that of :class:`Roots`. Errors of different lines and
    responses count as independent and circular; a line with infinite variance counts for nothing.
    """
    power = np.where(np.isfinite(variance), variance, 0.0) * impulse.window**2
    spectrum = np.fft.fft(sensitivity, impulse.period, axis=2)
    above, below = spectrum[:, :, -impulse.lines], spectrum[:, :, impulse.lines]
    scale = 1 / (impulse.period * impulse.step_s) ** 2
    # de = sum of W (e G(+) + e* G(-)): its E|.|^2 and E(.)^2 give the two variances and the covariance.
    absolute = np.einsum("rk,nrk->n", power, np.abs(above) ** 2 + np.abs(below) ** 2) * scale
    square = 2 * np.einsum("rk,nrk->n", power, above * below) * scale
    factor = 1 / (roots * impulse.step_s)
    absolute, square = absolute * np.abs(factor) ** 2, square * factor**2
    return PoleSpread(
        impulse.structure_poles(roots), (absolute + square.real) / 2, (absolute - square.real) / 2, square.imag / 2
    )
