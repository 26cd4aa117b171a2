"""State-space model of all responses, from a subspace start to the least prediction error, as Moreno et al. made it.

The eigensystem realization of all impulse responses together gives a model of
twenty states, one input and as many outputs as there are responses. Its poles
are then moved until the weighted error of the frequency responses is least; the
output matrices follow linearly at each step. Poles that the responses need are the modes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, ModalModel
from vgvt.identification import Needs
from vgvt_identifiers.bounds import check_bounds
from vgvt_identifiers.era import ERA_CITATION, Era
from vgvt_identifiers.era_sources import shared_settings, sources_by_run
from vgvt_identifiers.hankel import realise
from vgvt_identifiers.impulse import impulse_responses
from vgvt_identifiers.non_modes import flag_non_modes
from vgvt_identifiers.output_error import Responses, fit_output_error
from vgvt_identifiers.pole_claim import ClaimOptions, claim_of_sources
from vgvt_identifiers.pole_patterns import PatternOptions, SourcePoles
from vgvt_identifiers.root_noise import PoleSpread
from vgvt_identifiers.spectra import CampaignSpectra, RunSpectra

_CITATION = (
    """\\
@book{ljung1999system,
  author = {Ljung, Lennart},
  title = {System Identification: Theory for the User},
  edition = {2},
  publisher = {Prentice Hall},
  year = {1999},
}

@article{kaufman1975variable,
  author = {Kaufman, Linda},
  title = {A Variable Projection Method for Solving Separable Nonlinear Least Squares Problems},
  journal = {BIT Numerical Mathematics},
  volume = {15},
  number = {1},
  pages = {49--57},
  year = {1975},
}

"""
    + ERA_CITATION
)
_SPARE_DAMPING = 0.3
_LEAST_SHARE = 0.3  # a model of one run has states to spare, which follow its noise
_NYQUIST_OVER_BAND = 0.75  # a real model has to turn real at half its rate, which the band's end shall not feel


@dataclass(frozen=True, slots=True)
class PredictionError:
    """Subspace start and least prediction error of one state-space model; fields are the settings."""

    name: ClassVar[str] = "pem"
    summary: ClassVar[str] = "State-space model of all responses, subspace start refined to the least prediction error"
    citation: ClassVar[str] = _CITATION
    needs: ClassVar[Needs] = Needs.FORCE_REFERENCE | Needs.FRFS

    order: int = field(default=20, metadata={"doc": "states of the model; two make one mode"})
    weight: Literal["noise", "none"] = field(
        default="noise", metadata={"doc": "errors over their standard deviation, or as they are, as in the paper"}
    )
    samples: int = field(default=601, metadata={"doc": "samples of the impulse response for the start"})
    rows: int = field(default=300, metadata={"doc": "rows of the Hankel matrix for one response, for the start"})
    columns: int = field(default=150, metadata={"doc": "columns of the Hankel matrix, for the start"})
    poles: Literal["per-run", "common"] = field(
        default="per-run", metadata={"doc": "a model for each run, or one of all runs as in the paper"}
    )
    spectra: Literal["whole-record", "estimator"] = field(
        default="whole-record",
        metadata={"doc": "ratios of whole records, or the FRF estimator that suits dwells or hits in the notes"},
    )
    transient: bool = field(
        default=True,
        metadata={"doc": "take what rings at the ends of the records out of the spectra, by a first model"},
    )
    model_error: float = field(
        default=3e-3, metadata={"doc": "part of the rms response that the model is not held to, whatever the noise"}
    )
    taper: float = field(default=0.3, metadata={"doc": "part of the band over which each of its edges is tapered"})
    iterations: int = field(default=40, metadata={"doc": "most steps of the refinement; 0 keeps the subspace model"})
    largest_damping_ratio: float = field(
        default=0.2, metadata={"doc": "a pole with more damping is not claimed as a mode"}
    )

    def __post_init__(self) -> None:
        bounds = {
            "samples": (20, 100_000),
            "columns": (4, self.samples - 4),
            "order": (2, min(self.columns, 100)),
            "rows": (4, 100_000),
            "model_error": (1e-9, 1.0),
            "taper": (0.01, 0.5),
            "iterations": (0, 1000),
            "largest_damping_ratio": (1e-6, 1.0),
        }
        check_bounds(self, bounds)

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The modes inside ``band_hz``, one pole each for all runs, with residues; poles of the model as candidates."""
        options = PatternOptions(largest_damping_ratio=self.largest_damping_ratio, least_share=_LEAST_SHARE)
        first = Era("simo", taper=self.taper, largest_damping_ratio=self.largest_damping_ratio)

        def start(spectra: CampaignSpectra) -> tuple[SourcePoles, ...]:
            return sources_by_run(spectra, shared_settings(first), first.model)

        claim = ClaimOptions(options, self.taper, self.poles == "per-run", self.spectra == "estimator")
        model = claim_of_sources(campaign, band_hz, claim, self._sources, start if self.transient else None)
        return flag_non_modes(campaign, model)

    def _sources(self, spectra: CampaignSpectra) -> tuple[SourcePoles, ...]:
        groups = [spectra.runs] if self.poles == "common" else [(run,) for run in spectra.runs]
        return tuple(self._source(which, group, spectra) for which, group in enumerate(groups))

    def _source(self, which: int, runs: tuple[RunSpectra, ...], spectra: CampaignSpectra) -> SourcePoles:
        """The poles of one model of the responses of some runs."""
        every = np.concatenate([r.accelerance for r in runs])
        impulse = impulse_responses(spectra.frequency_hz, every, self.samples, self.taper, self.taper)
        columns = min(self.columns, max(impulse.values.shape[1] // 3, 2))
        scale = np.sqrt((impulse.values**2).sum(axis=1, keepdims=True))
        start = realise(impulse.values / np.where(scale > 0, scale, 1), self.rows, columns, self.order).roots()
        interval = impulse.step_s * _NYQUIST_OVER_BAND
        together = max(1, spectra.frequency_hz.size // (2 * self.samples))
        keep = spectra.frequency_hz.size // together * together
        omega = 2 * np.pi * (spectra.frequency_hz[:keep] - impulse.shift_hz)
        angle = (omega * interval).reshape(-1, together)
        exponents = _filled(
            np.asarray(np.log(start.values) * _NYQUIST_OVER_BAND, complex),
            self.order // 2,
            float(angle[0, 0]),
            float(angle[-1, -1]),
        )
        blocks = tuple(self._responses(run, angle.shape) for run in runs)
        fit = fit_output_error(angle, blocks, exponents, self.iterations)
        poles = fit.exponents / interval + 2j * np.pi * impulse.shift_hz
        spread = PoleSpread(poles, *(v / interval**2 for v in fit.covariance))
        known = np.full(poles.size, np.nan)
        return SourcePoles(which, self.order, poles, spread.frequency_std_hz, spread.damping_ratio_std, known)

    def _responses(self, run: RunSpectra, shape: tuple[int, ...]) -> Responses:
        """The responses of a run, means over neighbouring lines, with weights for every line and every response."""
        lines = shape[0] * shape[1]
        values = run.accelerance[:, :lines].reshape(-1, *shape).mean(axis=2)
        if self.weight == "none":
            return Responses(values, np.ones(values.shape[0]), np.ones(shape[0]))
        noise = run.variance[:, :lines].reshape(-1, *shape).mean(axis=2) / shape[1]
        least = self.model_error**2 * (np.abs(values) ** 2).mean(axis=1, keepdims=True)
        noise = np.maximum(np.where(np.isfinite(noise), noise, 0), np.maximum(least, np.finfo(float).tiny))
        level = np.median(noise, axis=1, keepdims=True)
        return Responses(values, 1 / np.sqrt(level[:, 0] / 2), 1 / np.sqrt((noise / level).mean(axis=0)))


def _filled(exponents: NDArray[np.complex128], wanted: int, low: float, high: float) -> NDArray[np.complex128]:
    """As many exponents as wanted: those of the start, and broad ones all over the band in place of its real roots."""
    missing = wanted - exponents.size
    if missing <= 0:
        return exponents
    places = low + (high - low) * (np.arange(missing) + 0.5) / missing
    return np.concatenate([exponents, places * (1j - _SPARE_DAMPING)])
