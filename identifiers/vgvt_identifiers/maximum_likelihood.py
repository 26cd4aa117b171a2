"""Maximum likelihood: poles and residues that explain all responses best, weighted by the noise itself.

min sum |A - G F - T|^2 / (s_a^2 + |G|^2 s_f^2) over poles, residues, what lies
outside the band, and transients T of cut records; Pintelon and Schoukens, System
Identification: A Frequency Domain Approach, 2nd ed., 2012, chapter 9.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np

from vgvt.data import Campaign, InputError, ModalModel, Outcome
from vgvt.identification import Needs
from vgvt_identifiers.campaign_fit import searched_fit
from vgvt_identifiers.likelihood_claim import likelihood_claim
from vgvt_identifiers.non_modes import flag_non_modes
from vgvt_identifiers.pole_verdict import VerdictRules
from vgvt_identifiers.spectra import FEWEST_LINES, campaign_spectra

_CITATION = """\
@book{pintelon2012system,
  author = {Pintelon, Rik and Schoukens, Johan},
  title = {System Identification: A Frequency Domain Approach},
  edition = {2},
  publisher = {Wiley},
  year = {2012},
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

@article{laird1982random,
  author = {Laird, Nan M. and Ware, James H.},
  title = {Random-Effects Models for Longitudinal Data},
  journal = {Biometrics},
  volume = {38},
  number = {4},
  pages = {963--974},
  year = {1982},
}
"""


@dataclass(frozen=True, slots=True)
class MaximumLikelihood:
    """Poles added one by one while the likelihood asks for them, then fitted together; fields are the settings."""

    name: ClassVar[str] = "maximum-likelihood"
    summary: ClassVar[str] = "Errors-in-variables maximum likelihood by variable projection, poles added by evidence"
    citation: ClassVar[str] = _CITATION
    needs: ClassVar[Needs] = Needs.FORCE_REFERENCE | Needs.FRFS

    poles: Literal["per-run", "common"] = field(
        default="per-run",
        metadata={"doc": "poles that all runs share, or each run's own where it tells them, merged afterwards"},
    )
    false_alarm: float = field(
        default=1e-3, metadata={"doc": "chance that noise alone brings one pole in somewhere in the band"}
    )
    least_share: float = field(
        default=2e-3, metadata={"doc": "least part of the response at its frequency that a mode must make"}
    )
    largest_poles: int = field(default=60, metadata={"doc": "the search ends at this number of poles"})
    largest_damping_ratio: float = field(
        default=0.3, metadata={"doc": "a pole with more damping is not claimed as a mode"}
    )

    def __post_init__(self) -> None:
        bounds = {
            "false_alarm": (1e-12, 0.5),
            "least_share": (0.0, 1.0),
            "largest_poles": (1, 400),
            "largest_damping_ratio": (1e-6, 1.0),
        }
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
        rules = VerdictRules(self.false_alarm, self.least_share, largest_damping_ratio=self.largest_damping_ratio)
        fit = searched_fit(spectra, np.empty(0, complex), band_hz, rules, self.largest_poles)
        return flag_non_modes(campaign, likelihood_claim(spectra, fit, self.poles, remarks, band_hz))
