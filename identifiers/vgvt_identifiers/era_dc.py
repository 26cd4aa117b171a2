"""The eigensystem realization algorithm on data correlations, for responses with much noise."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, InputError, ModalModel
from vgvt.identification import Needs
from vgvt_identifiers.bounds import check_bounds
from vgvt_identifiers.data_correlation import CorrelatedRealisation, realise_correlated
from vgvt_identifiers.era import ERA_CITATION
from vgvt_identifiers.era_sources import check_settings, identify_by_realisation, shared_settings
from vgvt_identifiers.non_modes import flag_non_modes

_CITATION = (
    """\
@article{juang1988eigensystem,
  author = {Juang, Jer-Nan and Cooper, J. E. and Wright, J. R.},
  title = {An Eigensystem Realization Algorithm Using Data Correlations ({ERA/DC}) for Modal Parameter Identification},
  journal = {Control-Theory and Advanced Technology},
  volume = {4},
  number = {1},
  pages = {5--14},
  year = {1988},
}

"""
    + ERA_CITATION
)


@dataclass(frozen=True, slots=True)
class EraDc:
    """ERA on correlations of the Hankel matrix with itself shifted; fields are the settings."""

    name: ClassVar[str] = "era-dc"
    summary: ClassVar[str] = "Eigensystem realization of data correlations, poles that several sensors or runs show"
    citation: ClassVar[str] = _CITATION
    needs: ClassVar[Needs] = Needs.FORCE_REFERENCE | Needs.FRFS

    arrangement: Literal["siso", "simo"] = field(
        default="siso", metadata={"doc": "a model for each response, or one for all responses of a run"}
    )
    samples: int = field(default=601, metadata={"doc": "samples of the impulse response"})
    rows: int = field(default=500, metadata={"doc": "products that a correlation sums over, fewer if samples lack"})
    columns: int = field(default=50, metadata={"doc": "columns of the Hankel matrix, and so the size of a correlation"})
    block_rows: int = field(default=4, metadata={"doc": "correlations above one another"})
    block_columns: int = field(default=2, metadata={"doc": "correlations beside one another"})
    lag: int = field(default=10, metadata={"doc": "samples between neighbouring correlations"})
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
        check_bounds(self, {"block_rows": (1, 100), "block_columns": (1, 100), "lag": (1, 1000)})
        fewest = self.columns + self.lag * (self.block_rows + self.block_columns - 2) + 3
        if self.samples < fewest:
            asked = f"{self.block_rows} x {self.block_columns} correlations at a lag of {self.lag}"
            advice = f"give {fewest} or more, or fewer columns, blocks or lag"
            raise InputError(self.name, f"samples = {self.samples} cannot fill {asked}", advice)

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The modes inside ``band_hz``, with residues, and every pole of every model as a candidate."""
        return flag_non_modes(campaign, identify_by_realisation(shared_settings(self), self.model, campaign, band_hz))

    def model(self, impulse: NDArray[np.float64], order: int) -> CorrelatedRealisation:
        """A model of some order of the correlations of impulse responses (R, N)."""
        size = (self.rows, self.columns, order, self.block_rows, self.block_columns, self.lag)
        return realise_correlated(impulse, *size)
