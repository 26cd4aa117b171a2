"""Curve-fitting frequency domain decomposition with a force as reference, as in the 2016 flexible-wing tests.

Gupta, Seiler and Danowsky, AIAA 2016-1753: the spectral density matrix of all responses, here
G = H S_ff H^H through the force of each run, is decomposed on every line; the first
singular values around a peak are the density of one degree of freedom, to which
a second-order transfer function is fitted. Two excitation points give two singular values.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar, Literal

import numpy as np

from vgvt.data import Campaign, ModalModel, Outcome
from vgvt.identification import Needs
from vgvt_identifiers.bell_modes import (
    BellMode,
    BellOptions,
    bell_modes,
    confirmed,
    own_fits,
    pole_of,
    second_peaks,
    visible,
)
from vgvt_identifiers.bounds import check_bounds
from vgvt_identifiers.common_modes import RunModes
from vgvt_identifiers.merged_claim import merged_claim
from vgvt_identifiers.misfit_weights import residues_beside_others
from vgvt_identifiers.named_dofs import places
from vgvt_identifiers.non_modes import flag_non_modes
from vgvt_identifiers.output_spectra import ReferenceMatrix, force_referenced, reference_matrix
from vgvt_identifiers.sigma_plot import sigma_peaks
from vgvt_identifiers.singular_bell import FittedBell
from vgvt_identifiers.spectra import CampaignSpectra, campaign_spectra

CITATION = """\
@inproceedings{gupta2016ground,
  author = {Gupta, Abhineet and Seiler, Peter J. and Danowsky, Brian P.},
  title = {Ground Vibration Tests on a Flexible Flying Wing Aircraft},
  booktitle = {AIAA Atmospheric Flight Mechanics Conference},
  number = {AIAA 2016-1753},
  year = {2016},
}

@inproceedings{schulze2013system,
  author = {Schulze, P. C. and Thompson, P. M. and Danowsky, B. P. and Lee, D. and Harris, C.},
  title = {System Identification and Modal Extraction from Response Data},
  booktitle = {AIAA Atmospheric Flight Mechanics Conference},
  year = {2013},
}

@inproceedings{brincker2000modal,
  author = {Brincker, R. and Zhang, L. and Andersen, P.},
  title = {Modal Identification from Ambient Responses Using Frequency Domain Decomposition},
  booktitle = {International Modal Analysis Conference},
  year = {2000},
}
"""


@dataclass(frozen=True, slots=True)
class Cfdd:
    """Bells of singular values of H H^H, each fitted with a second-order fraction; fields are the settings."""

    name: ClassVar[str] = "cfdd"
    summary: ClassVar[str] = "Singular values of the spectral matrix through the force, a bell fitted per mode"
    citation: ClassVar[str] = CITATION
    needs: ClassVar[Needs] = Needs.FORCE_REFERENCE | Needs.FRFS

    poles: Literal["common", "per-run"] = field(
        default="common", metadata={"doc": "one bell over all runs, or one a run with their poles averaged"}
    )
    numerator: Literal["quadratic", "constant"] = field(
        default="quadratic", metadata={"doc": "of the fraction: quadratic takes up neighbouring modes"}
    )
    shapes: Literal["residues", "singular-vector"] = field(
        default="residues", metadata={"doc": "residues at the fitted poles, or the first singular vector of the bell"}
    )
    least_mac: float = field(default=0.8, metadata={"doc": "lines of a bell resemble the shape at its peak so much"})
    drop_db: float = field(default=10.0, metadata={"doc": "how far down from its peak a bell reaches, in dB of power"})
    prominence_db: float = field(default=1.0, metadata={"doc": "least rise of a peak over its saddle, in dB of power"})
    false_alarm: float = field(default=0.01, metadata={"doc": "chance that noise alone makes one peak somewhere"})
    largest_damping_ratio: float = field(
        default=0.3, metadata={"doc": "a fitted pole with more damping is not claimed as a mode"}
    )

    def __post_init__(self) -> None:
        check_bounds(
            self,
            {
                "least_mac": (0.0, 0.999),
                "drop_db": (3.0, 60.0),
                "prominence_db": (0.0, 60.0),
                "false_alarm": (1e-12, 0.5),
                "largest_damping_ratio": (1e-6, 1.0),
            },
        )

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The modes behind the peaks of the singular values inside ``band_hz``; shapes have largest entry 1."""
        spectra = campaign_spectra(campaign, band_hz)
        if not spectra.runs:
            why = "no run has a usable force and a usable response"
            return ModalModel.empty(Outcome.DECLINED, (*spectra.remarks, why))
        matrix = reference_matrix(spectra)
        remarks = (*spectra.remarks, *matrix.remarks)
        found = force_referenced(matrix)
        options = BellOptions(self.least_mac, self.drop_db, self.numerator == "quadratic", self.largest_damping_ratio)
        seen = sigma_peaks(spectra, self.prominence_db, self.false_alarm)
        peaks = [p for p in seen if confirmed(spectra, p)]
        candidates, left_out = bell_modes(found, [(p.line, 0) for p in peaks], options)
        if len(matrix.references) > 1:
            extra = second_peaks(found, candidates, self.false_alarm, len(matrix.references))
            candidates, left_out = bell_modes(found, [*((p.line, 0) for p in peaks), *extra], options)
        modes = visible(spectra, candidates)
        ripples = [p.frequency_hz for p in seen if p not in peaks] + [m.peak_hz for m in candidates if m not in modes]
        remarks = (*remarks, *left_out, *_ripples(sorted(ripples)))
        if not modes:
            why = "no peak of the singular values stands out of its noise as the bell of one mode"
            return ModalModel.empty(Outcome.NOTHING_FOUND, (*remarks, why), dofs=spectra.responses)
        return self._claim(campaign, spectra, matrix, modes, options, remarks)

    def _claim(
        self,
        campaign: Campaign,
        spectra: CampaignSpectra,
        matrix: ReferenceMatrix,
        modes: tuple[BellMode, ...],
        options: BellOptions,
        remarks: tuple[str, ...],
    ) -> ModalModel:
        single = tuple(force_referenced(reference_matrix(replace(spectra, runs=(run,)))) for run in spectra.runs)
        own = [own_fits(single, mode, options) if len(single) > 1 else (None,) for mode in modes]
        claimed = [self._pole(m, fits) for m, fits in zip(modes, own, strict=True)]
        order = np.argsort([p.natural_frequency_hz for p in claimed], kind="stable")
        modes, own, claimed = tuple(modes[i] for i in order), [own[i] for i in order], [claimed[i] for i in order]
        run_modes = []
        for k, run in enumerate(spectra.runs):
            poles = [m.pole if (f := fits[k]) is None else pole_of(f) for m, fits in zip(modes, own, strict=True)]
            residues = residues_beside_others(run, spectra.frequency_hz, np.array(poles)).residues.T
            run_modes.append(
                RunModes(
                    run.run,
                    run.reference,
                    run.responses,
                    np.array([pole_of(p) for p in claimed]),
                    residues,
                    np.array([p.natural_frequency_std_hz for p in claimed]),
                    np.array([p.damping_ratio_std for p in claimed]),
                )
            )
        flags = tuple((*m.flags, *_scatter(m, fits)) for m, fits in zip(modes, own, strict=True))
        model = merged_claim(tuple(run_modes), poles="common", flags=flags, advice=remarks)
        if self.shapes == "singular-vector":
            model = _with_vectors(model, modes, matrix)
        model = flag_non_modes(campaign, model)
        return model.band(float(spectra.frequency_hz[0]), float(spectra.frequency_hz[-1]))

    def _pole(self, mode: BellMode, fits: tuple[FittedBell | None, ...]) -> FittedBell:
        """The pole to be claimed; its standard deviations are at least what the scatter between runs says."""
        known = [f for f in fits if f is not None]
        if len(known) < 2:
            return mode.fit
        hz, hz_std = _mean([f.natural_frequency_hz for f in known], [f.natural_frequency_std_hz for f in known])
        ratio, ratio_std = _mean([f.damping_ratio for f in known], [f.damping_ratio_std for f in known])
        fit = mode.fit if self.poles == "common" else replace(mode.fit, natural_frequency_hz=hz, damping_ratio=ratio)
        return replace(
            fit,
            natural_frequency_std_hz=max(mode.fit.natural_frequency_std_hz, hz_std),
            damping_ratio_std=max(mode.fit.damping_ratio_std, ratio_std),
        )


def _mean(values: list[float], std: list[float]) -> tuple[float, float]:
    """Mean of estimates of single runs, weighted by their precision, and its standard deviation from their scatter."""
    x, floor = np.array(values), float(np.median(std))
    weight = 1 / (np.array(std) ** 2 + floor**2)
    return float(weight @ x / weight.sum()), float(x.std(ddof=1) / np.sqrt(x.size))


def _ripples(at_hz: list[float]) -> tuple[str, ...]:
    if not at_hz:
        return ()
    listed = ", ".join(f"{f:.3f}" for f in at_hz[:8]) + (f" and {len(at_hz) - 8} more" if len(at_hz) > 8 else "")
    return (f"peaks not claimed, as leakage or the modes beside them explain them: {listed} Hz",)


def _scatter(mode: BellMode, fits: tuple[FittedBell | None, ...]) -> tuple[str, ...]:
    known = np.array([f.natural_frequency_hz for f in fits if f is not None])
    if known.size < 2:
        return ()
    scatter = float(known.std(ddof=1))
    disagree = scatter > mode.fit.damping_ratio * mode.fit.natural_frequency_hz / 2
    return (f"run_scatter_hz={scatter:.4f}", *(("runs_disagree",) if disagree else ()))


def _with_vectors(model: ModalModel, modes: tuple[BellMode, ...], matrix: ReferenceMatrix) -> ModalModel:
    """The claim with singular vectors as shapes, largest entry 1; they carry no modal mass.

    The vectors know the DOFs of the matrix alone: where the claim has others, it stays with a remark.
    """
    place = places(matrix.dofs)
    lost = [str(d) for d in model.dofs if d.unsigned not in place]
    if lost:
        why = f"shapes are of residues, not singular vectors: {', '.join(lost)} not measured with every reference"
        return replace(model, advice=(*model.advice, why))
    index, signs = zip(*(place[d.unsigned] for d in model.dofs), strict=True)
    turned = np.array([sign * d.direction.sign for sign, d in zip(signs, model.dofs, strict=True)])
    vectors = np.array([m.bell.vector[list(index)] for m in modes]) * turned
    largest = vectors[np.arange(len(modes)), np.argmax(np.abs(vectors), axis=1)]
    return replace(model, shapes=vectors / largest[:, None], modal_mass_kg=None)
