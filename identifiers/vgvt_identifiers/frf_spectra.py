"""A set of frequency responses in the form in which the methods of this package take spectra of runs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vgvt.data import Campaign, FrequencyResponseSet, InputError, Quantity
from vgvt.signals import estimate_frf
from vgvt_identifiers.spectra import CampaignSpectra, RunSpectra


def several_forces_spectra(campaign: Campaign, band_hz: tuple[float, float]) -> CampaignSpectra:
    """Spectra of runs in which several forces act at once: each run once for every reference, told apart by averages.

    Nothing usable gives no runs and the reason as a remark.
    """
    try:
        frf = estimate_frf(campaign, "auto")
    except InputError as error:
        return CampaignSpectra(np.empty(0), (), (str(error).splitlines()[0],))
    parts = [frf_spectra(_one_reference(frf, k), band_hz) for k in range(len(frf.references))]
    runs = tuple(run for part in parts for run in part.runs)
    return CampaignSpectra(frf.band(*band_hz).frequency_hz, runs, frf.remarks)


def _one_reference(frf: FrequencyResponseSet, k: int) -> FrequencyResponseSet:
    return replace(
        frf,
        references=(frf.references[k],),
        values=frf.values[:, [k]],
        variance=None if frf.variance is None else frf.variance[:, [k]],
        coherence=None if frf.coherence is None else frf.coherence[:, [k]],
    )


def frf_spectra(frf: FrequencyResponseSet, band_hz: tuple[float, float]) -> CampaignSpectra:
    """The accelerances of a set with one reference as spectra of its runs, on the lines inside ``band_hz``.

    The force counts as one at every line, since only ratios are known, so that the
    transient of a record cannot be told from them. Where the set states no variance
    it is that of one line, the mean square of how third neighbours differ. InputError for
    several references or other quantities.
    """
    if len(frf.references) != 1 or frf.quantity is not Quantity.ACCELERATION:
        raise InputError("FRF set", "needs accelerances of one reference", "take the references one by one")
    part = frf.band(*band_hz)
    values = part.values[:, 0]
    variance = None if part.variance is None else part.variance[:, 0]
    if variance is None or not np.isfinite(variance).all():
        rough = np.diff(values, 3, axis=1)
        level = np.median(np.abs(rough) ** 2, axis=1, keepdims=True) / (20 * np.log(2))
        variance = np.broadcast_to(level, values.shape)
    runs = []
    for run in sorted(set(part.runs)):
        rows = [i for i, r in enumerate(part.runs) if r == run]
        force = np.ones(values.shape[1], complex)
        own, noise = values[rows], np.asarray(variance[rows])
        names = tuple(part.responses[i] for i in rows)
        runs.append(RunSpectra(run, part.references[0], names, force, own, noise, own, noise))
    return CampaignSpectra(part.frequency_hz, tuple(runs), part.remarks)
