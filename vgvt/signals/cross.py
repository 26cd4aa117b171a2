"""Cross spectra of one response with its references, summed over segments and runs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_TAPS = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
_WIDTH = 25  # lines over which noise counts as equal
_MOST_OF_LEAST = 3.0  # chance makes two such medians differ by more at one line in twenty, which costs 2 % at most
_MEDIAN_OF_ROUGH = 0.739  # of 25 neighbours |d|²/E|d|², whose fourth differences d share lines; ln 2 for very many


@dataclass(frozen=True, slots=True, eq=False)
class CrossSpectra:
    """Sums over all averages, for one response X and R references F, over L lines.

    ``reference`` (R, R, L) is sum F_i F_j*, ``cross`` (R, L) is sum X F_j*,
    ``response`` (L,) is sum |X|^2. ``averages`` counts what independent averages
    they are worth, all lines alike or each for itself (L,).
    ``noise`` (L,), for one reference, is the sum of |F|^2 times the noise power of X.
    """

    first_run: int
    averages: float | NDArray[np.float64]
    reference: NDArray[np.complex128]
    cross: NDArray[np.complex128]
    response: NDArray[np.float64]
    noise: NDArray[np.float64] | None = None

    def plus(self, other: CrossSpectra) -> CrossSpectra:
        """The sums over the averages of both."""
        return CrossSpectra(
            self.first_run,
            self.averages + other.averages,
            self.reference + other.reference,
            self.cross + other.cross,
            self.response + other.response,
            None if self.noise is None or other.noise is None else self.noise + other.noise,
        )

    def h1(self) -> NDArray[np.complex128]:
        """Least squares with all noise on the response, (R, L): S_xf S_ff^-1; NaN where there is no force."""
        if self.reference.shape[0] == 1:
            power = self.reference[0, 0].real
            blank = np.full_like(self.cross, np.nan)
            return np.asarray(np.divide(self.cross, power, out=blank, where=power > 0))
        return np.asarray(np.einsum("jl,lji->il", self.cross, self._inverse()))

    def h2(self) -> NDArray[np.complex128]:
        """Least squares with all noise on the one reference, (1, L): S_xx / S_fx."""
        below = self.cross[0].conj()
        blank = np.full_like(self.cross, np.nan)
        return np.asarray(np.divide(self.response[None], below[None], out=blank, where=np.abs(below)[None] > 0))

    def hv(self) -> NDArray[np.complex128]:
        """Total least squares for one reference, (1, L), both signals scaled to their own power.

        Then it is the geometric mean of H1 and H2. Rocklin, Crowley and Vold,
        A comparison of H1, H2 and Hv frequency response functions, IMAC III, 1985.
        """
        power = self.reference[0, 0].real
        size = np.sqrt(np.divide(self.response, power, out=np.full_like(power, np.nan), where=power > 0))
        return np.asarray(size * np.exp(1j * np.angle(self.cross)))

    def coherence(self) -> NDArray[np.float64]:
        """Ordinary (one reference) or multiple coherence with all references, (L,), 0..1."""
        explained = (self.h1() * self.cross.conj()).real.sum(axis=0)
        ratio = np.divide(explained, self.response, out=np.zeros_like(explained), where=self.response > 0)
        return np.asarray(np.clip(ratio, 0.0, 1.0))

    def variance(self, values: NDArray[np.complex128]) -> NDArray[np.float64]:
        """Variance E|G - EG|^2 (R, L) of ``values`` (R, L), H1 or H2, from the scatter over the averages.

        |G|^2 (1 - coherence) / (coherence (n - R)); Bendat and Piersol, Random
        Data, 4th ed., chapter 9, with the degrees of freedom that the fit uses taken off. Of H2, whose error is that of
        the response's power less that of the cross spectrum, it is the same part.
        """
        first, freedom = self.h1(), np.asarray(self.averages - self.reference.shape[0], dtype=float)
        # A line without an average to spare does not know its scatter.
        unexplained = self.response * (1 - self.coherence()) / np.where(freedom > 0, freedom, np.nan)
        if self.reference.shape[0] == 1:
            spread = unexplained / self.reference[0, 0].real
            enlarged = np.divide(np.abs(values), np.abs(first), out=np.ones(first.shape), where=np.abs(first) > 0)
            return np.asarray(spread * enlarged**2)
        return np.asarray(unexplained * np.einsum("lii->il", self._inverse()).real)

    def hv_variance(self) -> NDArray[np.float64]:
        """Variance E|G - EG|^2 (1, L) of ``hv`` from the scatter over the averages.

        |G|^2 (1 - coherence) (1 + 1 / coherence) / (2 (n - 1)): of log G the real part, half the difference of two log
        powers, has variance (1 - coherence) / 2n, and the imaginary part, the phase of the cross spectrum,
        (1 - coherence) / (2n coherence); both follow from the covariances of spectra of Gaussian signals,
        Bendat and Piersol, Random Data, 4th ed., chapter 9. Where the force repeats itself exactly and only the
        response is noisy it is up to a tenth too large.
        """
        return np.asarray(self.variance(self.hv()) * (1 + self.coherence()) / 2)

    def rough_variance(self, values: NDArray[np.complex128]) -> NDArray[np.float64] | None:
        """Variance (R, L) of ``values`` (R, L) on neighbouring lines, from what is not smooth in them; None for few.

        The fourth difference over lines leaves noise and hardly any of a structure's answer. Weighted by what every
        line owes to its forces it is the noise of the response, a median over 25 lines. Every reference knows that
        noise alike, and theirs are averaged: the least of several such medians would be too small. What is several
        times as rough in one of them is no noise but a resonance narrower than those lines, and counts no further.
        """
        from scipy.ndimage import median_filter

        lines = values.shape[1]
        if lines < 2 * _WIDTH or not np.isfinite(values).all():
            return None
        per_noise = np.einsum("lii->il", self._inverse()).real
        difference = sum(tap * values[:, i : lines - 4 + i] for i, tap in enumerate(_TAPS))
        spread = sum(tap**2 * per_noise[:, i : lines - 4 + i] for i, tap in enumerate(_TAPS))
        rough = np.pad(np.abs(np.asarray(difference)) ** 2 / spread, ((0, 0), (2, 2)), mode="edge")
        noise = [median_filter(row, size=_WIDTH, mode="nearest") / _MEDIAN_OF_ROUGH for row in rough]
        smooth = np.minimum(noise, _MOST_OF_LEAST * np.min(noise, axis=0))
        return np.asarray(smooth.mean(axis=0) * per_noise)

    def _inverse(self) -> NDArray[np.complex128]:
        inverse = np.asarray(np.linalg.pinv(self.reference.transpose(2, 0, 1), hermitian=True), dtype=np.complex128)
        inverse[~np.einsum("iil->il", self.reference).any(axis=0)] = np.nan
        return inverse
