"""The recommended method: no order to choose, nothing to click.

Poles over many orders of a matrix fraction, those that are stable as a first
guess, further ones while the likelihood asks for them, a verdict on each
by its evidence, a maximum-likelihood fit of what stays, and how well it is known.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, InputError, ModalModel, Outcome, PoleCandidate
from vgvt.identification import Needs
from vgvt_identifiers.campaign_fit import searched_fit
from vgvt_identifiers.fraction_poles import fraction_poles, stabilised
from vgvt_identifiers.fraction_rows import fraction_rows
from vgvt_identifiers.likelihood_claim import likelihood_claim
from vgvt_identifiers.non_modes import flag_non_modes
from vgvt_identifiers.pole_verdict import VerdictRules
from vgvt_identifiers.spectra import FEWEST_LINES, CampaignSpectra, campaign_spectra
from vgvt_identifiers.stabilisation import Criteria

_CITATION = """\
@article{vanderauweraer2004discriminating,
  author = {Van der Auweraer, Herman and Peeters, Bart},
  title = {Discriminating Physical Poles from Mathematical Poles in High Order Systems: Use and Automation
    of the Stabilization Diagram},
  journal = {Proceedings of the 21st IEEE Instrumentation and Measurement Technology Conference},
  year = {2004},
}

@inproceedings{guillaume2003polyreference,
  author = {Guillaume, Patrick and Verboven, Peter and Vanlanduit, Steve and Van der Auweraer, Herman
    and Peeters, Bart},
  title = {A Poly-Reference Implementation of the Least-Squares Complex Frequency-Domain Estimator},
  booktitle = {Proceedings of the 21st International Modal Analysis Conference},
  year = {2003},
}

@book{pintelon2012system,
  author = {Pintelon, Rik and Schoukens, Johan},
  title = {System Identification: A Frequency Domain Approach},
  edition = {2},
  publisher = {Wiley},
  year = {2012},
}
"""


@dataclass(frozen=True, slots=True)
class Auto:
    """Stabilised poles, evidence, maximum likelihood; fields are the settings, and the defaults are meant to stay."""

    name: ClassVar[str] = "auto"
    summary: ClassVar[str] = (
        "Recommended: stabilised poles, evidence for each, maximum-likelihood fit with uncertainties"
    )
    citation: ClassVar[str] = _CITATION
    needs: ClassVar[Needs] = Needs.FORCE_REFERENCE | Needs.FRFS

    poles: Literal["per-run", "common"] = field(
        default="per-run",
        metadata={"doc": "poles that all runs share, or each run's own where it tells them, merged afterwards"},
    )
    largest_order: int = field(default=32, metadata={"doc": "largest number of poles of the first guess"})
    false_alarm: float = field(
        default=1e-3, metadata={"doc": "chance that noise alone brings one pole in somewhere in the band"}
    )
    least_share: float = field(
        default=2e-3, metadata={"doc": "least part of the response at its frequency that a mode must make"}
    )

    def __post_init__(self) -> None:
        bounds = {"largest_order": (2, 200), "false_alarm": (1e-12, 0.5), "least_share": (0.0, 1.0)}
        for name, (low, high) in bounds.items():
            if not low <= getattr(self, name) <= high:
                raise InputError(self.name, f"{name} = {getattr(self, name)}", f"give {low:g} to {high:g}")

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The modes inside ``band_hz`` with shapes, residues, modal masses where known, and standard deviations."""
        spectra = campaign_spectra(campaign, band_hz)
        remarks = spectra.remarks
        if not spectra.runs:
            return ModalModel.empty(Outcome.DECLINED, (*remarks, "no run has a usable force and a usable response"))
        lines = spectra.frequency_hz.size
        if lines < FEWEST_LINES:
            why = f"the band {band_hz[0]:g} to {band_hz[1]:g} Hz holds {lines} lines, {FEWEST_LINES} are needed"
            return ModalModel.empty(Outcome.NOTHING_FOUND, (*remarks, why), dofs=spectra.responses)
        start, candidates = self._first_guess(spectra, band_hz)
        fit = searched_fit(spectra, start, band_hz, VerdictRules(self.false_alarm, self.least_share))
        claim = likelihood_claim(spectra, fit, self.poles, remarks, band_hz)
        return flag_non_modes(campaign, replace(claim, candidates=(*candidates, *claim.candidates)))

    def _first_guess(
        self, spectra: CampaignSpectra, band_hz: tuple[float, float]
    ) -> tuple[NDArray[np.complex128], tuple[PoleCandidate, ...]]:
        """Poles (N,) rad/s that are stable over the orders, and every pole of every order with its fate."""
        rows = fraction_rows(spectra.frequency_hz, spectra.runs, True)
        table = fraction_poles(rows, band_hz, min(self.largest_order, spectra.frequency_hz.size // 12))
        stable = stabilised(table, band_hz, Criteria(), len(spectra.runs))
        return np.array([c.pole_rad_s for c in stable.modes], dtype=complex), stable.candidates()
