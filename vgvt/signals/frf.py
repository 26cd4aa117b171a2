"""Frequency response functions of a campaign, roving sensors and repeated runs included."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from vgvt.data import Campaign, ChannelRole, FrequencyResponseSet, InputError
from vgvt.data.suggestion import choose_one_of
from vgvt.signals.assemble import Key, ResponseEstimate, assemble
from vgvt.signals.averages import Averages, overlapping_parts
from vgvt.signals.cross import CrossSpectra
from vgvt.signals.dwells import DwellFit, DwellSchedule, dwell_schedule, with_known_variance
from vgvt.signals.impact import ImpactWindows, impact_windows
from vgvt.signals.local_polynomial import LocalFit, local_polynomial_fit
from vgvt.signals.periods import PeriodicPart, periodic_part
from vgvt.signals.plan import Plan, make_plan
from vgvt.signals.rational_estimates import rational_estimates
from vgvt.signals.several_forces import check_independent, estimator_of_several, independent_periods
from vgvt.signals.single_force import estimator_of_one
from vgvt.signals.usable import UsableRun, usable_runs

ESTIMATORS = {
    "ratio": "whole-record spectra divided, no window; for sweeps that start and end at rest",
    "local_polynomial": "whole-record spectra, local fit that takes out leakage and states a variance",
    "local_rational": "whole-record spectra, local fit of resonances too; tells forces that act at once apart",
    "h1": "averaged, noise on the response; for random excitation or repeated runs",
    "h2": "averaged, noise on the force; one reference",
    "hv": "averaged, noise on both; one reference",
    "stepped_sine": "sines fitted to whole cycles of every dwell, after its time to settle",
    "impact": "averaged over a hammer's hits, noise on the response, force and exponential windows",
    "auto": "stepped_sine or impact where the notes tell of dwells or hits; ratio where records start and end at rest, "
    "and for a sweep cut off at its end; for several forces h1 over the bursts of the notes, or ratio where repeats at "
    "rest tell them apart; else h1 over the periods of the notes that repeat, or local_rational",
}


def estimate_frf(
    campaign: Campaign,
    estimator: str = "ratio",
    segment_s: float | None = None,
    *,
    window: str = "hann",
    overlap: float = 0.5,
    band_hz: tuple[float, float] | None = None,
    local_variance: bool = False,
    polynomial_order: int = 2,
    half_width: int = 8,
    dwells: DwellSchedule | None = None,
    impacts: ImpactWindows | None = None,
) -> FrequencyResponseSet:
    """Frequency responses of all runs on one frequency axis: values (responses, references, lines), SI.

    ``ratio`` divides whole-record spectra, without window or averaging, as the
    authors of the Hati test did (AIAA 2016-1753) and as a single sweep needs;
    runs that repeat a DOF are averaged, weighted by the power of their force; several forces need as many
    repeats, and their variance is told from neighbouring lines. ``h1``, ``h2`` and
    ``hv`` average windowed segments of ``segment_s`` (Bendat and Piersol, Random
    Data, chapter 6; ISO 7626-2), over repeated runs too; without ``segment_s``
    they average whole records and need repeats. ``local_polynomial`` fits
    ``polynomial_order`` over 2 ``half_width`` + 1 lines (Schoukens et al. 2009);
    ``local_variance`` gives ``ratio`` a variance by the same fit. ``local_rational`` fits what resonates
    too, all runs together whatever their length, and has a value every few lines, so that their errors are
    nearly independent; its window is widened to what several forces need. The line at 0 Hz
    is left out, means are removed; ``band_hz`` keeps only some lines.
    ``stepped_sine`` has a line a dwell of ``dwells`` and takes its variance from the blocks of a
    dwell; ``impact`` is H1 over the hits, cut by ``impacts``: its remarks say what damping the
    exponential window adds (`without_window_damping`). Left out, both are read from the notes.

    ``auto`` divides whole records only where they start and end at rest, as their first and last samples and the
    note ``unrecorded_s`` tell, or hold a sweep from rest that is cut off; its remarks say what else it takes, and why.

    ``12-Z`` in one run and ``12+Z`` in another are one response, labelled as first
    seen. Channels that cannot be used are left out and named in ``remarks``.
    Variance and coherence are None where the estimator cannot tell.
    InputError: unusable reference, no response left, runs that do not share
    rate (and length, for whole records), or too few averages.
    """
    if estimator not in ESTIMATORS:
        raise InputError("estimator", f"unknown: {estimator!r}", choose_one_of(estimator, ESTIMATORS))
    if estimator not in ("h1", "h2", "hv") and segment_s is not None:
        raise InputError("segment_s", f"the {estimator} estimator takes whole records", "leave it out, or use 'h1'")
    several = estimator == "auto" and any(len(r.select(ChannelRole.REFERENCE)[0]) > 1 for r in campaign.runs)
    asked = estimator
    estimator, special = _special(campaign, estimator, dwells, impacts)
    runs, remarks = usable_runs(campaign)
    averages = Averages(segment_s, window, overlap)
    said: tuple[str, ...] = ()
    if several and estimator == "ratio":
        estimator, averages = estimator_of_several(campaign, runs)
    elif asked == "auto" and estimator == "ratio":
        estimator, said = estimator_of_one(campaign, runs)
    if asked == "auto" and estimator == "local_rational":
        periodic = periodic_part(campaign, runs)
        if periodic is not None and (not several or independent_periods(periodic.campaign, periodic.count)):
            return _of_periods(periodic, band_hz)
    own_lines = estimator == "local_rational"
    plan, more = make_plan(campaign.name, runs, averages, band_hz, special, own_lines=own_lines)
    more = (*more, *said)
    local = (polynomial_order, half_width)
    if estimator == "local_rational":
        try:
            estimates, plan, fitted = rational_estimates(campaign, runs, plan, *local)
        except InputError as error:
            if several:
                return _averaged_parts(campaign, band_hz, error)
            if asked != "auto":
                raise
            return _divided(campaign, band_hz, local_variance, error)
        more = (*more, fitted)
    elif estimator == "local_polynomial":
        estimates = _local_estimates(runs, plan, local)
    else:
        noise_fit = local if local_variance and estimator == "ratio" else None
        sums = _summed(runs, plan, noise_fit)
        for key, total in sums.items():
            _check_averages(f"{campaign.name}, response {key[0]}", total, estimator)
            _check_independent_forces(campaign, key, total, plan)
        estimates = {key: _resolve(total, estimator) for key, total in sums.items()}
        if estimator == "stepped_sine":
            estimates = {key: _with_filled_variance(e, sums[key], plan) for key, e in estimates.items()}
    return assemble(campaign.name, estimates, plan, (*remarks, *more))


def _averaged_parts(campaign: Campaign, band_hz: tuple[float, float] | None, error: InputError) -> FrequencyResponseSet:
    """H1 over windowed parts of the records, for several forces that no local fit can tell apart, with a remark."""
    parts = overlapping_parts(campaign)
    assert parts.segment_s is not None, "parts are shorter than a record"
    frf = estimate_frf(campaign, "h1", parts.segment_s, window=parts.window, overlap=parts.overlap, band_hz=band_hz)
    why = (
        f"averages over {parts.segment_s:g} s under a window, for no local fit is possible ({error.problem}): damping "
        f"is too high, and more than its ± says, where a mode is not much wider than {4 / parts.segment_s:.3g} Hz"
    )
    return replace(frf, remarks=(*frf.remarks, why))


def _of_periods(part: PeriodicPart, band_hz: tuple[float, float] | None) -> FrequencyResponseSet:
    """H1 over whole periods, or the division of one, without a window: periods that repeat do not leak."""
    if part.count == 1:
        return part.harmonics(estimate_frf(part.campaign, "ratio", band_hz=band_hz))
    period_s = part.periods.period_s
    frf = estimate_frf(part.campaign, "h1", period_s, window="boxcar", overlap=0.0, band_hz=band_hz)
    return part.harmonics(frf)


def _divided(
    campaign: Campaign, band_hz: tuple[float, float] | None, local_variance: bool, error: InputError
) -> FrequencyResponseSet:
    """Whole spectra divided in spite of what they leak, for one force where no local fit is possible, with a remark."""
    frf = estimate_frf(campaign, "ratio", band_hz=band_hz, local_variance=local_variance)
    why = (
        "whole records are divided though they do not start and end at rest, for no local fit is possible "
        f"({error.problem}): responses are wrong by what leaks"
    )
    return replace(frf, remarks=(*frf.remarks, why))


def _special(
    campaign: Campaign, estimator: str, dwells: DwellSchedule | None, impacts: ImpactWindows | None
) -> tuple[str, DwellSchedule | ImpactWindows | None]:
    """The estimator that is meant, and the dwells or hits that it cuts the records at."""
    if estimator in ("auto", "stepped_sine"):
        dwells = dwells or dwell_schedule(campaign)
    if estimator in ("auto", "impact"):
        impacts = impacts or impact_windows(campaign)
    if estimator == "auto":
        estimator = "stepped_sine" if dwells else "impact" if impacts else "ratio"
    special = {"stepped_sine": dwells, "impact": impacts}
    if estimator in special and special[estimator] is None:
        key, noun = {"stepped_sine": ("dwells", "DwellSchedule"), "impact": ("impacts", "ImpactWindows")}[estimator]
        raise InputError(
            f"{campaign.name}, estimator {estimator!r}",
            f"the campaign's notes have no {key!r}",
            f"pass {key}={noun}(…), or choose another estimator",
        )
    return estimator, special.get(estimator)


def _with_filled_variance(estimate: ResponseEstimate, total: CrossSpectra, plan: Plan) -> ResponseEstimate:
    """The variance of dwells with one block from their neighbours; no coherence, which one block cannot tell."""
    if estimate.variance is None:
        return replace(estimate, coherence=None)
    cut = plan.cuts[total.first_run]
    assert isinstance(cut, DwellFit), "stepped_sine cuts at dwells"
    power = np.einsum("iil->l", total.reference).real
    variance = with_known_variance(estimate.variance, power, cut.block_s[plan.lines])
    return replace(estimate, variance=variance, coherence=None)


def _summed(runs: tuple[UsableRun, ...], plan: Plan, noise_fit: tuple[int, int] | None) -> dict[Key, CrossSpectra]:
    """Cross spectra of every response, summed over the segments of all runs that measured it."""
    sums: dict[Key, CrossSpectra] = {}
    for run in runs:
        for key, spectra in _cross_spectra(run, plan, noise_fit):
            sums[key] = sums[key].plus(spectra) if key in sums else spectra
    return sums


def _cross_spectra(run: UsableRun, plan: Plan, noise_fit: tuple[int, int] | None) -> Iterable[tuple[Key, CrossSpectra]]:
    """The cross spectra of every response of one run; the force spectra are shared between them."""
    references, full = plan.forces(run)
    force = full[:, :, plan.lines]
    auto = np.einsum("isl,jsl->ijl", force, force.conj())
    averages = plan.cuts[run.run].effective_averages()
    averages = averages if np.ndim(averages) == 0 else np.asarray(averages)[plan.lines]
    for channel, samples in zip(run.responses, run.response_samples, strict=True):
        spectrum = plan.spectrum(run.run, channel, samples)
        noise = None
        if noise_fit is not None and len(references) == 1:
            noise = local_polynomial_fit(spectrum, full[0], plan.lines, *noise_fit).noise_power[0] * auto[0, 0].real
        response = spectrum[:, plan.lines]
        cross = np.einsum("sl,jsl->jl", response, force.conj())
        power = (np.abs(response) ** 2).sum(axis=0)
        yield (plan.label(channel), references), CrossSpectra(run.run, averages, auto, cross, power, noise)


def _resolve(total: CrossSpectra, estimator: str) -> ResponseEstimate:
    values = {"h2": total.h2, "hv": total.hv}.get(estimator, total.h1)()
    # With less than half an average to spare the scatter says nothing.
    spare = np.max(total.averages) - total.reference.shape[0] >= 0.5
    variance = None
    if spare:
        variance = total.hv_variance() if estimator == "hv" else total.variance(values)
    if total.noise is not None:
        power = total.reference[0, 0].real
        blank = np.full_like(power, np.nan)
        variance = np.divide(total.noise, power**2, out=blank, where=power > 0)[None]
    elif estimator == "ratio" and total.reference.shape[0] > 1:
        # Repeats are few: on one line their scatter says little, if it says anything, and neighbours know more.
        variance = total.rough_variance(values)
    coherence = np.broadcast_to(total.coherence(), values.shape) if spare else None
    return ResponseEstimate(total.first_run, values, variance, coherence)


def _local_estimates(runs: tuple[UsableRun, ...], plan: Plan, local: tuple[int, int]) -> dict[Key, ResponseEstimate]:
    """Local polynomial fits of every run; repeats are combined with the inverse of their variance."""
    fits: dict[Key, list[tuple[int, LocalFit]]] = {}
    for run in runs:
        references, full = plan.forces(run)
        for channel, samples in zip(run.responses, run.response_samples, strict=True):
            spectrum = plan.spectrum(run.run, channel, samples)
            fit = local_polynomial_fit(spectrum, full[:, 0], plan.lines, *local)
            fits.setdefault((plan.label(channel), references), []).append((run.run, fit))
    order, half_width = local
    spare = {key: 2 * half_width + 1 - (len(key[1]) + 1) * (order + 1) for key in fits}
    return {key: _combined(parts, spare[key]) for key, parts in fits.items()}


def _combined(parts: list[tuple[int, LocalFit]], spare: int) -> ResponseEstimate:
    """The mean of fits, weighted by the inverse of their variance, each told from ``spare`` complex residuals.

    Weights that are estimates make it worse than known ones would, and seem better than it is: to first order the
    variance is 1/W (1 + 4 Σ w/W (1 - w/W) / ν), ν two for each residual; Meier, Variance of a weighted mean,
    Biometrics 9(1), 1953.
    """
    weights = [1 / np.maximum(fit.variance[0], np.finfo(float).tiny) for _, fit in parts]
    total = np.sum(weights, axis=0)
    values = np.sum([w * fit.values[0] for w, (_, fit) in zip(weights, parts, strict=True)], axis=0) / total
    uncertain = 4 / (2 * spare) * np.sum([w / total * (1 - w / total) for w in weights], axis=0)
    return ResponseEstimate(parts[0][0], values, np.asarray((1 + uncertain) / total), None)


def _check_averages(where: str, total: CrossSpectra, estimator: str) -> None:
    """InputError when the averages cannot hold the estimate."""
    inputs = total.reference.shape[0]
    if estimator in ("h2", "hv") and inputs > 1:
        raise InputError(where, f"{estimator} is defined for one reference, there are {inputs}", "use 'h1'")
    least = inputs if estimator in ("ratio", "stepped_sine", "impact") else inputs + 0.5
    averages = float(np.min(total.averages))
    if averages < least:
        raise InputError(
            where,
            f"{estimator} with {inputs} reference{'s' * (inputs > 1)} needs more averages than the "
            f"{averages:.3g} there are",
            "give segment_s (a fraction of the record), repeat the runs, or use 'ratio' for a single sweep and "
            "'local_rational' for several forces",
        )


def _check_independent_forces(campaign: Campaign, key: Key, total: CrossSpectra, plan: Plan) -> None:
    """InputError when several forces are copies of one another within the excited band."""
    check_independent(campaign, key[1], total.reference, plan.frequency_hz[plan.lines])
