"""Residues of every mode in every run, also in those that show too little of it to find its pole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vgvt_identifiers.common_modes import RunModes, common_modes
from vgvt_identifiers.merged_claim import merged_pole
from vgvt_identifiers.residues import fit_residues
from vgvt_identifiers.spectra import CampaignSpectra


def completed_runs(
    spectra: CampaignSpectra,
    run_modes: tuple[RunModes, ...],
    *,
    tolerance: float = 0.02,
    least_mac: float = 0.5,
    fewest_runs: int = 1,
) -> tuple[RunModes, ...]:
    """The runs, one for each of ``spectra``, with all modes: a pole that a run lacks is the average of the others'.

    All residues are fitted again, so that a shape has a value at every DOF. Poles put
    in have infinite standard deviations: ``merged_claim`` does not count or average them.
    """
    groups = common_modes(run_modes, tolerance, least_mac)
    groups = groups[(groups >= 0).sum(axis=1) >= min(fewest_runs, len(run_modes))]
    merged = [merged_pole(run_modes, group) for group in groups]
    omega = 2 * np.pi * np.array([p.natural_frequency_hz for p in merged])
    ratio = np.array([p.damping_ratio for p in merged])
    average = omega * (-ratio + 1j * np.sqrt(np.maximum(1 - ratio**2, 0)))
    whole = []
    for run, (modes, spectrum) in enumerate(zip(run_modes, spectra.runs, strict=True)):
        place = groups[:, run]
        own = place >= 0
        poles, std_hz, std_ratio = average.copy(), np.full(omega.size, np.inf), np.full(omega.size, np.inf)
        poles[own] = modes.poles[place[own]]
        std_hz[own], std_ratio[own] = modes.frequency_std_hz[place[own]], modes.damping_ratio_std[place[own]]
        order = np.argsort(np.abs(poles), kind="stable")
        fit = fit_residues(spectrum, spectra.frequency_hz, poles[order])
        whole.append(
            replace(
                modes,
                poles=poles[order],
                residues=fit.residues.T,
                frequency_std_hz=std_hz[order],
                damping_ratio_std=std_ratio[order],
            )
        )
    return tuple(whole)
