"""Fitted candidates against the model without them: the evidence that each gains, tempered, and what held-out data say.

Who of them gives its name is decided in :mod:`vgvt.reconcile.decision.attribute`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data.shown import headed
from vgvt.reconcile.evidence.lasting import lasting_nats
from vgvt.reconcile.evidence.residual import independent_values
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.fitting.misfit import standardised
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.question.thresholds import Thresholds, noise_share

ComplexArray = NDArray[np.complex128]

# Of what the model without an effect misses: a bent one may meet data by chance a little better than a right one.
_ASTRAY = 2.0
# Fits of the same effects that arrived as near to each other as this, in scores of the effects, are one.
_MET = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Rival:
    """A fitted candidate: its gain of evidence over the model without it, in tempered nats, and what it leaves.

    ``raw_nats`` are untempered; ``lasting_nats`` what it gains where an error of the model's form lasts from line to
    line (:mod:`vgvt.reconcile.evidence.lasting`); ``held_out`` is held-out χ² per degree of freedom, None without
    held-out data.
    """

    fit: Fit
    gain_nats: float
    raw_nats: float
    lasting_nats: float
    held_out: float | None

    def __repr__(self) -> str:
        held = "" if self.held_out is None else f", {self.held_out:.3g} per held-out degree of freedom"
        nats = f"{self.gain_nats:.1f} nats, {self.lasting_nats:.1f} where errors last"
        return headed(f"Rival {self.hypothesis.label}: {nats}{held}")

    @property
    def hypothesis(self) -> Hypothesis:
        """The effect that this candidate adds last."""
        return self.fit.hypotheses[-1]

    @property
    def name(self) -> str:
        """Name of the effect added last."""
        return self.hypothesis.name

    def convinces(self, thresholds: Thresholds) -> bool:
        """Whether it gains what a name needs, by both views of the model's own error.

        Which of two rivals is ahead is told by what tempered evidence says of both; whether either is there at all must
        not rest on an error that fifty lines share being seen fifty times.
        """
        return min(self.gain_nats, self.lasting_nats) >= thresholds.evidence_nats


def distinct(fits: Sequence[Fit]) -> list[Fit]:
    """Fits, best first, without those that arrived where a better one of the same effects did."""
    kept: list[Fit] = []
    for f in sorted(fits, key=lambda f: -f.evidence_nats):
        if not any(_met(f, better) for better in kept):
            kept.append(f)
    return kept


def _met(one: Fit, other: Fit) -> bool:
    same = [[(h.cls, dict(h.settings)) for h in f.hypotheses] for f in (one, other)]
    return same[0] == same[1] and float(np.abs(one.e - other.e).max(initial=0.0)) < _MET


def worth_to(found: Fit) -> float:
    """What one of the values that a fit was made to is worth to it: as many as are independent of what it leaves."""
    return worth_of(found.problem, found.predicted)


def worth_of(problem: Problem, predicted: ComplexArray) -> float:
    """What one of the fitted values is worth to whatever foretells (C, L)."""
    measured, keep = problem.measured, problem.split.train
    rho = standardised(problem, (predicted - measured.values)[keep])
    return float(min(1.0, independent_values(rho) / (2 * rho.size)) * noise_share(measured, keep).worth)


def overrated(chi2: float, current: Fit, worth: float) -> float:
    """By how many nats what a model with that χ² gains over another is too much, where a value is ``worth`` less."""
    gained = 0.0 if chi2 > _ASTRAY * current.chi2 else current.chi2 - chi2
    return 0.5 * (1 - worth) * gained


def against(current: Fit, fits: Sequence[Fit]) -> tuple[Rival, ...]:
    """Fits with one effect more as rivals, judged against the model without it, best first.

    Under a model that leaves more than noise, χ² counts as many independent values as the residual of the best fit
    has, not as many as there are lines, and no more than what it is judged by is worth: the same number for every
    rival, or they could not be compared. What a fit misses that went astray counts whole, or it would be thanked for
    the tolerances that it keeps.
    """
    if not fits:
        return ()
    worth = worth_to(max(fits, key=lambda f: f.evidence_nats))
    rivals, lasting = [], lasting_nats(current)
    for f in fits:
        raw = f.evidence_nats - current.evidence_nats
        tempered = raw - overrated(f.chi2, current, worth)
        rivals.append(Rival(f, tempered, raw, lasting_nats(f) - lasting, f.held_out_chi2_per_dof))
    return tuple(sorted(rivals, key=lambda r: -r.gain_nats))
