"""A thing that no catalogue has, fitted: what a model leaves with a smooth law at one place, and all unknowns free.

To first order a law says where something is left (:mod:`vgvt.reconcile.evidence.still_explained`). What is really
there is seldom small, and has been imitated by whatever could: it is only seen for what it is where the unknowns may
let go of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data.shown import headed
from vgvt.reconcile.evidence.fitted_law import FittedLaw
from vgvt.reconcile.evidence.free_places import ON_BOTH_SIDES, FreePlace, free_places, place_at, with_mirror_images
from vgvt.reconcile.evidence.lasting import lasting_evidence
from vgvt.reconcile.evidence.nameless_descent import Slopes, State, walked
from vgvt.reconcile.evidence.rivals import worth_of
from vgvt.reconcile.evidence.smooth_law import TERMS, SmoothLaw, law_terms
from vgvt.reconcile.evidence.still_explained import StillExplained
from vgvt.reconcile.evidence.strain import strain_sd
from vgvt.reconcile.evidence.whole_airframe import whole_airframe
from vgvt.reconcile.fitting.foretold import foretold, held_out_chi2
from vgvt.reconcile.fitting.misfit import coarse_sigma
from vgvt.reconcile.prediction.carried import Structures
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_STEPS = 20


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Nameless:
    """A model with a thing that has no name: where it is, scores ``u`` and ``e`` of ``hypotheses`` beside it, and A/F.

    ``covariance`` is that of all scores, the law free; ``law`` its dynamic stiffness, or what it adds to a factor of
    one; ``chi2`` the square sum of the misfit and ``cost`` that of the scores, too; ``predicted`` (C, L) what is
    foretold with it. ``evidence_nats`` is Laplace's of the scores, the law's values held, and ``lasting_nats`` where
    errors of the model last: these values have no prior, and cost what chance would make of as many. Where it was set
    against names, it stands ``instead_of`` these, ``ahead_nats`` before all names together by all that it costs; else
    before the model without it.
    """

    where: StillExplained
    problem: Problem
    hypotheses: tuple[Hypothesis, ...]
    u: Array
    e: Array
    covariance: Array
    law: FittedLaw
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
        names = " and ".join(self.instead_of) or "the model without it"
        ahead = "more" if self.ahead_nats >= 0 else "less"
        each = " on each side" if self.where.label.endswith(ON_BOTH_SIDES) else ""
        said = f"a {self.where.words} that is smooth over frequency and {self.law.reading.in_words}{each}"
        if self.hypotheses:
            said += f", beside {' and '.join(h.label for h in self.hypotheses)}"
        said += f", takes {abs(self.ahead_nats):.0f} nats {ahead} than {names}"
        held = self.held_out_chi2_per_dof
        left = f"it leaves {self.chi2_per_dof:.2f} per degree of freedom"
        return f"{said}: {left}{'' if held is None else f', {held:.2f} of those held out'}"

    def document(self) -> dict[str, object]:
        """Plain values by the keys of the JSON contract."""
        return {
            "place": " or ".join([self.where.label, *self.where.or_on]),
            "kind": self.where.kind,
            "when": self.where.when,
            "instead_of": list(self.instead_of),
            "beside": [h.label for h in self.hypotheses],
            "ahead_nats": self.ahead_nats,
            "law": self.law.document(),
            "strain_sd": strain_sd(self),
            "chi2_per_dof": self.chi2_per_dof,
            "held_out_chi2_per_dof": self.held_out_chi2_per_dof,
        }

    @property
    def chi2_per_dof(self) -> float:
        """χ² per fitted real number, each channel by itself."""
        measured, train = self.problem.measured, self.problem.split.train
        return float(np.mean(np.abs((self.predicted - measured.values)[train] / measured.sigma[train]) ** 2))

    @property
    def scores(self) -> Array:
        """Scores of the unknowns, then of the hypotheses beside it."""
        return np.concatenate([self.u, self.e])

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
    stages: tuple[tuple[float, int], ...] = (),
) -> Nameless | None:
    """A law at a place, with all scores free, by Levenberg and Marquardt from u, e and no law at all.

    ``stages`` come before, of a coarseness and so many steps each, for a start that is far.
    None where there is no such aircraft, or no such place on it. It is given up, wherever it has got to, where it
    does not promise to reach a cost that is not ``worthless``. Of what is one with it where fitted it is what meets
    held-out data best.
    """
    structures = Structures(problem)
    try:
        here = anchor(problem, u, hypotheses, e, structures=structures)
        known = with_mirror_images([*free_places(problem, here, problem.split.train), *whole_airframe(here)])
        if where.point_m is not None:
            known[where.label] = (place_at(here, *where.point_m),)
        if where.label not in known:
            return None
        acting, terms = SmoothLaw(known[where.label], np.array(where.course)), law_terms(problem.measured.frequency_hz)
        state = State.at(here, acting, terms, u, e, np.zeros(TERMS, dtype=complex))
    except NoStructureError:
        return None
    for coarse, steps in stages:
        state, _ = walked(state.judged(coarse_sigma(problem, coarse)), steps)
    state, hopeless = walked(state.judged(None), _STEPS, worthless)
    try:
        # Slopes that lead down need not be those of where it ends.
        state = state.at_the_end()
        if not hopeless:
            state = walked(state, _STEPS, worthless)[0].at_the_end()
    except NoStructureError:
        return None
    where, state = _met_best(state, where, known)
    slopes = Slopes.of(state)
    share = sum(float(np.log(h.share)) for h in hypotheses)
    scores = np.concatenate([state.u, state.e])
    evidence = -0.5 * (state.cost + slopes.log_det) + share
    lasting = lasting_evidence(problem, state.misfit, slopes.tangent, scores, share, aside=state.misfit_at)
    law = FittedLaw(
        problem.measured.frequency_hz, state.sizes, worth_of(problem, state.predicted) * slopes.of_law,
        state.acting.places[0].kind, state.acting.places[0].turns,
    )  # fmt: skip
    chi2 = float(state.misfit @ state.misfit)
    return Nameless(
        where, problem, hypotheses, state.u, state.e, slopes.covariance, law, state.predicted, chi2, state.cost,
        evidence, lasting,
    )  # fmt: skip


def _met_best(
    state: State, where: StillExplained, known: Mapping[str, tuple[FreePlace, ...]]
) -> tuple[StillExplained, State]:
    """The thing that meets held-out data best, of those that are one where fitted, and the state with it.

    As names have it of their courses (:func:`vgvt.reconcile.search.courses.best_course`): the fit says nothing of which
    it is, and what was held out must not refuse the thing for the one that was tried.
    """
    problem = state.here.problem
    best, least = (replace(where, alike=()), state), held_out_chi2(problem, state.predicted)
    for there in where.alike:
        acting = SmoothLaw(known[there.label], np.array(there.course))
        try:
            also = State.at(state.here, acting, state.terms, state.u, state.e, state.sizes)
        except NoStructureError:
            continue
        missed = held_out_chi2(problem, also.predicted)
        if least is not None and missed is not None and missed < least:
            best, least = (there, also), missed
    return best
