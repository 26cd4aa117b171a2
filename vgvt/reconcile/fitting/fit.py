"""Fit scores of the scenario's unknowns, and of hypotheses, by Levenberg and Marquardt with continuation.

A coarse relative error first (60 %, 15 %, 0) lets misplaced peaks attract each other. The structure is assembled
anew after every step, so that the linearisation never carries further than one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data.shown import counted, headed
from vgvt.reconcile.fitting.descent import NOTHING, arrived, taken
from vgvt.reconcile.fitting.followed_descent import followed_down
from vgvt.reconcile.fitting.foretold import foretold, held_out_chi2
from vgvt.reconcile.fitting.misfit import coarse_sigma, data_misfit, jacobian
from vgvt.reconcile.prediction.carried import Structures
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.level_following import Following
from vgvt.reconcile.prediction.local_slopes import Origin, origin_at
from vgvt.reconcile.prediction.surrogate import Anchor, anchor
from vgvt.reconcile.prediction.unheard import unheard
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS, Problem, at_rest
from vgvt.reconcile.work.one_thread import one_thread

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

STAGES = ((0.6, 4), (0.15, 4), (0.0, 60))
"""Coarseness and most iterations of each stage of the continuation: a stage ends where nothing is gained."""
NEAR = ((0.0, 12),)
"""For a start that is near already."""
FAR = ((0.15, 4), (0.05, 3), (0.0, 20))
"""For a start from a model that misses much."""
FORGIVING = ((0.6, 8), (0.15, 8))
"""From the stated values towards what is far from them, sharp resonances too: nothing of it is judged by less."""
TO_THE_END = ((0.0, 60),)
"""For a fit that was stopped on its way down."""
FOLLOWED = 60
"""Most steps beside a joint whose stiffness depends on level, with slopes that follow what it shows."""
# Of the normal distribution's middle 95 %.
_CONFIDENCE_Z = 1.959963984540054


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A fitted model: scores ``u`` (and ``e`` of its hypotheses), prediction (C, L) and the Laplace posterior.

    ``tangent`` (2 N, scores) are derivatives of the data misfit; ``covariance`` (scores, scores) that of the
    scores; ``chi2`` the data's square sum over ``points`` real numbers, what channels share taken out;
    ``evidence_nats`` Laplace's log evidence.
    ``sigma`` (fitted channels, L) is what it was judged by where that is not the data's. ``unseen`` (k, scores) is by
    how much things that the model has no unknown for may have moved its scores (:mod:`vgvt.reconcile.evidence.unseen`).
    ``origin`` is where its slopes in the unknowns were taken, None for the problem's own: evidence hangs on them.
    ``followed`` says that they hold how what joints show follows the unknowns.
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
    unseen: Array | None = None
    origin: Origin | None = None
    followed: bool = False

    def __repr__(self) -> str:
        held = self.held_out_chi2_per_dof
        left = f"χ² per degree of freedom {self.chi2_per_dof:.3g}{'' if held is None else f', {held:.3g} held out'}"
        moved = [(n, u) for n, u in zip(self.problem.names, self.u, strict=True) if n != CELLS.name]
        far = [f"{n} {u:+.2g}" for n, u in sorted(moved, key=lambda pair: -abs(pair[1]))[:4]]
        lines = [f"{h.label}: {_in_units(self.values(k))}" for k, h in enumerate(self.hypotheses)]
        lines += [f"furthest from what is stated, in stated deviations: {', '.join(far)}"] if far else []
        ended = "" if self.converged else ", not converged"
        head = f"Fit of {self.problem.scenario.name}: {left}{ended}, {counted(self.scores.size, 'score')}"
        return headed(f"{head}, log evidence {self.evidence_nats:.4g} nats", lines)

    @property
    def chi2_per_dof(self) -> float:
        """χ² per fitted real number, each channel by itself, as limits and shares of noise have it."""
        if self.sigma is not None:
            return self.chi2 / self.points
        measured, train = self.problem.measured, self.problem.split.train
        return float(np.mean(np.abs((self.predicted - measured.values)[train] / measured.sigma[train]) ** 2))

    @property
    def foretold(self) -> ComplexArray:
        """The prediction (C, L), each held-out channel's own gain left open within its tolerance.

        No other record can tell that gain, whatever the model: a fit without it would be blamed for it.
        """
        return foretold(self.problem, self.predicted)

    @property
    def held_out_chi2_per_dof(self) -> float | None:
        """χ² per held-out value, by what the fit foretells of them; None where nothing is held out."""
        return held_out_chi2(self.problem, self.predicted)

    @property
    def scores(self) -> Array:
        """u and e joined."""
        return np.concatenate([self.u, self.e])

    @property
    def cost(self) -> float:
        """Square sum of misfit and scores: what a fit lowers."""
        scores = self.scores
        return self.chi2 + float(scores @ scores)

    def values(self, index: int) -> dict[str, tuple[float, float, str]]:
        """Parameters of a hypothesis: value, standard deviation, unit."""
        hypothesis, scores, sd = self._known(index)
        here = hypothesis.values(scores)
        out = {}
        for k, p in enumerate(hypothesis.parameters):
            aside = scores.copy()
            aside[k] += 0.01
            slope = (hypothesis.values(aside)[p.name] - here[p.name]) / 0.01
            out[p.name] = (here[p.name], abs(slope) * float(sd[k]), p.unit)
        return out

    def ranges(self, index: int) -> dict[str, tuple[float, float]]:
        """95 % intervals of a hypothesis' parameters: straight in scores, so lopsided on a logarithmic scale."""
        hypothesis, scores, sd = self._known(index)
        low, high = (hypothesis.values(scores + side * _CONFIDENCE_Z * sd) for side in (-1, 1))
        return {p.name: (low[p.name], high[p.name]) for p in hypothesis.parameters}

    def _known(self, index: int) -> tuple[Hypothesis, Array, Array]:
        """A hypothesis with the scores (its parameters,) of its own and their standard deviations."""
        hypothesis = self.hypotheses[index]
        start = self.u.size + sum(len(h.parameters) for h in self.hypotheses[:index])
        mine = slice(start, start + len(hypothesis.parameters))
        return hypothesis, self.scores[mine], np.sqrt(np.diag(self.covariance)[mine])


def _in_units(values: dict[str, tuple[float, float, str]]) -> str:
    """Fitted values; how well they are known is not a fit's alone to say (:mod:`vgvt.reconcile.evidence.posterior`)."""
    return ", ".join(f"{name} = {value:.4g} {unit}".rstrip() for name, (value, _, unit) in values.items())


@one_thread
def fit(
    problem: Problem,
    hypotheses: tuple[Hypothesis, ...],
    u: Array,
    e: Array,
    stages: tuple[tuple[float, int], ...] = STAGES,
    progress: Callable[[float, str], None] | None = None,
    judged: float = 0.0,
    exact: bool = False,
    whole: bool = False,
    origin: Origin | None = None,
    follow: bool = False,
) -> Fit:
    """Fit u and the hypotheses' e jointly from a start; NoStructureError where the start describes no aircraft.

    ``judged`` is the coarseness that χ², posterior and evidence refer to. ``exact`` goes on, where the unknowns end up
    far from their stated values, with the slopes of where they are: dear, and for what a verdict rests on. ``whole``
    has no others, and those of the aircraft with the hypotheses: for a fit whose parameters and errors are told.
    ``origin`` is where the first slopes are taken, by default those of the stated values serve until they mislead.
    ``follow`` goes on to the end, if there are stages, with slopes that know how what joints show follows the unknowns:
    a march of every run for each unknown, and for what is told. Beside such a joint coarse stages alone come before:
    judged by the data's own deviations, slopes that hold what it shows lead out of the valley.
    """
    phases = _phases(stages, exact, whole)
    structures = Structures(problem, coarse=bool(phases) and phases[0][0] > 0, whole=whole)
    rough = origin is None and not whole
    here = anchor(problem, u, hypotheses, e, origin=origin, rough=rough, structures=structures)
    predicted = here.predict(u, e)
    bends, ends = follow and any(group.levels is not None for group in here.groups), bool(phases)
    if bends:
        phases = [phase for phase in phases if phase[0] > 0]
    quiet = bool(phases) and unheard(here, u, e, predicted)
    if quiet:
        here, predicted = _anchored(here, at_rest(problem), u, e)
    u, e, here, predicted, converged = _walked(here, u, e, predicted, phases, progress)
    if quiet:
        here, predicted = _anchored(here, problem, u, e)
        if not unheard(here, u, e, predicted):
            # Something rings there that did not where it began: the last stage once more, with slopes of either kind.
            last = [phase for phase in phases if phase[0] == phases[-1][0]]
            u, e, here, predicted, converged = _walked(here, u, e, predicted, last, progress)
    if bends and ends:
        u, e, here, predicted, converged = followed_down(here, u, e, FOLLOWED, progress)
    elif bends:
        here.structures.follows = Following()
        here, predicted = _assembled(here, u, e)
    return _posterior(here, u, e, predicted, converged, coarse_sigma(problem, judged))


def _walked(
    here: Anchor,
    u: Array,
    e: Array,
    predicted: ComplexArray,
    phases: list[tuple[float, int, bool]],
    progress: Callable[[float, str], None] | None,
) -> tuple[Array, Array, Anchor, ComplexArray, bool]:
    """Where phases lead from scores u and e: scores, the anchor and prediction there, and whether it is the bottom."""
    problem, hypotheses, structures, passed, converged = here.problem, here.hypotheses, here.structures, 0, False
    total, points = sum(n for _, n, _ in phases), 2 * predicted[problem.split.train].size
    # With the slopes of the stated values first: where these lead far away, they say where to, and not where to stop.
    for coarse, iterations, rough in phases:
        begun, passed = passed, passed + iterations
        if structures.coarse and coarse == 0:
            structures.coarse = False
            here, predicted = _assembled(here, u, e)
        if not rough and not structures.whole:
            if origin_at(problem, u, e, hypotheses) is None:
                continue
            here = anchor(problem, u, hypotheses, e, groups=here.assembled, structures=structures)
        damping, stuck, sigma = 1.0, False, coarse_sigma(problem, coarse)
        for k in range(iterations):
            if progress is not None:
                progress((begun + k + 1) / total, f"fit, {coarse:.0%} coarse" if coarse else "fit")
            # Steps that forgive misplaced peaks need no better slopes, and new ones are dear.
            step = taken(here, u, e, predicted, sigma, damping, coarse > 0)
            if step is None:
                converged = True
                break
            u, e, here, predicted, damping = step.u, step.e, step.here, step.predicted, step.damping
            # A step held back gains little anywhere: at the bottom not even a free one promises anything.
            judged_by = points if sigma is None else 0
            if arrived(judged_by, step.promised * step.cost, step.cost) or (step.gain < NOTHING and stuck):
                converged = True
                break
            stuck = step.gain < NOTHING
        else:
            converged = False
    if structures.coarse:
        structures.coarse = False
        here, predicted = _assembled(here, u, e)
    return u, e, here, predicted, converged


def _anchored(here: Anchor, problem: Problem, u: Array, e: Array) -> tuple[Anchor, ComplexArray]:
    """The anchor of the same structures, and the prediction there, for the same aircraft by another problem's data."""
    known = here.structures
    there = anchor(
        problem, u, here.hypotheses, e, groups=here.assembled, origin=here.origin,
        rough=here.origin is None and not known.whole,
        structures=Structures(problem, coarse=known.coarse, whole=known.whole),
    )  # fmt: skip
    return there, there.predict(u, e)


def _assembled(here: Anchor, u: Array, e: Array) -> tuple[Anchor, ComplexArray]:
    """The anchor and prediction at scores that coarse steps arrived at, nothing carried along but the slopes."""
    here = anchor(
        here.problem, u, here.hypotheses, e, origin=here.origin, rough=here.origin is None, structures=here.structures
    )
    return here, here.predict(u, e)


def _phases(stages: tuple[tuple[float, int], ...], exact: bool, whole: bool) -> list[tuple[float, int, bool]]:
    """Coarseness, most iterations, whether rough slopes do: steps that forgive misplaced peaks need no better ones."""
    found: list[tuple[float, int, bool]] = []
    for coarse, iterations in stages:
        found.append((coarse, iterations, not whole))
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
    cost = float(misfit @ misfit + u @ u + e @ e)
    # What no march comes through has no response.
    return cost if np.isfinite(cost) else np.inf


def _posterior(here: Anchor, u: Array, e: Array, predicted: ComplexArray, converged: bool, sigma: Array | None) -> Fit:
    problem = here.problem
    misfit = data_misfit(problem, predicted, sigma)
    tangent = jacobian(here, u, e, predicted, sigma)
    if not np.isfinite(tangent).all():
        raise NoStructureError("the response beside it is not finite")
    scores = np.concatenate([u, e])
    precision = tangent.T @ tangent + np.eye(scores.size)
    chi2 = float(misfit @ misfit)
    log_determinant = float(np.linalg.slogdet(precision)[1])
    share = sum(float(np.log(h.share)) for h in here.hypotheses)
    evidence = -0.5 * (chi2 + float(scores @ scores)) - 0.5 * log_determinant + share
    covariance = np.asarray(np.linalg.inv(precision), dtype=np.float64)
    return Fit(
        problem, here.hypotheses, u, e, predicted, tangent, covariance, chi2, misfit.size, evidence, converged, sigma,
        origin=here.origin, followed=here.structures.follows is not None,
    )  # fmt: skip
