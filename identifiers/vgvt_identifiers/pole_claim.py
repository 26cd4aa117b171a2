"""Which patterns of poles are modes, and the claim that they make.

A pattern is a mode when the responses need it: its residues must lower their
misfit by more than its unknowns could by fitting noise.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, InputError, ModalModel, Outcome
from vgvt.signals import estimate_frf, without_window_damping
from vgvt_identifiers.common_modes import RunModes
from vgvt_identifiers.frf_spectra import frf_spectra
from vgvt_identifiers.merged_claim import merged_claim
from vgvt_identifiers.pole_patterns import Pattern, PatternOptions, Patterns, SourcePoles, find_patterns
from vgvt_identifiers.pole_verdict import DOUBTFUL_DEVIATION
from vgvt_identifiers.residues import Residues, fit_residues
from vgvt_identifiers.spectra import FEWEST_LINES, CampaignSpectra, RunSpectra, campaign_spectra
from vgvt_identifiers.too_few import TooFewError
from vgvt_identifiers.unclaimed import unclaimed_advice

_MODEL_ERROR = 5e-3  # of the rms response: what modes outside the band leave is known no better than that
_CLOSE = 5.0
_NEXT, _BROAD = 1.25, 0.05
_EQUATIONS_PER_UNKNOWN = 6
_UNKNOWNS = (4, 18)  # of one response: for each pole with its transient, and besides


Sources = Callable[[CampaignSpectra], tuple[SourcePoles, ...]]
"""Finds poles in spectra."""


@dataclass(frozen=True, slots=True)
class ClaimOptions:
    """How poles become a claim.

    ``margin`` is the part of the band by which the spectra reach beyond it on each
    side, as far as the campaign is excited there. ``own_poles`` fits the residues of a run at the mean pole
    of its own members, where it has any: a roving sensor's mass moves a mode, and a
    shape must not pay for it. With ``estimator`` the spectra are the frequency
    responses that suit the excitation (dwells, hits), not those of whole records.
    """

    patterns: PatternOptions
    margin: float = 0.3
    own_poles: bool = True
    estimator: bool = False


def claim_of_sources(
    campaign: Campaign, band_hz: tuple[float, float], options: ClaimOptions, sources: Sources, first: Sources | None
) -> ModalModel:
    """The modes inside ``band_hz`` out of the poles that ``sources`` finds in the spectra of a campaign.

    With ``first`` a model of its poles takes what rings at the ends of the records out of the spectra before.
    """
    wide = widened(band_hz, campaign.band_hz, options.margin)
    try:
        spectra = frf_spectra(estimate_frf(campaign, "auto"), wide) if options.estimator else None
    except InputError as error:
        return ModalModel.empty(Outcome.DECLINED, (str(error),))
    spectra = spectra or campaign_spectra(campaign, wide)
    if not spectra.runs:
        why = "no run has a usable force and a usable response"
        return ModalModel.empty(Outcome.DECLINED, (*spectra.remarks, why))
    lines = spectra.frequency_hz.size
    if lines < FEWEST_LINES:
        why = f"{lines} lines in and around {band_hz[0]:g} to {band_hz[1]:g} Hz are too few: {FEWEST_LINES} are needed"
        return ModalModel.empty(Outcome.NOTHING_FOUND, (*spectra.remarks, why), dofs=spectra.responses)
    try:
        if first is not None and not options.estimator:
            spectra = _without_transient(find_patterns(first(spectra), spectra, options.patterns), spectra, options)
        found = find_patterns(sources(spectra), spectra, options.patterns)
    except TooFewError as error:
        return ModalModel.empty(Outcome.NOTHING_FOUND, (*spectra.remarks, str(error)), dofs=spectra.responses)
    # In the margin responses are steep with the modes beyond it, which residues inside the band must not pay for.
    within = _inside(spectra, band_hz)
    model = claim_of_patterns(found, within, band_hz, options)
    return replace(model, advice=(*model.advice, *unclaimed_advice(within, model)))


def widened(band_hz: tuple[float, float], excited_hz: tuple[float, float], margin: float) -> tuple[float, float]:
    """The band with a margin on each side, a part of its width, inside what is excited; never narrower."""
    reach = margin * (band_hz[1] - band_hz[0])
    low = max(band_hz[0] - reach, min(band_hz[0], excited_hz[0]))
    return low, min(band_hz[1] + reach, max(band_hz[1], excited_hz[1]))


def _without_transient(found: Patterns, spectra: CampaignSpectra, options: ClaimOptions) -> CampaignSpectra:
    """The spectra less the transient of the records in a linear fit with the poles found; unchanged without poles."""
    _, fits = _needed(found, spectra, options)
    if not fits:
        return spectra
    runs = (
        replace(run, accelerance=run.accelerance - fit.transient) for run, fit in zip(spectra.runs, fits, strict=True)
    )
    return replace(spectra, runs=tuple(runs))


def _inside(spectra: CampaignSpectra, band_hz: tuple[float, float]) -> CampaignSpectra:
    """The same with the lines of a narrower band."""
    keep = (spectra.frequency_hz >= band_hz[0]) & (spectra.frequency_hz <= band_hz[1])
    names = ("force", "accelerance", "variance", "local", "local_variance")
    runs = tuple(replace(r, **{name: getattr(r, name)[..., keep] for name in names}) for r in spectra.runs)
    return replace(spectra, frequency_hz=spectra.frequency_hz[keep], runs=runs)


def claim_of_patterns(
    found: Patterns, spectra: CampaignSpectra, band_hz: tuple[float, float], options: ClaimOptions
) -> ModalModel:
    """The modal model of the patterns that the responses need, with residues; poles outside the band only fit."""
    found, fits = _needed(found, spectra, options)
    patterns, candidates = found.patterns, found.candidates()
    if not patterns:
        why = f"no pole in {band_hz[0]:g} to {band_hz[1]:g} Hz is one that the responses need"
        empty = ModalModel.empty(Outcome.NOTHING_FOUND, (*spectra.remarks, why), dofs=spectra.responses)
        return _without_window(replace(empty, candidates=candidates), spectra, band_hz)
    poles = np.array([p.pole_rad_s for p in patterns])
    std = np.array([(p.pole.natural_frequency_std_hz, p.pole.damping_ratio_std) for p in patterns]).T
    runs = tuple(
        RunModes(r.run, r.reference, r.responses, poles, fit.residues.T, std[0], std[1])
        for r, fit in zip(spectra.runs, fits, strict=True)
    )
    flags = tuple(_flags(p, len(found.sources)) for p in patterns)
    model = merged_claim(runs, poles="common", flags=flags, advice=spectra.remarks)
    model = _without_window(replace(model, candidates=candidates), spectra, band_hz)
    if not len(model):
        why = f"no pole that the responses need lies in {band_hz[0]:g} to {band_hz[1]:g} Hz"
        empty = ModalModel.empty(Outcome.NOTHING_FOUND, (*spectra.remarks, why), dofs=spectra.responses)
        return replace(empty, candidates=model.candidates)
    return model


def _without_window(model: ModalModel, spectra: CampaignSpectra, band_hz: tuple[float, float]) -> ModalModel:
    """The modes inside ``band_hz`` without the damping that an exponential window has added, and advice that says so.

    This comes after residues: these belong to the spectra, window and all.
    """
    added = spectra.added_decay_rad_per_s
    if added == 0:
        return model.band(*band_hz)
    again = without_window_damping(model, added).band(*band_hz)
    if not len(again):
        return again
    said = [f"the {added:.4g} rad/s that the exponential window adds are taken off every decay rate claimed"]
    still = [f"{f:.3f}" for f in again.natural_frequency_hz[again.damping_ratio == 0]]
    if still:
        said.append(
            f"no damping is left without the window at {', '.join(still)} Hz: noise, a tone, or a record cut off"
        )
    return replace(again, advice=(*again.advice, *said))


def residues_of_runs(
    spectra: CampaignSpectra, poles: tuple[NDArray[np.complex128], ...], transient: bool
) -> tuple[Residues, ...]:
    """Residues of every run at its own poles (M,) of ``poles``, fitted with stand-ins for modes outside the band."""
    beyond = _beyond(spectra.frequency_hz)
    fits = []
    for run, own in zip(spectra.runs, poles, strict=True):
        every = np.concatenate([own, beyond])
        fit = fit_residues(run, spectra.frequency_hz, every, variance=_variance(run), transient=transient)
        fits.append(replace(fit, poles=own, residues=fit.residues[:, : own.size], std=fit.std[:, : own.size]))
    return tuple(fits)


def _beyond(frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Poles just outside the lines that stand in for the modes there, whose tails polynomials follow badly."""
    places = 2 * np.pi * np.array([frequency_hz[0] / _NEXT, *(frequency_hz[-1] * _NEXT ** np.array([1, 2]))])
    return np.asarray(places * (-_BROAD + 1j * np.sqrt(1 - _BROAD**2)))


def _variance(run: RunSpectra) -> NDArray[np.float64]:
    """Variance (R, K) of the lines, never below a small part of the response: a few poles are no perfect model."""
    power = (np.abs(run.accelerance) ** 2).mean(axis=1, keepdims=True)
    return np.asarray(np.maximum(run.variance, _MODEL_ERROR**2 * power))


def worth(fits: tuple[Residues, ...], lines: int) -> NDArray[np.float64]:
    """What every pole (M,) is worth: its squared residues over their variance, less what noise would give them.

    The sum is twice the log likelihood that a pole adds to a linear fit (Wald);
    the rest is Schwarz's criterion, Annals of Statistics 6(2), 1978. Positive: worth its unknowns.
    """
    rows = sum(f.residues.shape[0] for f in fits)
    gain = sum((2 * np.abs(f.residues) ** 2 / np.maximum(f.std, np.finfo(float).tiny) ** 2).sum(axis=0) for f in fits)
    return np.asarray(gain - (2 + 2 * rows) * np.log(2 * rows * lines))


def _needed(found: Patterns, spectra: CampaignSpectra, options: ClaimOptions) -> tuple[Patterns, tuple[Residues, ...]]:
    """The patterns left when those that are not worth their unknowns have gone, the worst first; and their residues."""
    lines, (each, besides) = spectra.frequency_hz.size, _UNKNOWNS
    while found.patterns and 2 * lines < _EQUATIONS_PER_UNKNOWN * (each * len(found.patterns) + besides):
        found = found.dropped(min(found.patterns, key=lambda p: p.seen), "too few lines for so many modes")
    # The transient costs as many columns again; most poles that have to go, go without it.
    transient = False
    while found.patterns:
        fits = residues_of_runs(spectra, _poles_by_run(found, len(spectra.runs), options.own_poles), transient)
        useless = _useless(found.patterns, worth(fits, lines))
        if not useless and (transient or options.estimator):
            return found, fits
        transient = transient or not useless
        for pattern in useless:
            found = found.dropped(pattern, "the responses do without it")
    return found, ()


def _useless(patterns: tuple[Pattern, ...], gain: NDArray[np.float64]) -> list[Pattern]:
    """The patterns that are not worth their unknowns, of close ones the worst only: together they may be needed."""
    out: list[Pattern] = []
    for i in np.argsort(gain, kind="stable"):
        pole = patterns[i].pole_rad_s
        reach = [_CLOSE * max(-pole.real, -p.pole_rad_s.real) for p in out]
        if gain[i] <= 0 and all(abs(pole - p.pole_rad_s) > r for p, r in zip(out, reach, strict=True)):
            out.append(patterns[i])
    return out


def _poles_by_run(found: Patterns, runs: int, own_poles: bool) -> tuple[NDArray[np.complex128], ...]:
    table = np.tile(np.array([p.pole_rad_s for p in found.patterns]), (runs, 1))
    if not own_poles or runs == 1:
        return tuple(table)
    for column, pattern in enumerate(found.patterns):
        total, weight = np.zeros(runs, complex), np.zeros(runs)
        for source, member in zip(found.sources, pattern.members, strict=True):
            if member >= 0:
                share = 1 / np.maximum(source.frequency_std_hz[member], 1e-12) ** 2
                total[source.run] += share * source.poles[member]
                weight[source.run] += share
        own = weight > 0
        table[own, column] = total[own] / weight[own]
    return tuple(table)


def _flags(pattern: Pattern, sources: int) -> tuple[str, ...]:
    flags = [f"emac={pattern.quality:.2f}"] if np.isfinite(pattern.quality) else []
    if sources > 1:
        flags.append(f"seen_in={pattern.seen}/{sources}")
    if pattern.pole.damping_ratio_std > DOUBTFUL_DEVIATION * pattern.pole.damping_ratio:
        # Poles that a model of fixed order has to spare follow noise, and what it makes of broad modes.
        flags.append("doubtful: damping poorly known")
    return (*flags, *(f for f in pattern.pole.flags if f.startswith("run_scatter_hz") or f == "runs_disagree"))
