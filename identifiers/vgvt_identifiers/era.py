"""The eigensystem realization algorithm on impulse responses, as Moreno et al. used it on a flexible flying wing.

Every response alone gives a model of twelve states from a Hankel matrix of 500
rows and 100 columns; poles that come back at other sensors are the modes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, ModalModel
from vgvt.identification import Needs
from vgvt_identifiers.era_sources import check_settings, identify_by_realisation, shared_settings
from vgvt_identifiers.hankel import Realisation, realise
from vgvt_identifiers.non_modes import flag_non_modes

ERA_CITATION = """\
@inproceedings{moreno2014structural,
  author = {Moreno, Claudia P. and Gupta, Abhineet and Pfifer, Harald and Taylor, Brian and Balas, Gary J.},
  title = {Structural Model Identification of a Small Flexible Aircraft},
  booktitle = {American Control Conference},
  pages = {4379--4384},
  year = {2014},
}

@article{juang1985eigensystem,
  author = {Juang, Jer-Nan and Pappa, Richard S.},
  title = {An Eigensystem Realization Algorithm for Modal Parameter Identification and Model Reduction},
  journal = {Journal of Guidance, Control, and Dynamics},
  volume = {8},
  number = {5},
  pages = {620--627},
  year = {1985},
}

@article{pappa1993consistent,
  author = {Pappa, Richard S. and Elliott, Kenny B. and Schenk, Axel},
  title = {Consistent-Mode Indicator for the Eigensystem Realization Algorithm},
  journal = {Journal of Guidance, Control, and Dynamics},
  volume = {16},
  number = {5},
  pages = {852--858},
  year = {1993},
}
"""


@dataclass(frozen=True, slots=True)
class Era:
    """Realisation of each response alone (siso) or of all of a run at many orders (simo); fields are the settings."""

    name: ClassVar[str] = "era"
    summary: ClassVar[str] = "Eigensystem realization of impulse responses, poles that several sensors or runs show"
    citation: ClassVar[str] = ERA_CITATION
    needs: ClassVar[Needs] = Needs.FORCE_REFERENCE | Needs.FRFS

    arrangement: Literal["siso", "simo"] = field(
        default="siso", metadata={"doc": "a model for each response, or one for all responses of a run"}
    )
    samples: int = field(default=601, metadata={"doc": "samples of the impulse response"})
    rows: int = field(default=500, metadata={"doc": "rows of the Hankel matrix for one response"})
    columns: int = field(default=100, metadata={"doc": "columns of the Hankel matrix"})
    order: int = field(default=12, metadata={"doc": "states of the model of one response (siso)"})
    highest_order: int = field(default=40, metadata={"doc": "states at the end of the stabilisation (simo)"})
    taper: float = field(default=0.3, metadata={"doc": "part of the band over which each of its edges is tapered"})
    average: Literal["weighted", "plain"] = field(
        default="weighted", metadata={"doc": "mean of a pattern's poles: by their variances, or plain as in the paper"}
    )
    poles: Literal["per-run", "common"] = field(
        default="per-run", metadata={"doc": "residues at each run's own poles where it shows them, or at the mean"}
    )
    spectra: Literal["whole-record", "estimator"] = field(
        default="whole-record",
        metadata={"doc": "ratios of whole records, or the FRF estimator that suits dwells or hits in the notes"},
    )
    transient: bool = field(
        default=True,
        metadata={"doc": "take what rings at the ends of the records out of the spectra, by a first model"},
    )
    least_coherence: float = field(
        default=0.3, metadata={"doc": "EMAC (with several responses CMI) below which a pole is taken for noise"}
    )
    tolerance: float = field(default=0.02, metadata={"doc": "relative distance of poles that may be one mode"})
    largest_damping_ratio: float = field(
        default=0.2, metadata={"doc": "a pole with more damping is not claimed as a mode"}
    )

    def __post_init__(self) -> None:
        check_settings(shared_settings(self))

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The modes inside ``band_hz``, with residues, and every pole of every model as a candidate."""
        return flag_non_modes(campaign, identify_by_realisation(shared_settings(self), self.model, campaign, band_hz))

    def model(self, impulse: NDArray[np.float64], order: int) -> Realisation:
        """A model of some order of impulse responses (R, N)."""
        return realise(impulse, self.rows, self.columns, order)
