"""Fit scores of the scenario's unknowns, and of hypotheses, by Levenberg and Marquardt with continuation.

A coarse relative error first (60 %, 15 %, 0) lets misplaced peaks attract each other. The structure is assembled
anew after every step, so that the linearisation never carries further than one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from vgvt.reconcile.carried import Structures
from vgvt.reconcile.grouping import NoStructureError
from vgvt.reconcile.hypothesis import Hypothesis
from vgvt.reconcile.local_slopes import origin_near
from vgvt.reconcile.misfit import coarse_sigma, data_misfit, jacobian
from vgvt.reconcile.problem import Problem
from vgvt.reconcile.rough_start import rough_start
from vgvt.reconcile.surrogate import Anchor, anchor

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

STAGES = ((0.6, 4), (0.15, 4), (0.0, 60))
"""Coarseness and most iterations of each stage of the continuation: a stage ends where nothing is gained."""
NEAR = ((0.0, 12),)
"""For a start that is near already."""
FAR = ((0.15, 4), (0.05, 3), (0.0, 20))
"""For a start from a model that misses much."""
TO_THE_END = ((0.0, 60),)
"""For a fit that was stopped on its way down."""
# Standard deviations at once: from where scores are tens of them away, a share of that.
_LONGEST_STEP, _LONGEST_SHARE = 1.5, 0.2
_ENOUGH = 1e-3
_REJECTIONS = 5
# Relative to the cost: what a step gains where no step leads anywhere any more.
_NOTHING = 1e-4
# Standard deviations that a tolerance reaches.
_WITHIN = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A fitted model: scores ``u`` (and ``e`` of its hypotheses), prediction (C, L) and the Laplace posterior.

    ``tangent`` (2 N, scores) are derivatives of the data misfit; ``covariance`` (scores, scores) that of the
    scores; ``chi2`` the data's square sum over ``points`` real numbers; ``evidence_nats`` Laplace's log evidence.
    ``sigma`` (fitted channels, L) is what it was judged by where that is not the data's.
    """

    problem: Problem
    hypotheses: tuple[Hypothesis, ...]
    u: Array
    e: Array
    predicted: ComplexArray
    tangent: Array
    covariance: Array
    chi2: float
    points: int
    evidence_nats: float
    converged: bool
    sigma: Array | None = None

    @property
    def chi2_per_dof(self) -> float:
        """χ² per fitted real number."""
        return self.chi2 / self.points

    @property
    def foretold(self) -> ComplexArray:
        """The prediction (C, L), each held-out channel's own gain left open within its tolerance.

        No other record can tell that gain, whatever the model: a fit without it would be blamed for it.
        """
        problem, found = self.problem, self.predicted.copy()
        for nuisance in problem.nuisances:
            own = np.flatnonzero(nuisance.rows)
            if nuisance.kind != "gain" or own.size != 1 or not problem.split.held[own[0]]:
                continue
            sigma = problem.measured.sigma[own[0]]
            here = found[own[0]] / sigma
            missing = problem.measured.values[own[0]] / sigma - here
            # |missing - a here|² + (a / sd)² / 2, the square sum of complex values against the score's.
            share = (here.conj() @ missing).real / ((here.conj() @ here).real + 0.5 / nuisance.sd**2)
            # Many lines leave the prior no say: beyond its tolerance a gain is a miss, whatever they prefer.
            found[own[0]] *= 1 + float(np.clip(share, -_WITHIN * nuisance.sd, _WITHIN * nuisance.sd))
        return found

    @property
    def scores(self) -> Array:
        """u and e joined."""
        return np.concatenate([self.u, self.e])

    def values(self, index: int) -> dict[str, tuple[float, float, str]]:
        """Parameters of a hypothesis: value, standard deviation, unit."""
        start = self.u.size + sum(len(h.parameters) for h in self.hypotheses[:index])
        hypothesis = self.hypotheses[index]
        count = len(hypothesis.parameters)
        scores = self.scores[start : start + count]
        sd = np.sqrt(np.diag(self.covariance)[start : start + count])
        here = hypothesis.values(scores)
        out = {}
        for k, p in enumerate(hypothesis.parameters):
            aside = scores.copy()
            aside[k] += 0.01
            slope = (hypothesis.values(aside)[p.name] - here[p.name]) / 0.01
            out[p.name] = (here[p.name], abs(slope) * float(sd[k]), p.unit)
        return out


def calibrate(
    problem: Problem,
    start: Array | None = None,
    *,
    stages: tuple[tuple[float, int], ...] = STAGES,
    progress: Callable[[float, str], None] | None = None,
) -> Fit:
    """Fit what the scenario declares uncertain, and nothing else: the null model. ``start`` (scores,)."""
    at = rough_start(problem)[0] if start is None else start
    return fit(problem, (), at, np.zeros(0), stages, progress, exact=True)


def fit(
    problem: Problem,
    hypotheses: tuple[Hypothesis, ...],
    u: Array,
    e: Array,
    stages: tuple[tuple[float, int], ...] = STAGES,
    progress: Callable[[float, str], None] | None = None,
    judged: float = 0.0,
    exact: bool = False,
) -> Fit:
    """Fit u and the hypotheses' e jointly from a start; NoStructureError where the start describes no aircraft.

    ``judged`` is the coarseness that χ², posterior and evidence refer to. ``exact`` goes on, where the unknowns end up
    far from their stated values, with the slopes of where they are: dear, and for what a verdict rests on.
    """
    phases, passed, converged = _phases(stages, exact), 0, False
    total = sum(n for _, n, _ in phases)
    structures = Structures(problem, coarse=bool(phases) and phases[0][0] > 0)
    here = anchor(problem, u, hypotheses, e, rough=True, structures=structures)
    predicted = here.predict(u, e)
    # With the slopes of the stated values first: where these lead far away, they say where to, and not where to stop.
    for coarse, iterations, rough in phases:
        begun, passed = passed, passed + iterations
        if structures.coarse and coarse == 0:
            structures.coarse = False
            here, predicted = _assembled(structures, u, hypotheses, e)
        if not rough:
            if origin_near(problem, u, e, None, hypotheses) is None:
                continue
            here = anchor(problem, u, hypotheses, e, groups=here.assembled, structures=structures)
        damping = 1.0
        for k in range(iterations):
            if progress is not None:
                progress((begun + k + 1) / total, f"fit, {coarse:.0%} coarse" if coarse else "fit")
            sigma = coarse_sigma(problem, coarse)
            step = _step(here, u, e, predicted, sigma, damping, rough)
            if step is None:
                converged = True
                break
            u, e, here, predicted, damping, gain, promised = step
            # A step held back gains little anywhere: at the bottom not even a free one promises anything.
            if promised < _ENOUGH or gain < _NOTHING:
                converged = True
                break
        else:
            converged = False
    if structures.coarse:
        structures.coarse = False
        here, predicted = _assembled(structures, u, hypotheses, e)
    return _posterior(here, u, e, predicted, converged, None if judged == 0 else coarse_sigma(problem, judged))


def _assembled(
    structures: Structures, u: Array, hypotheses: tuple[Hypothesis, ...], e: Array
) -> tuple[Anchor, ComplexArray]:
    """The anchor and prediction at scores that coarse steps arrived at, nothing carried along."""
    here = anchor(structures.problem, u, hypotheses, e, rough=True, structures=structures)
    return here, here.predict(u, e)


def _phases(stages: tuple[tuple[float, int], ...], exact: bool) -> list[tuple[float, int, bool]]:
    """Coarseness, most iterations, whether rough slopes do: steps that forgive misplaced peaks need no better ones."""
    found: list[tuple[float, int, bool]] = []
    for coarse, iterations in stages:
        found.append((coarse, iterations, True))
        if exact and coarse == 0:
            found.append((coarse, iterations, False))
    return found


def cost_at(problem: Problem, hypotheses: tuple[Hypothesis, ...], u: Array, e: Array) -> float:
    """Square sum of misfit and scores at u and e, what a fit lowers; infinite where there is no such aircraft."""
    try:
        predicted = anchor(problem, u, hypotheses, e, slopes=False).predict(u, e)
    except NoStructureError:
        return np.inf
    misfit = data_misfit(problem, predicted)
    return float(misfit @ misfit + u @ u + e @ e)


def _step(
    here: Anchor, u: Array, e: Array, predicted: ComplexArray, sigma: Array, damping: float, rough: bool
) -> tuple[Array, Array, Anchor, ComplexArray, float, float, float] | None:
    """One accepted step, what it gained and what a free one promised of the cost; None where none is found."""
    problem = here.problem
    misfit = data_misfit(problem, predicted, sigma)
    tangent = jacobian(here, u, e, predicted, sigma)
    scores = np.concatenate([u, e])
    cost = float(misfit @ misfit + scores @ scores)
    normal = tangent.T @ tangent + np.eye(scores.size)
    gradient = tangent.T @ misfit + scores
    promised = float(gradient @ scipy.linalg.solve(normal, gradient, assume_a="pos")) / cost
    longest = max(_LONGEST_STEP, _LONGEST_SHARE * float(np.abs(scores).max()))
    for _ in range(_REJECTIONS):
        # Scores are in units of their priors: damping by the identity spares the well-determined directions.
        damped = normal + damping * np.eye(scores.size)
        move = -scipy.linalg.solve(damped, gradient, assume_a="pos")
        move *= min(1.0, longest / max(np.abs(move).max(), 1e-300))
        new_u, new_e = _moved(here, u, e, move)
        try:
            there = anchor(problem, new_u, here.hypotheses, new_e, slopes=False, structures=here.structures)
            trial = there.predict(new_u, new_e)
        except NoStructureError:
            damping = max(10 * damping, 1.0)
            continue
        found = data_misfit(problem, trial, sigma)
        new_cost = float(found @ found + new_u @ new_u + new_e @ new_e)
        if new_cost < cost:
            there = anchor(
                problem, new_u, here.hypotheses, new_e, groups=there.assembled, origin=here.origin, rough=rough,
                structures=here.structures,
            )  # fmt: skip
            return new_u, new_e, there, trial, damping / 10, (cost - new_cost) / cost, promised
        damping = max(10 * damping, 1.0)
    return None


def _moved(here: Anchor, u: Array, e: Array, move: Array) -> tuple[Array, Array]:
    """Scores after a step that is straight in amounts, as the valley is where an effect and an unknown trade places."""
    new_u, new_e = u + move[: u.size], e + move[u.size :]
    for k, unknown in enumerate(here.problem.unknowns):
        new_u[k] = unknown.moved(float(u[k]), float(move[k]), float(u[k]))
    start = 0
    for hypothesis in here.hypotheses:
        stop = start + len(hypothesis.parameters)
        new_e[start:stop] = hypothesis.moved(e[start:stop], move[u.size + start : u.size + stop])
        start = stop
    return new_u, new_e


def _posterior(here: Anchor, u: Array, e: Array, predicted: ComplexArray, converged: bool, sigma: Array | None) -> Fit:
    problem = here.problem
    misfit = data_misfit(problem, predicted, sigma)
    tangent = jacobian(here, u, e, predicted, sigma)
    scores = np.concatenate([u, e])
    precision = tangent.T @ tangent + np.eye(scores.size)
    chi2 = float(misfit @ misfit)
    log_determinant = float(np.linalg.slogdet(precision)[1])
    share = sum(float(np.log(h.share)) for h in here.hypotheses)
    evidence = -0.5 * (chi2 + float(scores @ scores)) - 0.5 * log_determinant + share
    covariance = np.asarray(np.linalg.inv(precision), dtype=np.float64)
    return Fit(
        problem, here.hypotheses, u, e, predicted, tangent, covariance, chi2, misfit.size, evidence, converged, sigma
    )
