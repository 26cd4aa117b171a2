"""Looks for poles that a fit lacks, one at a time, by what they would explain of its errors.

A matched filter over all lines and several widths names places; each is tried
in a full fit, and the pole stays when the error falls by more than noise
makes it fall anywhere (orthogonal matching pursuit on the likelihood: Pati,
Rezaiifar and Krishnaprasad, Asilomar, 1993). No order needs to be chosen.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.drifting_poles import RunStates, fit_runs, refined_runs
from vgvt_identifiers.pole_fit import PoleProblem

_WIDTH_STEP = 2.5
_LARGEST_RATIO = 0.12
_TRIALS = 3
_FIRST_STEPS = 2
_TRIAL_STEPS = 4
_PROMISING = 0.3  # of the fall that is needed, after the first steps
_REACH = 40
_APART = 10.0  # widths between places that are tried together
_SURE = 30.0
_OUTSTANDING = 0.01  # of the best promise


@dataclass(frozen=True, slots=True)
class Place:
    """A pole that may be missing: where, and about how much of the error it would explain."""

    pole: complex
    promise: float


def search_poles(
    problems: tuple[PoleProblem, ...],
    start: NDArray[np.complex128],
    *,
    false_alarm: float = 1e-3,
    most: int = 60,
) -> RunStates:
    """The poles ``start`` (N,) rad/s, which may be none, and all further ones that the runs give evidence of.

    ``false_alarm`` is the chance that noise alone brings one pole in somewhere.
    """
    states = fit_runs(problems, start) if start.size else refined_runs_of_nothing(problems)
    needed, alone = least_fall(problems, false_alarm), least_fall(problems, false_alarm, transient=False)
    while states.poles.size < most:
        places = [p for p in missing_places(problems, states) if p.promise > needed / 20]
        better = _several(problems, states, places, needed)
        for place in places[:_TRIALS] if better is None else ():
            trial = _tried(problems, states, (place.pole,), needed)
            if trial is not None and states.cost - trial.cost > needed and trial.gain[-1] > alone:
                better = trial
                break
        if better is None:
            return states
        states = better
    return states


def _several(
    problems: tuple[PoleProblem, ...], states: RunStates, places: list[Place], needed: float
) -> RunStates | None:
    """The fit with the outstanding places at once, where there are several far enough apart; None where not."""
    chosen: list[Place] = []
    for place in places:
        apart = all(abs(place.pole - p.pole) > _APART * max(-place.pole.real, -p.pole.real) for p in chosen)
        if apart and place.promise > max(_SURE * needed, _OUTSTANDING * places[0].promise):
            chosen.append(place)
    if len(chosen) < 2:
        return None
    trial = _tried(problems, states, tuple(p.pole for p in chosen), needed)
    if trial is None or states.cost - trial.cost < needed * len(chosen):
        return None
    return trial if (trial.gain[states.poles.size :] > needed).all() else None


def refined_runs_of_nothing(problems: tuple[PoleProblem, ...]) -> RunStates:
    """The fit without any pole: rest and transients alone."""
    return refined_runs(problems, np.empty(0, complex), np.empty((len(problems), 0), complex), 0)


def least_fall(problems: tuple[PoleProblem, ...], false_alarm: float, *, transient: bool = True) -> float:
    """Fall of the cost that noise alone reaches somewhere in the band with the chance ``false_alarm``.

    It is that of a pole with its residues, and with what it leaves at the ends of records if ``transient``.
    """
    from scipy.special import chdtri

    rows = sum(r.values.shape[0] for p in problems for r in p.rows)
    lines = problems[0].frequency_hz.size
    unknowns = (4 * rows if transient else 2 * rows) + 2 * len(problems)
    return float(chdtri(unknowns, false_alarm / lines))


def missing_places(problems: tuple[PoleProblem, ...], states: RunStates) -> list[Place]:
    """Maxima of the matched filter over lines and widths, the most promising first."""
    frequency = problems[0].frequency_hz
    omega = 2 * np.pi * frequency
    step = float(omega[1] - omega[0])
    widths = [0.5 * step]
    while widths[-1] < _LARGEST_RATIO * omega[-1]:
        widths.append(widths[-1] * _WIDTH_STEP)
    power = _matched(problems, states, np.array(widths) / step)
    allowed = np.array(widths)[:, None] <= _LARGEST_RATIO * omega
    power = np.where(allowed, power, 0.0)
    best = power.max(axis=0)
    inner = np.r_[best[1:-1] >= np.maximum(best[:-2], best[2:])]
    tops = 1 + np.flatnonzero(inner)
    tops = np.unique(np.r_[tops, 0, best.size - 1])
    tops = tops[np.argsort(-best[tops], kind="stable")]
    return [Place(complex(-widths[int(np.argmax(power[:, t]))], omega[t]), float(best[t])) for t in tops[: 4 * _TRIALS]]


def _matched(
    problems: tuple[PoleProblem, ...], states: RunStates, widths_lines: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Error power (W, K) that a pole of each width (W,) in lines at every line would explain, were it alone."""
    from scipy.fft import fft, ifft, next_fast_len

    lines = problems[0].frequency_hz.size
    reach = min(int(np.ceil(_REACH * max(float(widths_lines.max()), 0.5))), lines - 1)
    offset = np.arange(-reach, reach + 1)
    length = next_fast_len(lines + 2 * reach)
    # Correlation with 1/(i (w - w0) + width): the filter runs against the offset.
    near = [np.abs(offset) <= np.ceil(_REACH * max(width, 0.5)) for width in widths_lines]
    templates = [inside / (1j * -offset + width) for inside, width in zip(near, widths_lines, strict=True)]
    filters = [(fft(t.conj(), length), fft(np.abs(t) ** 2, length)) for t in templates]
    total = np.zeros((widths_lines.size, lines))
    for problem, state in zip(problems, states.states, strict=True):
        for rows, errors in zip(problem.rows, state.errors, strict=True):
            # Each row by its own scale: one row of weights then has one spectrum.
            spectra = fft(errors * rows.row_scale[:, None] * rows.weight**2, length)
            weights = fft(rows.weight**2, length)
            for width, (matched, squared) in enumerate(filters):
                found = ifft(spectra * matched)[:, reach : reach + lines]
                size = ifft(weights * squared)[:, reach : reach + lines].real
                size = np.maximum(size, 1e-12 * size.max())
                total[width] += ((found.real**2 + found.imag**2) / size).sum(axis=0)
    return total


def _tried(
    problems: tuple[PoleProblem, ...], states: RunStates, poles: tuple[complex, ...], needed: float
) -> RunStates | None:
    """The fit with some more poles, None if two fell together or the first steps gain too little."""
    common = np.append(states.poles, poles)
    own = np.array([np.append(s.poles, poles) for s in states.states])
    trial = refined_runs(problems, common, own, _FIRST_STEPS)
    if states.cost - trial.cost < _PROMISING * needed:
        return None
    trial = refined_runs(problems, trial.poles, np.array([s.poles for s in trial.states]), _TRIAL_STEPS)
    gap = np.abs(trial.poles[:, None] - trial.poles) + np.diag(np.full(trial.poles.size, np.inf))
    return trial if (gap.min(axis=1) > 1e-3 * np.abs(trial.poles.real)).all() else None
