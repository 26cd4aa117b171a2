"""A thing that no catalogue has, fitted: what a model leaves with a smooth law at one place, and all unknowns free.

To first order a law says where something is left (:mod:`vgvt.reconcile.evidence.still_explained`). What is really
there is seldom small, and has been imitated by whatever could: it is only seen for what it is where the unknowns may
let go of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data.shown import headed
from vgvt.reconcile.evidence.free_places import free_places, with_mirror_images
from vgvt.reconcile.evidence.lasting import lasting_evidence
from vgvt.reconcile.evidence.smooth_law import TERMS, SmoothLaw, law_terms
from vgvt.reconcile.evidence.still_explained import StillExplained
from vgvt.reconcile.fitting.descent import after_a_refusal, after_a_step, arrived, longest_step, moved, solved
from vgvt.reconcile.fitting.foretold import foretold, held_out_chi2
from vgvt.reconcile.fitting.misfit import data_misfit, jacobian, standardised
from vgvt.reconcile.prediction.carried import Structures
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.surrogate import Anchor, anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_STEPS, _REJECTIONS = 20, 6
_FIRST_DAMPING = 1e-2
# As many times what a free step promised to take off may yet be taken off: the slopes are those of a smaller law.
_HOPELESS = 2.0
# Peaks that are apart promise little at first.
_FIRST_LOOK = 2
# What holds a law's values, in the deviations that each of them makes: nothing, but for those that change nothing.
_LOOSE = 1e-9


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Nameless:
    """A model with a thing that has no name: where it is, scores ``u`` and ``e`` of ``hypotheses`` beside it, and A/F.

    ``law`` (L,) is its dynamic stiffness, N/m or N m/rad, or what it adds to a factor of one; ``chi2`` the square sum
    of the misfit and ``cost`` that of the scores, too; ``predicted`` (C, L) what is foretold with it.
    ``evidence_nats`` is Laplace's of the scores, the law's values held, and ``lasting_nats`` where errors of the model
    last: these values have no prior, and cost what chance would make of as many. Slopes are those without the law.
    Where it was set against names, it stands ``instead_of`` these, ``ahead_nats`` before all names together by all
    that it costs.
    """

    where: StillExplained
    problem: Problem
    hypotheses: tuple[Hypothesis, ...]
    u: Array
    e: Array
    law: ComplexArray
    predicted: ComplexArray
    chi2: float
    cost: float
    evidence_nats: float
    lasting_nats: float
    instead_of: tuple[str, ...] = ()
    ahead_nats: float = 0.0

    def __repr__(self) -> str:
        return headed(f"Nameless: {self.in_words}")

    @property
    def in_words(self) -> str:
        """What it is, how well it does, and what it leaves, as the rest of a sentence."""
        names = " and ".join(self.instead_of)
        said = f"a {self.where.words} that is smooth over frequency"
        if self.instead_of:
            ahead = "more" if self.ahead_nats >= 0 else "less"
            said += f", takes {abs(self.ahead_nats):.0f} nats {ahead} than {names}"
        held = self.held_out_chi2_per_dof
        left = f"it leaves {self.chi2_per_dof:.2f} per degree of freedom"
        return f"{said}: {left}{'' if held is None else f', {held:.2f} of those held out'}"

    def document(self) -> dict[str, object]:
        """Plain values by the keys of the JSON contract."""
        return {
            "place": self.where.label,
            "kind": self.where.kind,
            "when": self.where.when,
            "instead_of": list(self.instead_of),
            "ahead_nats": self.ahead_nats,
            "chi2_per_dof": self.chi2_per_dof,
            "held_out_chi2_per_dof": self.held_out_chi2_per_dof,
        }

    @property
    def chi2_per_dof(self) -> float:
        """χ² per fitted real number, each channel by itself."""
        measured, train = self.problem.measured, self.problem.split.train
        return float(np.mean(np.abs((self.predicted - measured.values)[train] / measured.sigma[train]) ** 2))

    @property
    def foretold(self) -> ComplexArray:
        """The prediction (C, L), each held-out channel's own gain left open within its tolerance."""
        return foretold(self.problem, self.predicted)

    @property
    def held_out_chi2_per_dof(self) -> float | None:
        """χ² per held-out value, by what is foretold of them; None where nothing is held out."""
        return held_out_chi2(self.problem, self.predicted)


def with_nameless(
    problem: Problem,
    hypotheses: tuple[Hypothesis, ...],
    u: Array,
    e: Array,
    where: StillExplained,
    worthless: float = np.inf,
) -> Nameless | None:
    """A law at a place, with all scores free, by Levenberg and Marquardt from u, e and no law at all.

    None where there is no such aircraft, or no such place on it. It is given up, wherever it has got to, where a free
    step promises less than half of what it lacks to a cost that is not ``worthless``.
    """
    structures = Structures(problem)
    try:
        here = anchor(problem, u, hypotheses, e, structures=structures)
        places = with_mirror_images(free_places(problem, here, problem.split.train)).get(where.label)
        if places is None:
            return None
        terms = law_terms(problem.measured.frequency_hz)
        state = _State.at(here, SmoothLaw(places, np.array(where.course)), terms, u, e, np.zeros(TERMS, dtype=complex))
    except NoStructureError:
        return None
    damping = _FIRST_DAMPING
    for step in range(_STEPS):
        slopes = _Slopes.of(state)
        reached, damping = _lower(state, slopes, structures, damping)
        if reached is None:
            break
        state = reached
        if step >= _FIRST_LOOK and state.cost - worthless > _HOPELESS * slopes.promised:
            break
        if arrived(state.misfit.size, slopes.promised, state.cost):
            break
    slopes = _Slopes.of(state)
    share = sum(float(np.log(h.share)) for h in hypotheses)
    scores = np.concatenate([state.u, state.e])
    evidence = -0.5 * (state.cost + slopes.log_det) + share
    lasting = lasting_evidence(problem, state.misfit, slopes.tangent, scores, share)
    chi2, law = float(state.misfit @ state.misfit), terms @ state.sizes
    return Nameless(
        where, problem, hypotheses, state.u, state.e, law, state.predicted, chi2, state.cost, evidence, lasting
    )


def _lower(state: _State, slopes: _Slopes, structures: Structures, damping: float) -> tuple[_State | None, float]:
    """The state after the first step that takes something off the cost, None where none does, and the next damping."""
    for _ in range(_REJECTIONS):
        move = slopes.move(damping)
        reached = state.moved(move, slopes.unit, structures)
        if reached is not None and reached.cost < state.cost:
            kept = (state.cost - reached.cost) / slopes.promised_by(move)
            try:
                return reached.sloped(structures), after_a_step(damping, kept)
            except NoStructureError:
                return None, damping
        damping = after_a_refusal(damping)
    return None, damping


def _alike(one: Anchor, other: Anchor) -> bool:
    """Whether runs share structures alike at two anchors: places are rows over the coordinates of each."""
    return [g.channels.tolist() for g in one.assembled] == [g.channels.tolist() for g in other.assembled]


@dataclass(frozen=True, slots=True, eq=False)
class _State:
    """Scores u and e, the law's ``sizes`` (TERMS,), A/F (C, L) there, its slopes (C, L) in the law, and the cost."""

    here: Anchor
    acting: SmoothLaw
    terms: Array
    u: Array
    e: Array
    sizes: ComplexArray
    predicted: ComplexArray
    by_law: ComplexArray
    misfit: Array
    cost: float

    @classmethod
    def at(cls, here: Anchor, acting: SmoothLaw, terms: Array, u: Array, e: Array, sizes: ComplexArray) -> _State:
        """What is foretold at scores and sizes; NoStructureError where the response is not finite."""
        without = here.predict(u, e)
        predicted, by_law = acting.changed(here, without, here.chain(u, e), terms @ sizes)
        misfit = data_misfit(here.problem, predicted)
        cost = float(misfit @ misfit + u @ u + e @ e)
        return cls(here, acting, terms, u, e, sizes, predicted, by_law, misfit, cost)

    def moved(self, move: Array, unit: Array, structures: Structures) -> _State | None:
        """The state after a step (scores and 2 TERMS,), a law's values by ``unit``; None where there is no aircraft.

        It has no slopes in the unknowns.
        """
        problem, hypotheses = self.here.problem, self.here.hypotheses
        count = self.u.size + self.e.size
        u, e = moved(problem, hypotheses, self.u, self.e, move[:count])
        change = move[count:] * unit
        sizes = self.sizes + change[:TERMS] + 1j * change[TERMS:]
        try:
            here = anchor(problem, u, hypotheses, e, slopes=False, structures=structures)
            if not _alike(self.here, here):
                return None
            return _State.at(here, self.acting, self.terms, u, e, sizes)
        except NoStructureError:
            return None

    def sloped(self, structures: Structures) -> _State:
        """The same with slopes in the unknowns."""
        here, known = self.here, self.here.assembled
        return replace(
            self, here=anchor(here.problem, self.u, here.hypotheses, self.e, groups=known, structures=structures)
        )


@dataclass(frozen=True, slots=True, eq=False)
class _Slopes:
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
    def of(cls, state: _State) -> _Slopes:
        """Slopes of a state."""
        problem = state.here.problem
        # Slopes in the unknowns are those without the law: what it makes of them steps find out.
        tangent = jacobian(state.here, state.u, state.e, state.predicted)
        by_law = standardised(problem, state.by_law[problem.split.train][:, :, None] * state.terms)
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

    def move(self, damping: float) -> Array:
        """A damped Gauss-Newton step (n,)."""
        move = -solved(self.normal + damping * np.eye(self.gradient.size), self.gradient)
        farthest = float(np.abs(move[: -2 * TERMS]).max(initial=0.0))
        return move * min(1.0, self.longest / max(farthest, 1e-300))

    def promised_by(self, move: Array) -> float:
        """What a step (n,) takes off the cost where slopes stay as they are."""
        return -float(2 * self.gradient @ move + move @ self.normal @ move)
