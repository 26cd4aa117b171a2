"""A set of frequency responses in the form in which the methods of this package take spectra of runs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vgvt.data import Campaign, ChannelRole, FrequencyResponseSet, InputError, Quantity
from vgvt.signals import estimate_frf
from vgvt_identifiers.spectra import DIFFERENTIATIONS, CampaignSpectra, RunSpectra


def several_forces_spectra(campaign: Campaign, band_hz: tuple[float, float]) -> CampaignSpectra:
    """Spectra of runs in which several forces act at once: each run once for every reference, told apart beforehand.

    Velocities and displacements are differentiated; channels that are no motion are left out with a remark.
    Nothing usable gives no runs and the reason as a remark.
    """
    motions, remarks = _motions(campaign)
    if motions is None:
        return CampaignSpectra(np.empty(0), (), remarks)
    try:
        frf = _accelerances(estimate_frf(motions, "auto"))
    except InputError as error:
        return CampaignSpectra(np.empty(0), (), (*remarks, str(error).splitlines()[0]))
    frf, more = _with_force(frf.band(*band_hz))
    parts = [frf_spectra(_one_reference(frf, k), band_hz) for k in range(len(frf.references))]
    runs = tuple(run for part in parts for run in part.runs)
    return CampaignSpectra(frf.frequency_hz, runs, (*remarks, *frf.remarks, *more))


def _motions(campaign: Campaign) -> tuple[Campaign | None, tuple[str, ...]]:
    """The campaign without responses that are no motion and runs without any that is, and a remark for each.

    None where no run is left.
    """
    remarks: list[str] = []
    runs = []
    for record in campaign.runs:
        other = [c.role is ChannelRole.RESPONSE and c.quantity not in DIFFERENTIATIONS for c in record.channels]
        remarks += [
            f"run {record.run}: {c.name} ({c.dof}) left out, it measures no motion"
            for c, out in zip(record.channels, other, strict=True)
            if out
        ]
        kept = [i for i, out in enumerate(other) if not out]
        channels = tuple(record.channels[i] for i in kept)
        if not any(channel.role is ChannelRole.RESPONSE for channel in channels):
            remarks.append(f"run {record.run} left out: no usable response")
        elif len(kept) == len(other):
            runs.append(record)
        else:
            overloaded = tuple(name for name in record.overloaded if name in {c.name for c in channels})
            runs.append(replace(record, channels=channels, samples=record.samples[kept], overloaded=overloaded))
    return (replace(campaign, runs=tuple(runs)) if runs else None), tuple(remarks)


def _accelerances(frf: FrequencyResponseSet) -> FrequencyResponseSet:
    """The same with responses differentiated to accelerations."""
    omega = 2j * np.pi * frf.frequency_hz
    factor = omega ** DIFFERENTIATIONS[frf.quantity]
    variance = None if frf.variance is None else frf.variance * np.abs(factor) ** 2
    return replace(frf, values=frf.values * factor, variance=variance, quantity=Quantity.ACCELERATION)


def _with_force(frf: FrequencyResponseSet) -> tuple[FrequencyResponseSet, tuple[str, ...]]:
    """The longest stretch of lines on which every response is known, and a remark where it is not the whole band."""
    known = np.asarray(np.isfinite(frf.values).all(axis=(0, 1)))
    if known.all():
        return frf, ()
    edges = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]).astype(int)))
    starts, ends = edges[::2], edges[1::2]
    if not starts.size:
        return frf.lines(known), ("no line of the band has every force",)
    longest = int(np.argmax(ends - starts))
    low, high = (float(frf.frequency_hz[i]) for i in (starts[longest], ends[longest] - 1))
    what = f"{np.count_nonzero(~known)} lines lack a force: the lines from {low:.4g} to {high:.4g} Hz are used"
    return frf.band(low, high), (what,)


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
    return CampaignSpectra(part.frequency_hz, tuple(runs), part.remarks, part.added_decay_rad_per_s)
