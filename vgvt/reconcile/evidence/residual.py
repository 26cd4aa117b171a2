"""Is what a fit leaves noise? χ² by run, channel and band, whiteness over frequency, and the part that is smooth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data.shown import counted, headed
from vgvt.reconcile.evidence.strain import strain_sd
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.question.data import Measured
from vgvt.reconcile.question.holdout import Split
from vgvt.reconcile.question.thresholds import SMOOTHED, Limits, Thresholds, limits_for, noise_share

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
_BANDS = 12


@dataclass(frozen=True, slots=True, eq=False)
class Residual:
    """What a model leaves of the data, in standard deviations; 1 is what noise and the model's floor explain.

    ``standardised`` (C, L) complex; ``bands_hz`` (B + 1,); ``table`` (C, B) χ² per degree of freedom by channel
    and band; ``smooth_per_dof`` the same of sums over neighbouring lines, which noise leaves at its own level and
    a missing effect raises; ``lag_one`` the correlation of neighbouring lines; ``share_beyond_three`` of lines beyond
    three standard deviations. ``noise_per_dof``
    is what noise alone leaves, ``held_out_noise_per_dof`` of held-out data, ``limits`` are those of this campaign.
    ``strain_sd`` is what it took of the tolerances to leave no more (:mod:`vgvt.reconcile.evidence.strain`); ``met``
    says that it leaves no more than noise does, ``adequate`` that it did not lean on them for it either.
    """

    labels: tuple[str, ...]
    frequency_hz: Array
    standardised: ComplexArray
    bands_hz: Array
    table: Array
    train_chi2_per_dof: float
    held_out_chi2_per_dof: float | None
    smooth_per_dof: float
    lag_one: float
    between_channels: float
    share_beyond_three: float
    met: bool
    adequate: bool
    reasons: tuple[str, ...]
    limits: Limits
    noise_per_dof: float
    held_out_noise_per_dof: float | None
    strain_sd: float

    @property
    def fitted_adequate(self) -> bool:
        """Whether fitted data are met without leaning on the tolerances, however held-out data are missed."""
        limits = self.limits
        met = self.train_chi2_per_dof <= limits.chi2_per_dof and self.smooth_per_dof <= limits.smooth_per_dof
        return met and self.strain_sd <= limits.strain_sd

    def __repr__(self) -> str:
        held, limits = self.held_out_chi2_per_dof, self.limits
        figures = [("χ² per degree of freedom", self.train_chi2_per_dof, limits.chi2_per_dof)]
        figures += [] if held is None else [("held out", held, limits.held_out_per_dof)]
        figures += [("smooth", self.smooth_per_dof, limits.smooth_per_dof)]
        figures += [("strain of the tolerances", self.strain_sd, limits.strain_sd)]
        size = f"{counted(len(self.labels), 'channel')}, {counted(self.frequency_hz.size, 'line')}"
        told = ", ".join(f"{name} {value:.3g} (limit {limit:.3g})" for name, value, limit in figures)
        return headed(f"Residual, {'adequate' if self.adequate else 'not adequate'}: {size}", (told, *self.reasons))


def residual(fit: Fit, thresholds: Thresholds) -> Residual:
    """The residual of a fit, judged by placebo-calibrated thresholds."""
    measured, parts = fit.problem.measured, fit.problem.split
    rho = (fit.foretold - measured.values) / measured.sigma
    bands = np.quantile(measured.frequency_hz, np.linspace(0, 1, _BANDS + 1))
    train, held = rho[parts.train], rho[parts.held]
    chi2 = float(np.mean(np.abs(train) ** 2))
    held_chi2 = float(np.mean(np.abs(held) ** 2)) if held.size else None
    smooth, strain = smooth_part(train), strain_sd(fit)
    limits = limits_for(thresholds, measured, parts)
    left = _reasons(chi2, held_chi2, smooth, limits)
    reasons = (*left, *_of_strain(strain, limits))
    return Residual(
        tuple(c.label for c in measured.channels), measured.frequency_hz, rho, bands, _table(rho, measured, bands),
        chi2, held_chi2, smooth, lag_one(train), _between(rho, measured, parts),
        float(np.mean(np.abs(rho[measured.used]) > 3)),
        not left, not reasons, reasons, limits, noise_share(measured, parts.train).noise,
        noise_share(measured, parts.held).noise if held.size else None, strain,
    )  # fmt: skip


def smooth_part(standardised: ComplexArray, window: int = SMOOTHED) -> float:
    """Mean square of sums over ``window`` neighbouring lines by root of the window; the mean square for white noise."""
    count = standardised.shape[1] // window
    if count == 0:
        return float(np.mean(np.abs(standardised) ** 2))
    sums = standardised[:, : count * window].reshape(standardised.shape[0], count, window).sum(axis=2)
    return float(np.mean(np.abs(sums) ** 2) / window)


def lag_one(standardised: ComplexArray) -> float:
    """Correlation of neighbouring lines of standardised residuals (C, L)."""
    if standardised.size == 0:
        return 0.0
    product = np.mean((standardised[:, 1:] * standardised[:, :-1].conj()).real)
    return float(product / np.mean(np.abs(standardised) ** 2))


def independent_values(standardised: ComplexArray) -> float:
    """Real values that a residual (C, L) is worth, from its correlation over lines and the rank over channels."""
    count, lines = standardised.shape
    power = float(np.mean(np.abs(standardised) ** 2))
    length = 1.0
    for lag in range(1, min(60, lines // 4)):
        value = float(np.mean((standardised[:, lag:] * standardised[:, :-lag].conj()).real)) / power
        if value < 0.1:
            break
        length += 2 * value
    spectrum = np.linalg.eigvalsh((standardised @ standardised.conj().T).real)
    rank: float = float(spectrum.sum()) ** 2 / float(np.sum(spectrum**2))
    # Random noise itself spreads the eigenvalues: this is what white channels give, real parts of two values a line.
    rank = min(float(count), rank * (1 + count / (2 * lines)))
    return float(2 * lines / length * rank)


def _table(rho: ComplexArray, measured: Measured, bands: Array) -> Array:
    index = np.clip(np.searchsorted(bands, measured.frequency_hz, side="right") - 1, 0, _BANDS - 1)
    return np.array([[np.mean(np.abs(row[index == b]) ** 2) for b in range(_BANDS)] for row in rho])


def _between(rho: ComplexArray, measured: Measured, parts: Split) -> float:
    """Mean correlation of the channels of a run."""
    runs = np.array([c.run for c in measured.channels])
    found = []
    for r in np.unique(runs):
        rows = rho[(runs == r) & parts.train]
        for a in range(len(rows)):
            for b in range(a + 1, len(rows)):
                scale = np.sqrt(np.mean(np.abs(rows[a]) ** 2) * np.mean(np.abs(rows[b]) ** 2))
                found.append(float(np.abs(np.mean(rows[a] * rows[b].conj())) / scale))
    return float(np.mean(found)) if found else 0.0


def _reasons(chi2: float, held: float | None, smooth: float, t: Limits) -> tuple[str, ...]:
    found = []
    if chi2 > t.chi2_per_dof:
        found.append(
            f"the fit leaves {chi2:.2f} per degree of freedom; where nothing is missing, this campaign's noise and "
            f"the stated model error leave at most {t.chi2_per_dof:.2f}"
        )
    if smooth > t.smooth_per_dof:
        found.append(
            f"what is left is smooth over frequency ({smooth:.2f}; noise leaves at most {t.smooth_per_dof:.2f})"
        )
    if held is not None and held > t.held_out_per_dof:
        found.append(f"held-out data are missed by {held:.2f} per degree of freedom (at most {t.held_out_per_dof:.2f})")
    return tuple(found)


def _of_strain(strain: float, t: Limits) -> tuple[str, ...]:
    if strain <= t.strain_sd:
        return ()
    return (
        f"the quantities that are stated with a tolerance lean on it, all together by {strain:.1f} standard "
        f"deviations more than chance (at most {t.strain_sd:.1f})",
    )
