"""A claim from the poles that a library found at many orders: those that stay, and the residues that go with them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vgvt.data import Campaign, ModalModel, Outcome, PoleCandidate
from vgvt_identifiers.common_modes import RunModes, common_modes
from vgvt_identifiers.merged_claim import merged_claim
from vgvt_identifiers.non_modes import flag_non_modes
from vgvt_identifiers.pole_claim import widened
from vgvt_identifiers.residues import fit_residues
from vgvt_identifiers.significant import significant
from vgvt_identifiers.spectra import FEWEST_LINES, CampaignSpectra, RunSpectra, campaign_spectra
from vgvt_identifiers.stabilisation import Criteria, PolesAtOrder, Stabilisation, stabilise

_MARGIN = 0.3
_RESOLVED = 0.25  # of the distance of two lines
_LEAST_SHARE_OF_RUNS = 1 / 3  # a pole of few runs is none of the structure's


def spectra_or_reason(campaign: Campaign, band_hz: tuple[float, float]) -> CampaignSpectra | ModalModel:
    """The spectra of a campaign, or the empty claim that says why there are none."""
    # Wider than asked for, where there is excitation: at the edges of their band the libraries see poles that are none.
    spectra = campaign_spectra(campaign, widened(band_hz, campaign.band_hz, _MARGIN))
    if not spectra.runs:
        why = "no run has a usable force and a usable response"
        return ModalModel.empty(Outcome.DECLINED, (*spectra.remarks, why))
    if spectra.frequency_hz.size < FEWEST_LINES:
        lines = spectra.frequency_hz.size
        why = f"the band {band_hz[0]:g} to {band_hz[1]:g} Hz holds {lines} lines, {FEWEST_LINES} are needed"
        return ModalModel.empty(Outcome.NOTHING_FOUND, (*spectra.remarks, why), dofs=spectra.responses)
    return spectra


def claim_of_tables(
    campaign: Campaign,
    spectra: CampaignSpectra,
    tables: Sequence[Sequence[PolesAtOrder]],
    band_hz: tuple[float, float],
    largest_damping_ratio: float,
) -> ModalModel:
    """The claim of the poles inside the band that stay over the orders, from one table for all runs or one a run.

    No standard deviations are stated for the poles of one table, as the
    libraries state none; the runs' own poles give the scatter between them.
    """
    shared = len(tables) == 1
    parts = (spectra.runs,) if shared else tuple((run,) for run in spectra.runs)
    modes: list[RunModes] = []
    candidates: list[PoleCandidate] = []
    for runs, table in zip(parts, tables, strict=True):
        found, stable = _modes(spectra, runs, table, band_hz, largest_damping_ratio)
        modes += found
        candidates += stable.candidates()
    if not shared:
        modes = _of_most_runs(spectra, modes)
    if not any(m.poles.size for m in modes):
        why = "no pole stays from order to order: measure longer, or raise the orders"
        empty = ModalModel.empty(Outcome.NOTHING_FOUND, (*spectra.remarks, why), dofs=spectra.responses)
        return replace(empty, candidates=tuple(candidates))
    claim = merged_claim(tuple(modes), poles="common" if shared else "per-run", advice=spectra.remarks)
    return flag_non_modes(campaign, replace(claim, candidates=tuple(candidates))).band(*band_hz)


def _of_most_runs(spectra: CampaignSpectra, modes: list[RunModes]) -> list[RunModes]:
    """Without poles that only few runs have: they are none of the structure's, and took a share of its residues."""
    known = [m for m in modes if m.poles.size]
    groups = common_modes(tuple(known)) if known else np.empty((0, 0), int)
    kept = groups[(groups >= 0).sum(axis=1) >= _LEAST_SHARE_OF_RUNS * len(modes)]
    fitted = []
    for place, own in enumerate(known):
        poles = own.poles[np.sort(kept[kept[:, place] >= 0, place])]
        (run,) = (r for r in spectra.runs if r.run == own.run)
        residues = fit_residues(run, spectra.frequency_hz, poles).residues.T
        unknown = np.full(poles.size, np.nan)
        fitted.append(replace(own, poles=poles, residues=residues, frequency_std_hz=unknown, damping_ratio_std=unknown))
    return fitted


def _modes(
    spectra: CampaignSpectra,
    runs: tuple[RunSpectra, ...],
    table: Sequence[PolesAtOrder],
    band_hz: tuple[float, float],
    largest_damping_ratio: float,
) -> tuple[list[RunModes], Stabilisation]:
    """The modes of some runs that share their poles, and the fate of every pole."""
    step = 2 * np.pi * float(spectra.frequency_hz[1] - spectra.frequency_hz[0])
    criteria = Criteria(largest_damping_ratio=largest_damping_ratio, resolution_rad_s=_RESOLVED * step)
    stable = stabilise([_inside(row, band_hz) for row in table], criteria)
    stable, parts = significant(spectra.frequency_hz, runs, stable, True)
    poles = np.array([c.pole_rad_s for c in stable.modes], complex)
    unknown = np.full(poles.size, np.nan)
    modes = [
        RunModes(run.run, run.reference, run.responses, poles, part.residues.T, unknown, unknown)
        for run, part in zip(runs, parts, strict=True)
    ]
    return modes, stable


def _inside(row: PolesAtOrder, band_hz: tuple[float, float]) -> PolesAtOrder:
    natural = np.abs(row.poles_rad_s) / (2 * np.pi)
    keep = (natural >= band_hz[0]) & (natural <= band_hz[1]) & (row.poles_rad_s.imag > 0)
    return PolesAtOrder(row.order, row.poles_rad_s[keep], row.vectors[keep])
