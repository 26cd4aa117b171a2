"""The last stage of the likelihood methods: noise, verdicts and poles of every run until nothing changes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.common_modes import RunModes
from vgvt_identifiers.double_poles import without_doubles
from vgvt_identifiers.drifting_poles import RunStates, fit_runs, refined_runs
from vgvt_identifiers.likelihood_fit import noise_after, weighted_problem
from vgvt_identifiers.pole_covariance import parameter_covariance, pole_covariance, pole_deviations
from vgvt_identifiers.pole_fit import PoleProblem, PoleState, evaluate, fit_poles
from vgvt_identifiers.pole_search import least_fall, search_poles
from vgvt_identifiers.pole_verdict import Verdict, VerdictRules, judge_poles
from vgvt_identifiers.run_noise import RunNoise, first_noise
from vgvt_identifiers.spectra import CampaignSpectra, RunSpectra

_ROUNDS = 4
_LINES_PER_POLE = 12
_STEPS = 6
_LAST_STEPS = 30
_LOWER_TERMS, _FEWEST_LOWER_TERMS = 4, 2  # powers of 1/s that stand for the modes below the band
_FALSE_TERMS = 1e-3  # chance that noise alone asks for the larger number
_FALSE_RING = 0.1  # chance that noise alone gives a pole a transient
_ALIKE = 0.2  # rms difference in log colour below which responses share their weights
_KNOWN = 0.5  # a run knows a pole by itself when its standard deviation is less than this part of the damping


@dataclass(frozen=True, slots=True, eq=False)
class CampaignFit:
    """The fit of all runs: problems, states, noise, and the poles that were left out on the way with their reason."""

    problems: tuple[PoleProblem, ...]
    states: RunStates
    noise: tuple[RunNoise, ...]
    verdicts: tuple[Verdict, ...]
    dropped: tuple[tuple[complex, str], ...]


def searched_fit(
    spectra: CampaignSpectra,
    start: NDArray[np.complex128],
    band_hz: tuple[float, float],
    rules: VerdictRules,
    most: int = 60,
) -> CampaignFit:
    """The whole way from poles (N,) rad/s that are roughly known, which may be none, to a settled fit of all runs."""
    problems = tuple(
        _problem(spectra.frequency_hz, r, first_noise(r.variance, r.force, r.accelerance), True) for r in spectra.runs
    )
    room = min(most, spectra.frequency_hz.size // _LINES_PER_POLE)
    found = search_poles(problems, start[:room], false_alarm=rules.false_alarm, most=room)
    return settled_fit(spectra, found, band_hz, rules)


def settled_fit(
    spectra: CampaignSpectra, states: RunStates, band_hz: tuple[float, float], rules: VerdictRules
) -> CampaignFit:
    """The fit from the states of a search, with the noise that it leaves, without poles that then count for nothing."""
    dropped: list[tuple[complex, str]] = []
    lower_terms = _LOWER_TERMS
    forces = tuple(r.force for r in spectra.runs)
    for last in (*[False] * (_ROUNDS - 1), True):
        noise = tuple(noise_after(s, (f,))[0] for s, f in zip(states.states, forces, strict=True))
        problems = tuple(
            _problem(spectra.frequency_hz, run, level, _alike(level), lower_terms)
            for run, level in zip(spectra.runs, noise, strict=True)
        )
        states = refined_runs(problems, states.poles, np.array([s.poles for s in states.states]), _STEPS)
        if lower_terms > _FEWEST_LOWER_TERMS and not _asks_for_terms(problems, states):
            lower_terms = _FEWEST_LOWER_TERMS
            problems = tuple(replace(p, lower_terms=lower_terms) for p in problems)
        states, doubles = without_doubles(problems, states, least_fall(problems, rules.false_alarm))
        dropped += doubles
        verdicts = judge_poles(problems, states, band_hz, rules)
        gone = [i for i, v in enumerate(verdicts) if not v.kept]
        if last or not gone:
            break
        dropped += [(complex(states.poles[i]), verdicts[i].reason) for i in gone]
        states = without(states, problems, gone)
    problems = tuple(_with_rings(p, s) for p, s in zip(problems, states.states, strict=True))
    states = refined_runs(problems, states.poles, np.array([s.poles for s in states.states]), _LAST_STEPS)
    return CampaignFit(problems, states, noise, verdicts, tuple(dropped))


def _problem(
    frequency_hz: NDArray[np.float64], run: RunSpectra, noise: RunNoise, shared: bool, lower_terms: int = _LOWER_TERMS
) -> PoleProblem:
    return replace(weighted_problem(frequency_hz, (run,), (noise,), shared=shared), lower_terms=lower_terms)


def _asks_for_terms(problems: tuple[PoleProblem, ...], states: RunStates) -> bool:
    """True where the modes below the band, rigid-body motions mostly, need more than the fewest terms to stand for."""
    from scipy.special import chdtri

    fewer = tuple(replace(p, lower_terms=_FEWEST_LOWER_TERMS) for p in problems)
    rise = sum(evaluate(p, s.poles).cost - s.cost for p, s in zip(fewer, states.states, strict=True))
    rows = sum(r.values.shape[0] for p in problems for r in p.rows)
    return rise > float(chdtri(rows * (_LOWER_TERMS - _FEWEST_LOWER_TERMS), _FALSE_TERMS))


def _with_rings(problem: PoleProblem, state: PoleState) -> PoleProblem:
    """The problem of one run with transients for those poles alone that ring at its ends, as far as noise lets it show.

    Transients that are not there would only take away from what is known of the poles. Of transients that are alike
    each may be spared, but not all: where they are missed together, the weakest goes, and the others are asked again.
    """
    from scipy.special import chdtri

    rows = problem.rows[0]
    unknowns = 2 * rows.values.shape[0]
    needed, ringing = float(chdtri(unknowns, _FALSE_RING)), np.ones(state.poles.size, bool)
    while (silent := ringing & (state.ring_gain[0] <= needed)).any():
        fewer, trial = _ringing(problem, ringing & ~silent, state.poles)
        if silent.sum() > 1 and trial.cost - state.cost > float(chdtri(unknowns * int(silent.sum()), _FALSE_RING)):
            ringing[np.flatnonzero(silent)[np.argmin(state.ring_gain[0][silent])]] = False
            fewer, trial = _ringing(problem, ringing, state.poles)
        else:
            ringing = ringing & ~silent
        problem, state = fewer, trial
    return problem


def _ringing(
    problem: PoleProblem, ringing: NDArray[np.bool_], poles: NDArray[np.complex128]
) -> tuple[PoleProblem, PoleState]:
    """The problem with these transients (N,), and its state at poles (N,)."""
    changed = replace(problem, rows=(replace(problem.rows[0], ringing=ringing),))
    return changed, evaluate(changed, poles)


def without(states: RunStates, problems: tuple[PoleProblem, ...], gone: list[int]) -> RunStates:
    """The fit again with the poles at ``gone`` left out."""
    own = np.array([np.delete(s.poles, gone) for s in states.states])
    return refined_runs(problems, np.delete(states.poles, gone), own, _STEPS)


def _alike(noise: RunNoise) -> bool:
    """True where the noise of all responses has the same colour, so that one row of weights serves them."""
    if noise.response.shape[0] == 1:
        return True
    colour = np.log(noise.response)
    colour = colour - colour.mean(axis=1, keepdims=True)
    return bool(np.sqrt(((colour - colour.mean(axis=0)) ** 2).mean()) < _ALIKE)


def poles_of_runs(spectra: CampaignSpectra, fit: CampaignFit) -> tuple[RunModes, ...]:
    """Every run with all poles (N,) in the order of the common ones: its own where it knows them by itself.

    Others keep what the runs together say, with infinite standard deviations; a pole that
    no run knows by itself has the deviation of the common pole, shared out so that their average states it.
    """
    runs = []
    for run, problem, state, noise in zip(spectra.runs, fit.problems, fit.states.states, fit.noise, strict=True):
        free = _known_alone(problem, state.poles, noise, run.force)
        if len(spectra.runs) > 1:
            # What this run cannot tell by itself stays where all runs together put it.
            poles = np.where(free, state.poles, fit.states.poles)
            state = fit_poles(problem, poles, _LAST_STEPS, free)
        covariance = pole_covariance(problem, state, (noise,), (run.force,), free)
        std_hz, std_ratio = pole_deviations(state.poles, covariance)
        runs.append(
            RunModes(
                run.run,
                run.reference,
                run.responses,
                state.poles,
                state.residues[0].T,
                np.where(free, std_hz, np.inf),
                np.where(free, std_ratio, np.inf),
                parameter_covariance(state.poles, covariance),
            )
        )
    return _with_shared_deviations(tuple(runs), fit.states)


def _known_alone(
    problem: PoleProblem, poles: NDArray[np.complex128], noise: RunNoise, force: NDArray[np.complex128]
) -> NDArray[np.bool_]:
    """Poles (N,) that one run knows well enough for an estimate of its own, found by leaving out the worst."""
    state = fit_runs((problem,), poles, 0).states[0]
    free = np.ones(poles.size, bool)
    while free.any():
        variance = np.diag(state.covariance(free))
        larger = np.maximum(variance[: poles.size], variance[poles.size :])
        worst = np.where(larger > 0, np.sqrt(np.abs(larger)), np.inf) / np.abs(poles.real)
        worst[~free] = 0.0
        if worst.max() <= _KNOWN:
            break
        free[int(np.argmax(worst))] = False
    return free


def _with_shared_deviations(runs: tuple[RunModes, ...], states: RunStates) -> tuple[RunModes, ...]:
    unknown = np.array([np.isinf(r.frequency_std_hz) for r in runs]).all(axis=0)
    if not unknown.any():
        return runs
    std_hz, std_ratio = pole_deviations(states.poles, states.covariance)
    scale = np.sqrt(len(runs))
    return tuple(
        replace(
            r,
            frequency_std_hz=np.where(unknown, std_hz * scale, r.frequency_std_hz),
            damping_ratio_std=np.where(unknown, std_ratio * scale, r.damping_ratio_std),
        )
        for r in runs
    )
