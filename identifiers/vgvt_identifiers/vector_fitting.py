"""Vector fitting: rational functions of several orders with common poles, relocated until they settle.

Gustavsen and Semlyen, IEEE Trans. Power Delivery 14(3), 1999, with the noise
as weight and the ends of records modelled; poles that are stable over the orders are the modes.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, InputError, ModalModel, Outcome
from vgvt.identification import Needs
from vgvt_identifiers.common_modes import RunModes
from vgvt_identifiers.merged_claim import merged_claim
from vgvt_identifiers.non_modes import flag_non_modes
from vgvt_identifiers.rational_fit import Block, RationalFit, fit_rational
from vgvt_identifiers.residues import Residues, fit_residues
from vgvt_identifiers.spectra import FEWEST_LINES, CampaignSpectra, RunSpectra, campaign_spectra
from vgvt_identifiers.stabilisation import Criteria, PolesAtOrder, Stabilisation, stabilise

_CITATION = """\
@article{gustavsen1999rational,
  author = {Gustavsen, Bj{\\o}rn and Semlyen, Adam},
  title = {Rational Approximation of Frequency Domain Responses by Vector Fitting},
  journal = {IEEE Transactions on Power Delivery},
  volume = {14},
  number = {3},
  pages = {1052--1061},
  year = {1999},
}
"""

_LINES_PER_POLE = 12
_START_DAMPING = 0.01
_RESOLVED = 0.25  # of the distance of two lines
_FALSE_ALARM = 1e-6


@dataclass(frozen=True, slots=True)
class VectorFitting:
    """Rational fits of several orders over the whole band, poles that stay, residues; fields are the settings."""

    name: ClassVar[str] = "vector-fitting"
    summary: ClassVar[str] = "Rational fits of several orders with relocated common poles (vector fitting), stabilised"
    citation: ClassVar[str] = _CITATION
    needs: ClassVar[Needs] = Needs.FORCE_REFERENCE | Needs.FRFS

    largest_order: int = field(default=16, metadata={"doc": "largest number of poles in the band"})
    order_step: int = field(default=2, metadata={"doc": "poles between one order and the next"})
    background_terms: int = field(default=3, metadata={"doc": "polynomials per response for what lies outside"})
    least_share: float = field(default=0.4, metadata={"doc": "part of the orders at which a mode must come up"})
    largest_damping_ratio: float = field(
        default=0.3, metadata={"doc": "a pole with more damping is not claimed as a mode"}
    )

    def __post_init__(self) -> None:
        bounds = {
            "largest_order": (2, 100),
            "order_step": (1, 20),
            "background_terms": (1, 20),
            "least_share": (0.0, 1.0),
            "largest_damping_ratio": (1e-6, 1.0),
        }
        for name, (low, high) in bounds.items():
            if not low <= getattr(self, name) <= high:
                raise InputError(self.name, f"{name} = {getattr(self, name)}", f"give {low:g} to {high:g}")

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The stable poles inside ``band_hz``, common to all runs, with residues and shapes."""
        spectra = campaign_spectra(campaign, band_hz)
        remarks = spectra.remarks
        if not spectra.runs:
            return ModalModel.empty(Outcome.DECLINED, (*remarks, "no run has a usable force and a usable response"))
        lines = spectra.frequency_hz.size
        if lines < FEWEST_LINES:
            why = f"the band {band_hz[0]:g} to {band_hz[1]:g} Hz holds {lines} lines, {FEWEST_LINES} are needed"
            return ModalModel.empty(Outcome.NOTHING_FOUND, (*remarks, why), dofs=spectra.responses)
        fits = self._fits(spectra)
        stable = self._stable(fits, spectra.frequency_hz, band_hz)
        stable, residues = _evident(spectra, stable)
        if not stable.modes:
            why = "no pole is stable over the orders: measure longer, or lower least_share"
            empty = ModalModel.empty(Outcome.NOTHING_FOUND, (*remarks, why), dofs=spectra.responses)
            return replace(empty, candidates=stable.candidates())
        poles = np.array([c.pole_rad_s for c in stable.modes])
        std_hz, std_ratio = _deviations(fits, stable)
        runs = tuple(
            RunModes(run.run, run.reference, run.responses, poles, part.residues.T, std_hz, std_ratio)
            for run, part in zip(spectra.runs, residues, strict=True)
        )
        claim = merged_claim(runs, poles="common", advice=remarks)
        return flag_non_modes(campaign, replace(claim, candidates=stable.candidates()))

    def _fits(self, spectra: CampaignSpectra) -> list[RationalFit]:
        """Fits of rising order, each started with poles evenly over the band."""
        blocks = tuple(_block(run) for run in spectra.runs)
        frequency = spectra.frequency_hz
        most = min(self.largest_order, (frequency.size - self.background_terms - 2) // _LINES_PER_POLE)
        fits = []
        for order in range(2, max(most, 2) + 1, self.order_step):
            # Between the ends, as a pole on the edge has half its lines only.
            start = 2 * np.pi * np.linspace(frequency[0], frequency[-1], order + 2)[1:-1]
            poles = np.asarray(start * (1j - _START_DAMPING), complex)
            fits.append(fit_rational(frequency, blocks, poles, self.background_terms))
        return fits

    def _stable(
        self, fits: list[RationalFit], frequency_hz: NDArray[np.float64], band_hz: tuple[float, float]
    ) -> Stabilisation:
        table = []
        for fit in fits:
            hertz = np.abs(fit.poles) / (2 * np.pi)
            inside = np.flatnonzero((hertz >= band_hz[0]) & (hertz <= band_hz[1]) & (fit.poles.imag > 0))
            vectors = np.vstack(fit.residues).T[inside]
            table.append(PolesAtOrder(fit.poles.size, fit.poles[inside], vectors))
        resolution = _RESOLVED * 2 * np.pi * float(frequency_hz[1] - frequency_hz[0])
        criteria = Criteria(
            least_share=self.least_share,
            largest_damping_ratio=self.largest_damping_ratio,
            resolution_rad_s=resolution,
        )
        return stabilise(table, criteria)


def _block(run: RunSpectra) -> Block:
    size = np.maximum(np.abs(run.force), 1e-9 * np.abs(run.force).max())
    noise = np.median(run.variance * size**2, axis=1)
    floor = 1e-16 * (np.abs(run.accelerance) ** 2 * size**2).mean(axis=1).max()
    return Block(run.accelerance, size, 1 / np.sqrt(noise + floor + 1e-300), run.force.conj() / size**2)


def _evident(spectra: CampaignSpectra, stable: Stabilisation) -> tuple[Stabilisation, tuple[Residues, ...]]:
    """Without the clusters whose residues noise explains, the weakest first; residues of what stays, per run."""
    from scipy.special import chdtri

    rows = sum(len(run.responses) for run in spectra.runs)
    needed = float(chdtri(2 * rows, _FALSE_ALARM))
    while stable.modes:
        poles = np.array([c.pole_rad_s for c in stable.modes])
        parts = tuple(fit_residues(run, spectra.frequency_hz, poles) for run in spectra.runs)
        # Each part of a complex residue has half its variance.
        evidence = sum((2 * np.abs(p.residues) ** 2 / np.maximum(p.std, 1e-300) ** 2).sum(axis=0) for p in parts)
        weakest = int(np.argmin(evidence))
        if evidence[weakest] > needed:
            return stable, parts
        cluster = stable.modes[weakest]
        stable = stable.without(cluster, f"{cluster.frequency_hz:.4g} Hz: noise explains its residues")
    return stable, ()


def _deviations(fits: list[RationalFit], stable: Stabilisation) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Standard deviations of frequency in Hz and of damping ratio, (M,): of the fit, or over the orders if larger."""
    every = np.concatenate([f.poles for f in fits])
    known = np.concatenate([f.pole_std for f in fits])
    std_hz, std_ratio = [], []
    for cluster in stable.modes:
        std = float(known[np.argmin(np.abs(every - cluster.pole_rad_s))])
        std_hz.append(max(std / (2 * np.pi), cluster.frequency_spread_hz))
        std_ratio.append(max(std / abs(cluster.pole_rad_s), cluster.damping_spread))
    return np.array(std_hz), np.array(std_ratio)
