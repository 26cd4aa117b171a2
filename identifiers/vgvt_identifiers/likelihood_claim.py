"""From a settled fit to a claim: the modes it stands by, their shapes, and the fate of every pole."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.data import ModalModel, Outcome, PoleCandidate
from vgvt_identifiers.campaign_fit import CampaignFit, poles_of_runs
from vgvt_identifiers.common_modes import RunModes
from vgvt_identifiers.merged_claim import merged_claim
from vgvt_identifiers.pole_covariance import pole_covariance, pole_deviations
from vgvt_identifiers.pole_fit import fit_poles
from vgvt_identifiers.pole_verdict import DOUBTFUL_DEVIATION, wrong_at_the_drive_point
from vgvt_identifiers.spectra import CampaignSpectra
from vgvt_identifiers.unclaimed import one_flank_advice


def likelihood_claim(
    spectra: CampaignSpectra,
    fit: CampaignFit,
    poles: Literal["per-run", "common"],
    remarks: tuple[str, ...],
    band_hz: tuple[float, float],
) -> ModalModel:
    """The claimed modes in the band: shapes over all DOFs, standard deviations, flags, and every pole as a candidate.

    A pole that hardly any run knows by itself may leave the band when the runs are put together.
    """
    claimed = np.array([v.claimed for v in fit.verdicts], dtype=bool)
    remarks = (*remarks, *one_flank_advice(fit.states.poles, fit.verdicts))
    why = "no pole stands out of noise and background: measure longer, or raise the force"
    nothing = ModalModel.empty(Outcome.NOTHING_FOUND, (*remarks, why), dofs=spectra.responses)
    nothing = replace(nothing, candidates=_candidates(fit))
    if not claimed.any():
        return nothing
    runs = _common_poles(spectra, fit) if poles == "common" else poles_of_runs(spectra, fit)
    index = np.flatnonzero(claimed)
    flags = tuple(_flags(runs, int(i)) for i in index)
    wrong = wrong_at_the_drive_point(runs)[index]
    flags = tuple(
        (*f, *(("doubtful: the drive point answers with the wrong sign",) if w else ()))
        for f, w in zip(flags, wrong, strict=True)
    )
    if poles == "common":
        chosen = tuple(_chosen(r, index) for r in runs)
        claim = merged_claim(chosen, poles="common", flags=flags, advice=remarks)
    else:
        claim = merged_claim(runs, groups=np.tile(index[:, None], (1, len(runs))), flags=flags, advice=remarks)
    inside = claim.band(*band_hz)
    return replace(inside, candidates=_candidates(fit)) if len(inside) else nothing


def _chosen(modes: RunModes, index: NDArray[np.intp]) -> RunModes:
    return replace(
        modes,
        poles=modes.poles[index],
        residues=modes.residues[index],
        frequency_std_hz=modes.frequency_std_hz[index],
        damping_ratio_std=modes.damping_ratio_std[index],
    )


def _common_poles(spectra: CampaignSpectra, fit: CampaignFit) -> tuple[RunModes, ...]:
    """All runs fitted together with the same poles, and as many terms for the modes beyond the band as the fit has."""
    problem = replace(fit.problems[0], rows=tuple(r for p in fit.problems for r in p.rows))
    state = fit_poles(problem, fit.states.poles)
    covariance = pole_covariance(problem, state, fit.noise, tuple(r.force for r in spectra.runs))
    std_hz, std_ratio = pole_deviations(state.poles, covariance)
    return tuple(
        RunModes(run.run, run.reference, run.responses, state.poles, residues.T, std_hz, std_ratio)
        for run, residues in zip(spectra.runs, state.residues, strict=True)
    )


def _flags(runs: tuple[RunModes, ...], mode: int) -> tuple[str, ...]:
    ratio = np.array([-r.poles[mode].real / abs(r.poles[mode]) for r in runs])
    deviation = np.array([r.damping_ratio_std[mode] for r in runs])
    together = 1 / np.sqrt((1 / deviation**2).sum()) if np.isfinite(deviation).any() else np.inf
    return ("doubtful: damping poorly known",) if together > DOUBTFUL_DEVIATION * ratio.mean() else ()


def _candidates(fit: CampaignFit) -> tuple[PoleCandidate, ...]:
    order = int(fit.states.poles.size)
    rows = [
        *((complex(p), v.claimed, v.reason) for p, v in zip(fit.states.poles, fit.verdicts, strict=True)),
        *((p, False, why) for p, why in fit.dropped),
    ]
    rows.sort(key=lambda r: abs(r[0]))
    return tuple(PoleCandidate(abs(p) / (2 * np.pi), -p.real / abs(p), order, kept, reason) for p, kept, reason in rows)
