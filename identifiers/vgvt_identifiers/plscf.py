"""Polyreference least squares in the frequency domain (pLSCF, PolyMAX): poles over orders, stabilisation, residues."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, InputError, ModalModel, Outcome, PoleCandidate
from vgvt.identification import Needs
from vgvt_identifiers.common_modes import RunModes
from vgvt_identifiers.fraction_poles import FractionPoles, ModePoles, fraction_poles, mode_poles, stabilised
from vgvt_identifiers.fraction_rows import fraction_rows
from vgvt_identifiers.merged_claim import merged_claim
from vgvt_identifiers.non_modes import flag_non_modes
from vgvt_identifiers.own_poles import claim_of_own_poles, moved_modes, own_poles
from vgvt_identifiers.residues import Residues, fit_residues
from vgvt_identifiers.significant import Misfit, misfit, significant
from vgvt_identifiers.spectra import FEWEST_LINES, CampaignSpectra, RunSpectra, campaign_spectra
from vgvt_identifiers.stabilisation import Criteria, Stabilisation

_CITATION = """\
@inproceedings{guillaume2003polyreference,
  author = {Guillaume, Patrick and Verboven, Peter and Vanlanduit, Steve and Van der Auweraer, Herman
    and Peeters, Bart},
  title = {A Poly-Reference Implementation of the Least-Squares Complex Frequency-Domain Estimator},
  booktitle = {Proceedings of the 21st International Modal Analysis Conference},
  year = {2003},
}

@article{peeters2004polymax,
  author = {Peeters, Bart and Van der Auweraer, Herman and Guillaume, Patrick and Leuridan, Jan},
  title = {The {PolyMAX} Frequency-Domain Method: A New Standard for Modal Parameter Estimation?},
  journal = {Shock and Vibration},
  volume = {11},
  number = {3--4},
  pages = {395--409},
  year = {2004},
}

@article{verboven2004generalized,
  author = {Verboven, P. and Guillaume, P. and Cauberghe, B. and Vanlanduit, S. and Parloo, E.},
  title = {Frequency-Domain Generalized Total Least-Squares Identification for Modal Analysis},
  journal = {Journal of Sound and Vibration},
  volume = {278},
  pages = {21--38},
  year = {2004},
}

@article{pintelon2007uncertainty,
  author = {Pintelon, R. and Guillaume, P. and Schoukens, J.},
  title = {Uncertainty Calculation in (Operational) Modal Analysis},
  journal = {Mechanical Systems and Signal Processing},
  volume = {21},
  number = {6},
  pages = {2359--2373},
  year = {2007},
}
"""

_LARGEST_OF_A_RUN = 32  # for the poles of a run whose modes are known: all runs have shown them together


@dataclass(frozen=True, slots=True)
class Plscf:
    """Matrix fractions of many orders, what is stable over them, and residues for that; fields are the settings."""

    name: ClassVar[str] = "plscf"
    summary: ClassVar[str] = "Polyreference least-squares complex frequency domain (PolyMAX), stabilised without clicks"
    citation: ClassVar[str] = _CITATION
    needs: ClassVar[Needs] = Needs.FORCE_REFERENCE | Needs.FRFS

    poles: Literal["per-run", "common"] = field(
        default="per-run",
        metadata={"doc": "poles that all runs share, or each run's own where it tells them, merged afterwards"},
    )
    largest_order: int = field(default=60, metadata={"doc": "largest number of poles in and around the band"})
    least_share: float = field(default=0.35, metadata={"doc": "part of the orders at which a mode must come up"})
    noise_removed: float = field(
        default=0.95, metadata={"doc": "part of the noise's own covariance that is taken off the equations"}
    )
    leakage: bool = field(
        default=True,
        metadata={"doc": "model what records lost at their ends, where they were not at rest there and it shows"},
    )
    largest_damping_ratio: float = field(
        default=0.3, metadata={"doc": "a pole with more damping is not claimed as a mode"}
    )

    def __post_init__(self) -> None:
        bounds = {
            "largest_order": (2, 200),
            "least_share": (0.0, 1.0),
            "noise_removed": (0.0, 0.999),
            "largest_damping_ratio": (1e-6, 1.0),
        }
        for name, (low, high) in bounds.items():
            if not low <= getattr(self, name) <= high:
                raise InputError("plscf", f"{name} = {getattr(self, name)}", f"give {low:g} to {high:g}")

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The stable poles inside ``band_hz`` with residues, shapes and every pole's fate as candidates."""
        spectra = campaign_spectra(campaign, band_hz)
        remarks = spectra.remarks
        if not spectra.runs:
            return ModalModel.empty(Outcome.DECLINED, (*remarks, "no run has a usable force and a usable response"))
        lines = spectra.frequency_hz.size
        if lines < FEWEST_LINES:
            why = f"the band {band_hz[0]:g} to {band_hz[1]:g} Hz holds {lines} lines, {FEWEST_LINES} are needed"
            return ModalModel.empty(Outcome.NOTHING_FOUND, (*remarks, why), dofs=spectra.responses)
        method, together = self._needed(spectra, band_hz)
        if not together.modes:
            why = "no pole is stable over the orders: measure longer, or lower least_share"
            empty = ModalModel.empty(Outcome.NOTHING_FOUND, (*remarks, why), dofs=spectra.responses)
            return replace(empty, candidates=together.candidates)
        if self.poles == "common" or len(spectra.runs) == 1:
            claim = merged_claim(together.modes, poles="common", advice=remarks)
        else:
            claim = method._claim_of_runs(spectra, together.poles, band_hz)
        return flag_non_modes(campaign, replace(claim, candidates=together.candidates))

    def _needed(self, spectra: CampaignSpectra, band_hz: tuple[float, float]) -> tuple[Plscf, _Found]:
        """The method with or without leakage, whichever the responses ask for, and what it finds in all runs together.

        A sweep that passes a mode early in the record turns 1/F so little across it that leakage takes its place.
        """
        whole = self._found(spectra.frequency_hz, spectra.runs, band_hz)
        if not self.leakage:
            return self, whole
        still = replace(self, leakage=False)
        less = still._found(spectra.frequency_hz, spectra.runs, band_hz)
        return (still, less) if whole.misfit.is_worth_less_than(less.misfit) else (self, whole)

    def _found(
        self, frequency_hz: NDArray[np.float64], runs: tuple[RunSpectra, ...], band_hz: tuple[float, float]
    ) -> _Found:
        fractions, stable = self._stable(frequency_hz, runs, band_hz, self.largest_order)
        stable, residues = significant(frequency_hz, runs, stable, self.leakage)
        poles = mode_poles(fractions, stable)
        modes = tuple(_run_modes(run, poles, part) for run, part in zip(runs, residues, strict=True))
        return _Found(poles, modes if stable.modes else (), stable.candidates(), misfit(runs, residues))

    def _stable(
        self, frequency_hz: NDArray[np.float64], runs: tuple[RunSpectra, ...], band_hz: tuple[float, float], order: int
    ) -> tuple[FractionPoles, Stabilisation]:
        rows = fraction_rows(frequency_hz, runs, self.leakage)
        fractions = fraction_poles(rows, band_hz, order, self.noise_removed)
        criteria = Criteria(least_share=self.least_share, largest_damping_ratio=self.largest_damping_ratio)
        return fractions, stabilised(fractions, band_hz, criteria, len(runs))

    def _claim_of_runs(self, spectra: CampaignSpectra, together: ModePoles, band_hz: tuple[float, float]) -> ModalModel:
        resolution = 2 * np.pi * float(spectra.frequency_hz[1] - spectra.frequency_hz[0])
        order = min(self.largest_order, _LARGEST_OF_A_RUN)
        alone = [mode_poles(*self._stable(spectra.frequency_hz, (run,), band_hz, order)) for run in spectra.runs]
        seen = np.array([own_poles(together, own, resolution)[1] for own in alone])
        moved = moved_modes(together, seen)
        shared = ModePoles(together.poles_rad_s[~moved], together.std_rad_s[~moved])
        # Where few runs tell a pole, the others would be fitted with one that is not theirs.
        few = seen[:, ~moved].mean(axis=0) < 0.5
        modes, told = [], []
        for run, own in zip(spectra.runs, alone, strict=True):
            poles, which = own_poles(shared, own, resolution)
            poles, which = shared.where(few, poles), which & ~few
            residues = fit_residues(run, spectra.frequency_hz, poles.poles_rad_s, transient=self.leakage)
            modes.append(_run_modes(run, poles, residues))
            told.append(which)
        return claim_of_own_poles(tuple(modes), np.array(told), spectra.remarks)


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """The poles of the modes, the modes of every run with these poles, every pole's fate, and the misfit."""

    poles: ModePoles
    modes: tuple[RunModes, ...]
    candidates: tuple[PoleCandidate, ...]
    misfit: Misfit


def _run_modes(run: RunSpectra, poles: ModePoles, residues: Residues) -> RunModes:
    return RunModes(
        run.run,
        run.reference,
        run.responses,
        poles.poles_rad_s,
        residues.residues.T,
        poles.frequency_std_hz,
        poles.damping_ratio_std,
    )
