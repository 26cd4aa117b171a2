"""Poles of every run around poles common to all: a run that knows a mode well has its own, the others follow.

Roving sensors shift the poles by a little from run to run. Poles common to all
runs would leave misfits that look like further modes; poles free in every run
would not be known where a run's sensors hardly see the mode. Between the two
stands the random-effects model of Laird and Ware, Random-effects models for
longitudinal data, Biometrics 38(4), 1982, here with a given spread.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.pole_fit import PoleProblem, PoleState, evaluate, fit_poles, limited_step

_FREQUENCY_SPREAD = 2e-3
_DAMPING_SPREAD = 0.1
_STEPS = 12
_DAMPING, _LEAST_DAMPING, _MOST_DAMPING = 1e-3, 1e-9, 1e8  # of Levenberg and Marquardt
_SETTLED = 1e-3  # fall of a run's error that is worth no further step


@dataclass(frozen=True, slots=True, eq=False)
class RunStates:
    """The common poles (N,) and the state of every run at its own; ``cost`` includes the pull to the common ones."""

    poles: NDArray[np.complex128]
    states: tuple[PoleState, ...]
    cost: float

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Covariance (2 N, 2 N) of the common poles, (rad/s)^2, real parts first."""
        if len(self.states) == 1:
            return self.states[0].covariance()
        information = _common_information(self.states, _pull(self.poles))
        size = np.sqrt(np.maximum(np.diag(information), 1e-300))
        return np.asarray(np.linalg.pinv(information / size[:, None] / size, hermitian=True) / size[:, None] / size)

    @property
    def pooled_covariance(self) -> NDArray[np.float64]:
        """Covariance (2 N, 2 N) of poles that are the same in all runs: what noise alone leaves unknown."""
        information = np.asarray(sum(s.information for s in self.states))
        size = np.sqrt(np.where(np.diag(information) > 0, np.diag(information), 1.0))
        return np.asarray(np.linalg.pinv(information / size[:, None] / size, hermitian=True) / size[:, None] / size)

    @property
    def gain(self) -> NDArray[np.float64]:
        """Rise of the cost (N,) if a mode is left out of every response of every run."""
        return np.asarray(sum(s.gain for s in self.states))


def fit_runs(problems: tuple[PoleProblem, ...], start: NDArray[np.complex128], steps: int = _STEPS) -> RunStates:
    """Poles of all runs, one problem each, from common ``start`` poles (N,) rad/s."""
    if len(problems) == 1:
        state = fit_poles(problems[0], start, steps)
        return RunStates(state.poles, (state,), state.cost)
    return refined_runs(problems, start, np.tile(start, (len(problems), 1)), steps)


def refined_runs(
    problems: tuple[PoleProblem, ...],
    common: NDArray[np.complex128],
    own: NDArray[np.complex128],
    steps: int = _STEPS,
) -> RunStates:
    """The same from common poles (N,) and poles (runs, N) of every run.

    Each step solves for the common poles first, with every run's own ones taken as what they would become, and then
    for the runs, each damped as Levenberg and Marquardt do it; a run whose error does not fall stays where it is.
    """
    if len(problems) == 1:
        return fit_runs(problems, own[0], steps)
    states = [evaluate(p, o) for p, o in zip(problems, own, strict=True)]
    damping = np.full(len(problems), _DAMPING)
    for _ in range(steps if common.size else 0):
        pull = _pull(common)
        best, targets = _solved(states, common, pull, damping)
        moved = common + limited_step(common, best - common)
        before = np.array([s.cost + _penalty(s.poles, common, pull) for s in states])
        trials = [evaluate(p, _moved(s, t)) for p, s, t in zip(problems, states, targets, strict=True)]
        stays = np.array([s.cost + _penalty(s.poles, moved, pull) for s in states])
        after = np.array([t.cost + _penalty(t.poles, moved, pull) for t in trials])
        better = after <= stays
        fall = float((before - np.where(better, after, stays)).sum())
        damping = np.where(better & (fall >= 0), np.maximum(damping / 10, _LEAST_DAMPING), damping * 10)
        if fall >= 0:
            common = moved
            states = [t if chosen else s for s, t, chosen in zip(states, trials, better, strict=True)]
        if (better.all() and abs(fall) < _SETTLED * len(problems)) or damping.min() > _MOST_DAMPING:
            break
    cost = sum(s.cost + _penalty(s.poles, common, _pull(common)) for s in states)
    return RunStates(common, tuple(states), float(cost))


def _pull(common: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Precision (2 N,) of a run's poles about the common ones, real parts then imaginary parts."""
    spread = np.concatenate([_DAMPING_SPREAD * np.abs(common.real), _FREQUENCY_SPREAD * np.abs(common)])
    return np.asarray(1 / spread**2)


def _split(poles: NDArray[np.complex128]) -> NDArray[np.float64]:
    return np.concatenate([poles.real, poles.imag])


def _joined(parts: NDArray[np.float64]) -> NDArray[np.complex128]:
    half = parts.size // 2
    return np.asarray(parts[:half] + 1j * parts[half:])


def _penalty(own: NDArray[np.complex128], common: NDArray[np.complex128], pull: NDArray[np.float64]) -> float:
    return float(pull @ _split(own - common) ** 2)


def _common_information(states: tuple[PoleState, ...], pull: NDArray[np.float64]) -> NDArray[np.float64]:
    """What the runs together tell of the common poles, (2 N, 2 N), their own ones being unknown."""
    total = np.zeros((pull.size, pull.size))
    for state in states:
        inverse = _inverse(state.information + np.diag(pull))
        total += np.diag(pull) - pull[:, None] * inverse * pull
    return total


def _solved(
    states: list[PoleState], common: NDArray[np.complex128], pull: NDArray[np.float64], damping: NDArray[np.float64]
) -> tuple[NDArray[np.complex128], list[NDArray[np.float64]]]:
    """The best common poles (N,) of the quadratic model with ``damping`` (runs,), and each run's poles (2 N,) there."""
    left, right = 1e-9 * np.diag(pull), 1e-9 * pull * _split(common)
    inverses = []
    for state, damped in zip(states, damping, strict=True):
        inverse = _inverse(state.information + np.diag(pull + damped * np.diag(state.information)))
        here = _split(state.poles)
        left += np.diag(pull) - pull[:, None] * inverse * pull
        right += pull * (here + inverse @ (state.gradient - pull * here))
        inverses.append(inverse)
    size = np.sqrt(np.diag(left))
    best = np.linalg.solve(left / size[:, None] / size, right / size) / size
    targets = [
        _split(s.poles) + inverse @ (s.gradient + pull * (best - _split(s.poles)))
        for s, inverse in zip(states, inverses, strict=True)
    ]
    return _joined(np.asarray(best)), targets


def _inverse(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    size = np.sqrt(np.diag(matrix))
    return np.asarray(np.linalg.inv(matrix / size[:, None] / size) / size[:, None] / size)


def _moved(state: PoleState, target: NDArray[np.float64]) -> NDArray[np.complex128]:
    return np.asarray(state.poles + limited_step(state.poles, _joined(target) - state.poles))
