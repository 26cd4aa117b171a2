"""The way down of a model with a thing that has no name: by Levenberg and Marquardt, its law and all scores free."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.evidence.smooth_law import TERMS, SmoothLaw
from vgvt.reconcile.fitting.descent import (
    TRUE,
    after_a_refusal,
    after_a_step,
    arrived,
    longest_step,
    misled,
    moved,
    sloped,
    solved,
)
from vgvt.reconcile.fitting.misfit import data_misfit, jacobian, standardised
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.surrogate import Anchor, anchor

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_REJECTIONS = 9
_FIRST_DAMPING = 1e-2
# As many times what a free step promised to take off may yet be taken off: by the next ones.
_HOPELESS = 2.0
# Peaks that are apart promise little at first.
_FIRST_LOOK = 2
# What holds a law's values, in the deviations that each of them makes: nothing, but for those that change nothing.
_LOOSE = 1e-9


def walked(state: State, most: int, worthless: float = np.inf) -> tuple[State, bool]:
    """Where at most so many steps lead, with slopes that serve until they mislead, and whether it was given up.

    That is where a free step promises less than half of what it lacks to a cost that is not ``worthless``.
    """
    damping = _FIRST_DAMPING
    for step in range(most):
        slopes = Slopes.of(state)
        reached, damping = _lower(state, slopes, damping)
        if reached is None:
            break
        state = reached
        if step >= _FIRST_LOOK and state.cost - worthless > _HOPELESS * slopes.promised:
            return state, True
        if arrived(0 if state.coarse else state.misfit.size, slopes.promised, state.cost):
            break
    return state, False


def _lower(state: State, slopes: Slopes, damping: float) -> tuple[State | None, float]:
    """The state after the first step that takes something off the cost, None where none does, and the next damping."""
    # What hangs, and does not where a slope is taken, has no way on from there.
    with suppress(NoStructureError):
        for _ in range(_REJECTIONS):
            move = slopes.move(damping)
            reached = state.moved(move, slopes.unit)
            if reached is not None and reached.cost < state.cost:
                kept = (state.cost - reached.cost) / slopes.promised_by(move)
                return reached.sloped(state.here, anew=kept < TRUE), after_a_step(damping, kept)
            if misled(state.here, state.u, state.e):
                state = state.sloped(state.here, anew=True)
                slopes = Slopes.of(state)
            else:
                damping = after_a_refusal(damping)
    return None, damping


def _alike(one: Anchor, other: Anchor) -> bool:
    """Whether runs share structures alike at two anchors: places are rows over the coordinates of each."""
    return [g.channels.tolist() for g in one.assembled] == [g.channels.tolist() for g in other.assembled]


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """Scores u and e, the law's ``sizes`` (TERMS,), A/F (C, L) there, and the cost.

    ``here`` is the structure without the law, to assemble the next from.
    """

    here: Anchor
    acting: SmoothLaw
    terms: Array
    u: Array
    e: Array
    sizes: ComplexArray
    predicted: ComplexArray
    misfit: Array
    cost: float
    sigma: Array | None = None

    @classmethod
    def at(
        cls, here: Anchor, acting: SmoothLaw, terms: Array, u: Array, e: Array, sizes: ComplexArray,
        sigma: Array | None = None,
    ) -> State:  # fmt: skip
        """What is foretold at scores and sizes; NoStructureError where the response is not finite."""
        predicted = acting.on(here, terms @ sizes).predict(u, e)
        misfit = data_misfit(here.problem, predicted, sigma)
        cost = float(misfit @ misfit + u @ u + e @ e)
        return cls(here, acting, terms, u, e, sizes, predicted, misfit, cost, sigma)

    def judged(self, sigma: Array | None) -> State:
        """The same judged by ``sigma`` (fitted channels, L); by the data's own where there is none."""
        misfit = data_misfit(self.here.problem, self.predicted, sigma)
        cost = float(misfit @ misfit + self.u @ self.u + self.e @ self.e)
        return replace(self, misfit=misfit, cost=cost, sigma=sigma)

    @property
    def coarse(self) -> bool:
        """Whether it is judged by anything but the data's own deviations."""
        return self.sigma is not None

    def moved(self, move: Array, unit: Array) -> State | None:
        """The state after a step (scores and 2 TERMS,), a law's values by ``unit``; None where there is no aircraft.

        It has no slopes in the unknowns.
        """
        problem, hypotheses = self.here.problem, self.here.hypotheses
        count = self.u.size + self.e.size
        u, e = moved(problem, hypotheses, self.u, self.e, move[:count])
        change = move[count:] * unit
        return self._elsewhere(u, e, self.sizes + change[:TERMS] + 1j * change[TERMS:])

    def misfit_at(self, scores: Array) -> Array | None:
        """The misfit (2 N,) at other scores (scores,), the law as it is; None where there is no aircraft."""
        u, e = np.split(scores, [self.u.size])
        reached = self._elsewhere(u, e, self.sizes)
        return None if reached is None else reached.misfit

    def _elsewhere(self, u: Array, e: Array, sizes: ComplexArray) -> State | None:
        try:
            here = anchor(self.here.problem, u, self.here.hypotheses, e, slopes=False, structures=self.here.structures)
            return State.at(here, self.acting, self.terms, u, e, sizes, self.sigma) if _alike(self.here, here) else None
        except NoStructureError:
            return None

    def sloped(self, before: Anchor, *, anew: bool = False) -> State:
        """The same with slopes from where those of ``before`` are; ``anew``, where these mislead, with its own."""
        anew = anew and misled(before, self.u, self.e)
        return replace(self, here=sloped(before, self.here, self.u, self.e, anew=anew))

    def at_the_end(self) -> State:
        """The same with slopes that serve there."""
        return self.sloped(self.here, anew=True)


@dataclass(frozen=True, slots=True, eq=False)
class Slopes:
    """Gradient (n,) and half the curvature (n, n) of half the cost, in scores and in the law's values by ``unit``.

    A law's values are in units of what changes the misfit by one (2 TERMS,); ``tangent`` (2 N, scores) are the misfit's
    derivatives in the scores. No score moves by more than ``longest``.
    """

    gradient: Array
    normal: Array
    unit: Array
    tangent: Array
    longest: float

    @classmethod
    def of(cls, state: State) -> Slopes:
        """Slopes of a state."""
        problem = state.here.problem
        law = state.terms @ state.sizes
        tangent = jacobian(state.acting.on(state.here, law), state.u, state.e, state.predicted, state.sigma)
        change = state.acting.by_law(state.here, law, state.u, state.e)[problem.split.train]
        by_law = standardised(problem, change[:, :, None] * state.terms, state.sigma)
        both = np.concatenate([by_law, 1j * by_law], axis=2).reshape(-1, 2 * TERMS)
        columns = np.sqrt(2) * np.concatenate([both.real, both.imag])
        unit = 1 / np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny)
        whole = np.hstack([tangent, columns * unit])
        scores = np.concatenate([state.u, state.e])
        held = np.concatenate([np.ones(scores.size), np.full(2 * TERMS, _LOOSE)])
        gradient = whole.T @ state.misfit + np.concatenate([scores, np.zeros(2 * TERMS)])
        return cls(gradient, whole.T @ whole + np.diag(held), unit, tangent, longest_step(scores))

    @property
    def promised(self) -> float:
        """What a free step takes off the cost where slopes stay as they are."""
        return float(self.gradient @ solved(self.normal, self.gradient))

    @property
    def log_det(self) -> float:
        """Logarithm of the determinant of the scores' precision, the law's values held."""
        return float(np.linalg.slogdet(self.normal[: -2 * TERMS, : -2 * TERMS])[1])

    @property
    def covariance(self) -> Array:
        """Of the scores (scores, scores), the law's values free."""
        count = self.gradient.size - 2 * TERMS
        return solved(self.normal, np.eye(self.gradient.size))[:count, :count]

    @property
    def of_law(self) -> Array:
        """The precision (2 TERMS, 2 TERMS) of the law's values, all scores left open."""
        scores, beside = self.normal[: -2 * TERMS, : -2 * TERMS], self.normal[: -2 * TERMS, -2 * TERMS :]
        alone = self.normal[-2 * TERMS :, -2 * TERMS :] - beside.T @ solved(scores, beside)
        return np.asarray(alone * np.outer(1 / self.unit, 1 / self.unit))

    def move(self, damping: float) -> Array:
        """A damped Gauss-Newton step (n,)."""
        move = -solved(self.normal + damping * np.eye(self.gradient.size), self.gradient)
        farthest = float(np.abs(move[: -2 * TERMS]).max(initial=0.0))
        return move * min(1.0, self.longest / max(farthest, 1e-300))

    def promised_by(self, move: Array) -> float:
        """What a step (n,) takes off the cost where slopes stay as they are."""
        return -float(2 * self.gradient @ move + move @ self.normal @ move)
