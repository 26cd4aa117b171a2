"""Input-output subspace identification on the samples: state-space models of every run, stabilised and merged."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, ChannelRole, InputError, ModalModel, Outcome, PoleCandidate
from vgvt.identification import Needs
from vgvt_identifiers.common_modes import RunModes, common_modes
from vgvt_identifiers.fraction_poles import ModePoles
from vgvt_identifiers.merged_claim import merged_pole
from vgvt_identifiers.non_modes import flag_non_modes
from vgvt_identifiers.own_poles import claim_of_own_poles
from vgvt_identifiers.residues import fit_residues
from vgvt_identifiers.run_poles import SubspaceOptions, deviations, noise_power, prepared, stable_poles
from vgvt_identifiers.significant import significant
from vgvt_identifiers.spectra import FEWEST_LINES, CampaignSpectra, campaign_spectra
from vgvt_identifiers.stabilisation import Criteria, Stabilisation
from vgvt_identifiers.too_few import TooFewError

_CITATION = """\
@article{verhaegen1994identification,
  author = {Verhaegen, Michel},
  title = {Identification of the Deterministic Part of {MIMO} State Space Models Given in Innovations Form from
    Input-Output Data},
  journal = {Automatica},
  volume = {30},
  number = {1},
  pages = {61--74},
  year = {1994},
}

@article{vanoverschee1995unifying,
  author = {Van Overschee, Peter and De Moor, Bart},
  title = {A Unifying Theorem for Three Subspace System Identification Algorithms},
  journal = {Automatica},
  volume = {31},
  number = {12},
  pages = {1853--1864},
  year = {1995},
}

@book{vanoverschee1996subspace,
  author = {Van Overschee, Peter and De Moor, Bart},
  title = {Subspace Identification for Linear Systems: Theory, Implementation, Applications},
  publisher = {Kluwer Academic Publishers},
  year = {1996},
}
"""


@dataclass(frozen=True, slots=True)
class Subspace:
    """State-space models of many orders for every run, what is stable, and residues for that; fields are settings."""

    name: ClassVar[str] = "subspace"
    summary: ClassVar[str] = "Input-output subspace identification (PO-MOESP, CVA, N4SID) on the samples of every run"
    citation: ClassVar[str] = _CITATION
    needs: ClassVar[Needs] = Needs.FORCE_REFERENCE | Needs.TIME_HISTORIES

    weighting: Literal["cva", "moesp", "n4sid"] = field(
        default="cva",
        metadata={"doc": "future outputs made white, or not, or (n4sid) with what the past shares with future forces"},
    )
    block_rows: int = field(default=0, metadata={"doc": "samples of past and of future; 0 takes what one run affords"})
    largest_order: int = field(default=40, metadata={"doc": "largest number of states, two a mode"})
    least_share: float = field(default=0.35, metadata={"doc": "part of the orders at which a mode must come up"})
    least_runs: float = field(default=0.2, metadata={"doc": "part of the runs that must show a mode"})
    replicates: int = field(default=8, metadata={"doc": "how often noise is added anew for standard deviations"})
    seed: int = field(default=20160915, metadata={"doc": "seed of that noise"})
    largest_damping_ratio: float = field(
        default=0.3, metadata={"doc": "a pole with more damping is not claimed as a mode"}
    )

    def __post_init__(self) -> None:
        bounds = {
            "block_rows": (0, 1000),
            "largest_order": (4, 400),
            "least_share": (0.0, 1.0),
            "least_runs": (0.0, 1.0),
            "replicates": (0, 1000),
            "seed": (0, 2**63 - 1),
            "largest_damping_ratio": (1e-6, 1.0),
        }
        for name, (low, high) in bounds.items():
            if not low <= getattr(self, name) <= high:
                raise InputError("subspace", f"{name} = {getattr(self, name)}", f"give {low:g} to {high:g}")

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The stable poles of the runs inside ``band_hz``, merged, with residues; every pole's fate as candidates."""
        together = [r.run for r in campaign.runs if len(r.select(ChannelRole.REFERENCE)[0]) > 1]
        if together:
            runs = ", ".join(map(str, together))
            why = f"several forces were measured at once in run {runs}, and this method takes one: use 'auto'"
            return ModalModel.empty(Outcome.DECLINED, (why,))
        spectra = campaign_spectra(campaign, band_hz)
        remarks = spectra.remarks
        if not spectra.runs:
            return ModalModel.empty(Outcome.DECLINED, (*remarks, "no run has a usable force and a usable response"))
        lines = spectra.frequency_hz.size
        if lines < FEWEST_LINES:
            why = f"the band {band_hz[0]:g} to {band_hz[1]:g} Hz holds {lines} lines, {FEWEST_LINES} are needed"
            return ModalModel.empty(Outcome.NOTHING_FOUND, (*remarks, why), dofs=spectra.responses)
        try:
            found = [self._of_run(campaign, spectra, i, band_hz) for i in range(len(spectra.runs))]
        except TooFewError as error:
            return ModalModel.empty(Outcome.NOTHING_FOUND, (*remarks, str(error)), dofs=spectra.responses)
        any_mode = any(f.modes.poles.size for f in found)
        groups = common_modes(tuple(f.modes for f in found)) if any_mode else np.empty((0, len(found)), dtype=int)
        needed = max(1, int(np.ceil(self.least_runs * len(found))))
        seen = (groups >= 0).sum(axis=1)
        candidates = _candidates(found, groups, needed)
        groups = groups[seen >= needed]
        if not groups.size:
            why = f"no pole is stable over the orders in {needed} of {len(found)} runs: measure longer"
            empty = ModalModel.empty(Outcome.NOTHING_FOUND, (*remarks, why), dofs=spectra.responses)
            return replace(empty, candidates=candidates)
        return flag_non_modes(campaign, replace(_claim(spectra, found, groups), candidates=candidates))

    def _of_run(self, campaign: Campaign, spectra: CampaignSpectra, which: int, band_hz: tuple[float, float]) -> _Found:
        run = spectra.runs[which]
        record = next(r for r in campaign.runs if r.run == run.run)
        samples = prepared(record, band_hz[1])
        criteria = Criteria(least_share=self.least_share, largest_damping_ratio=self.largest_damping_ratio)
        options = SubspaceOptions(
            self.weighting, self.block_rows, self.largest_order, self.replicates, self.seed, criteria
        )
        stable = stable_poles(samples, band_hz, options)
        stable, residues = significant(spectra.frequency_hz, (run,), stable, transient=True)
        noise = noise_power(record, samples, run, spectra.frequency_hz)
        poles = deviations(samples, noise, stable, options, run)
        modes = RunModes(
            run.run,
            run.reference,
            run.responses,
            poles.poles_rad_s,
            residues[0].residues.T,
            poles.frequency_std_hz,
            poles.damping_ratio_std,
        )
        return _Found(stable, poles, modes)


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """What one run shows."""

    stable: Stabilisation
    poles: ModePoles
    modes: RunModes


def _claim(spectra: CampaignSpectra, found: list[_Found], groups: NDArray[np.intp]) -> ModalModel:
    """The modal model of groups (M, runs) of modes; a run that lacks a mode is fitted with the pole of the others."""
    every = tuple(f.modes for f in found)
    merged = [merged_pole(every, group) for group in groups]
    omega = 2 * np.pi * np.array([p.natural_frequency_hz for p in merged])
    damping = np.array([p.damping_ratio for p in merged])
    shared = omega * (-damping + 1j * np.sqrt(1 - damping**2))
    runs = []
    for index, (run, one) in enumerate(zip(spectra.runs, every, strict=True)):
        own = groups[:, index]
        poles = np.where(own >= 0, one.poles[own] if one.poles.size else shared, shared)
        std_hz = np.where(own >= 0, one.frequency_std_hz[own] if one.poles.size else np.inf, np.inf)
        std_ratio = np.where(own >= 0, one.damping_ratio_std[own] if one.poles.size else np.inf, np.inf)
        residues = fit_residues(run, spectra.frequency_hz, poles)
        runs.append(
            replace(
                one, poles=poles, residues=residues.residues.T, frequency_std_hz=std_hz, damping_ratio_std=std_ratio
            )
        )
    return claim_of_own_poles(tuple(runs), (groups >= 0).T, spectra.remarks)


def _candidates(found: list[_Found], groups: NDArray[np.intp], needed: int) -> tuple[PoleCandidate, ...]:
    """Every pole of every run with its fate."""
    count = (groups >= 0).sum(axis=1)
    poles: list[PoleCandidate] = []
    for index, one in enumerate(found):
        stable = one.stable
        for mode, cluster in enumerate(stable.modes):
            runs = int(count[groups[:, index] == mode][0])
            if runs < needed:
                why = f"stable, but in {runs} of {len(found)} runs only"
                stable = stable.without(cluster, f"{cluster.frequency_hz:.4g} Hz: {why}")
        label = "" if len(found) == 1 else f"run {one.modes.run}, "
        poles += [replace(c, reason=label + c.reason) for c in stable.candidates()]
    return tuple(poles)
