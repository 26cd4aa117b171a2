"""The quadrature response method of the 2016 flexible-wing ground vibration tests.

Gupta, Seiler and Danowsky, Ground vibration tests on a flexible flying wing
aircraft, AIAA 2016-1753: peaks of the sigma plot give the modes, a rational fit
smooths the responses, the imaginary part at the natural frequency is the shape,
and Stahle and Forlifer's system of equations separates modes that overlap.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, InputError, ModalModel, Outcome
from vgvt.identification import Needs
from vgvt_identifiers.mode_fit import FitOptions, FittedMode, fit_modes
from vgvt_identifiers.non_modes import flag_non_modes
from vgvt_identifiers.quadrature_shapes import quadrature_shapes
from vgvt_identifiers.sigma_plot import sigma_peaks
from vgvt_identifiers.spectra import FEWEST_LINES, CampaignSpectra, campaign_spectra
from vgvt_identifiers.stahle_forlifer import participation_matrix, separate_quadratures

_CITATION = """\
@inproceedings{gupta2016ground,
  author = {Gupta, Abhineet and Seiler, Peter J. and Danowsky, Brian P.},
  title = {Ground Vibration Tests on a Flexible Flying Wing Aircraft},
  booktitle = {AIAA Atmospheric Flight Mechanics Conference},
  number = {AIAA 2016-1753},
  year = {2016},
}

@inproceedings{stahle1958ground,
  author = {Stahle, C. V. and Forlifer, W. R.},
  title = {Ground Vibration Testing of Complex Structures},
  booktitle = {Flight Flutter Testing Symposium},
  pages = {83--90},
  year = {1958},
}

@article{gustavsen1999rational,
  author = {Gustavsen, Bj{\\o}rn and Semlyen, Adam},
  title = {Rational Approximation of Frequency Domain Responses by Vector Fitting},
  journal = {IEEE Transactions on Power Delivery},
  volume = {14},
  number = {3},
  pages = {1052--1061},
  year = {1999},
}

@article{golub1973differentiation,
  author = {Golub, G. H. and Pereyra, V.},
  title = {The Differentiation of Pseudo-Inverses and Nonlinear Least Squares Problems Whose Variables Separate},
  journal = {SIAM Journal on Numerical Analysis},
  volume = {10},
  number = {2},
  pages = {413--432},
  year = {1973},
}
"""


@dataclass(frozen=True, slots=True)
class Quadrature:
    """Peak picking on the sigma plot, rational fit, imaginary part as shape; fields are the settings."""

    name: ClassVar[str] = "quadrature"
    summary: ClassVar[str] = "Sigma-plot peaks, rational smoothing fit, quadrature response as mode shape"
    citation: ClassVar[str] = _CITATION
    needs: ClassVar[Needs] = Needs.FORCE_REFERENCE | Needs.FRFS

    correction: Literal["none", "stahle-forlifer"] = field(
        default="none", metadata={"doc": "separate overlapping modes by the Stahle-Forlifer equations"}
    )
    damping_model: Literal["viscous", "structural"] = field(
        default="viscous", metadata={"doc": "damping that the Stahle-Forlifer equations assume"}
    )
    prominence_db: float = field(
        default=1.0, metadata={"doc": "least rise of a sigma-plot peak over its saddle, in dB of power"}
    )
    false_alarm: float = field(
        default=0.01, metadata={"doc": "chance that noise alone makes one peak somewhere in the sigma plot"}
    )
    window_widths: float = field(
        default=4.0, metadata={"doc": "half-power widths that a fit reaches to each side of a peak"}
    )
    background_terms: int = field(
        default=4, metadata={"doc": "polynomials per response for the modes outside a fit's window"}
    )
    shape_frequency: Literal["common", "per-run"] = field(
        default="per-run",
        metadata={"doc": "where the imaginary part is read: at the common natural frequency, or at each run's own"},
    )
    largest_damping_ratio: float = field(
        default=0.3, metadata={"doc": "a fitted pole with more damping is not claimed as a mode"}
    )

    def __post_init__(self) -> None:
        bounds = {
            "prominence_db": (0.0, 60.0),
            "false_alarm": (1e-12, 0.5),
            "window_widths": (1.0, 50.0),
            "background_terms": (1, 20),
            "largest_damping_ratio": (1e-6, 1.0),
        }
        for name, (low, high) in bounds.items():
            if not low <= getattr(self, name) <= high:
                raise InputError("quadrature", f"{name} = {getattr(self, name)}", f"give {low:g} to {high:g}")

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The modes at the sigma-plot peaks inside ``band_hz``; shapes have their largest component at 1."""
        spectra = campaign_spectra(campaign, band_hz)
        remarks = spectra.remarks
        if not spectra.runs:
            return ModalModel.empty(Outcome.DECLINED, (*remarks, "no run has a usable force and a usable response"))
        peaks = sigma_peaks(spectra, self.prominence_db, self.false_alarm)
        if not peaks:
            why = _no_peak(spectra, band_hz)
            return ModalModel.empty(Outcome.NOTHING_FOUND, (*remarks, why), dofs=spectra.responses)
        options = FitOptions(
            self.window_widths, self.background_terms, self.largest_damping_ratio, self.shape_frequency == "per-run"
        )
        modes, left_out = fit_modes(spectra, peaks, options)
        remarks = (*remarks, *left_out)
        if not modes:
            return ModalModel.empty(Outcome.NOTHING_FOUND, remarks, dofs=spectra.responses)
        return flag_non_modes(campaign, self._claim(spectra, modes, remarks))

    def _claim(self, spectra: CampaignSpectra, modes: tuple[FittedMode, ...], remarks: tuple[str, ...]) -> ModalModel:
        frequency = np.array([m.natural_frequency_hz for m in modes])
        damping = np.array([m.damping_ratio for m in modes])
        quadrature = np.array([m.quadrature for m in modes])
        if self.correction == "stahle-forlifer":
            share = participation_matrix(frequency, damping, self.damping_model, differentiations=2)
            condition = np.linalg.cond(share)
            if condition < 1e6:
                quadrature = separate_quadratures(quadrature, share)
            else:
                remarks = (*remarks, f"modes too close for the Stahle-Forlifer correction (condition {condition:.1e})")
        found = quadrature_shapes(spectra.runs, quadrature)
        remarks = (*remarks, *_moved_modes(spectra, frequency, quadrature), *found.remarks)
        return ModalModel(
            natural_frequency_hz=frequency,
            damping_ratio=damping,
            shapes=found.shapes.astype(complex),
            dofs=found.dofs,
            natural_frequency_std_hz=np.array([m.natural_frequency_std_hz for m in modes]),
            damping_ratio_std=np.array([m.damping_ratio_std for m in modes]),
            flags=tuple(
                (*m.flags, *(("shape_incomplete",) if cut else ()))
                for m, cut in zip(modes, found.incomplete, strict=True)
            ),
            outcome=Outcome.FOUND,
            advice=remarks,
        )


def _moved_modes(spectra: CampaignSpectra, frequency_hz: NDArray[np.float64], rows: NDArray[np.float64]) -> list[str]:
    """Remarks on neighbours within 5 % that hardly share a run: they may be one mode that moved between runs."""
    ends = np.cumsum([len(r.responses) for r in spectra.runs])[:-1]
    power = np.array([[(part**2).sum() for part in np.split(row, ends)] for row in rows])
    share = power / np.maximum(power.sum(axis=1, keepdims=True), 1e-300)
    remarks = []
    for i in range(frequency_hz.size - 1):
        near = frequency_hz[i + 1] < 1.05 * frequency_hz[i]
        if near and np.minimum(share[i], share[i + 1]).sum() < 0.2:
            pair = f"{frequency_hz[i]:.3f} and {frequency_hz[i + 1]:.3f} Hz"
            remarks.append(f"{pair} are seen by different runs: local modes, or one mode that moved between runs")
    return remarks


def _no_peak(spectra: CampaignSpectra, band_hz: tuple[float, float]) -> str:
    band, lines = f"{band_hz[0]:g} to {band_hz[1]:g} Hz", spectra.frequency_hz.size
    if lines < FEWEST_LINES:
        return f"the band {band} holds {lines} lines, {FEWEST_LINES} are needed: widen it or take longer records"
    return f"no peak of the sigma plot in {band} stands out of its noise: measure longer, or raise false_alarm"
