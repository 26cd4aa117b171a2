"""Whether data that no fit has seen confirm a name: better than chance where they can tell, not worse where not."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.evidence.residual import Residual, independent_values
from vgvt.reconcile.evidence.strain import strain_sd
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.question.shared_noise import apart
from vgvt.reconcile.question.thresholds import Thresholds, noise_share

ComplexArray = NDArray[np.complex128]
Rows = NDArray[np.bool_]
# Held-out data must speak for a name by more than chance fluctuation.
_HELD_OUT_NATS = 1.0
# Standard deviations within which held-out data are not against a name that they cannot tell.
_CHANCE = 2.0
# What 'much better' means where data are still missed: this share of what was too much.
_MUCH = 0.25
# Of how far the tolerances were leant on: what takes this share of it is what they had imitated.
_MOST = 0.5


class Foretelling(Protocol):
    """Anything that foretells data: a fit, or one with a thing that has no name."""

    @property
    def problem(self) -> Problem:
        """What it was made for."""
        ...

    @property
    def foretold(self) -> ComplexArray:
        """A/F (C, L), each held-out channel's own gain left open within its tolerance."""
        ...


class Taking(Protocol):
    """Anything that takes some of what was too much: a fit, or one with a thing that has no name."""

    @property
    def chi2_per_dof(self) -> float:
        """χ² per fitted real number."""
        ...

    @property
    def scores(self) -> NDArray[np.float64]:
        """All that is uncertain, in stated standard deviations."""
        ...


def confirmed_by_held_out(
    found: Fit, missed: float | None, current: Fit, before: Residual, thresholds: Thresholds
) -> bool:
    """Held-out data must be met better than before; where nothing is held out there is no name.

    ``found`` is the fit with the effect, ``missed`` its held-out χ² per degree of freedom, ``current`` the model
    without it and ``before`` what that leaves. Where held-out data are still missed, they must be met much better, or
    fitted data must, or the tolerances be leant on by less than half: a wrong effect often takes a little of what
    another one leaves, while of two true ones held-out data may miss little of the first.

    Two kinds of effect they cannot speak for, only against. Where the unknowns had imitated the effect, far out of
    their tolerances, the data were met already: the tolerances must then speak for the name by as much as a name
    needs. And what happens to a fitted channel alone no other record knows of.
    """
    if missed is None or before.held_out_chi2_per_dof is None:
        return False
    excess = before.held_out_chi2_per_dof - (before.held_out_noise_per_dof or 0.0)
    if missed > before.limits.held_out_per_dof and not (
        before.held_out_chi2_per_dof - missed >= _MUCH * excess or takes_enough(found, current, before)
    ):
        return False
    held = found.problem.split.held
    worth = _worth(found, held)
    nats = held_out_nats(found, found, current)
    if nats > _HELD_OUT_NATS:
        return True
    tolerances_nats = 0.5 * float(current.scores @ current.scores - found.scores @ found.scores)
    if tolerances_nats < thresholds.evidence_nats and worth * _felt(found) > _HELD_OUT_NATS:
        return False
    # Two predictions that differ by S in squared deviations are told apart by S ± sqrt(2 S) nats.
    between = worth * _square_sum(_of(found.problem, held, found.foretold - current.foretold))
    return nats > -max(_HELD_OUT_NATS, _CHANCE * math.sqrt(2 * between))


def takes_enough(found: Fit, current: Fit, before: Residual) -> bool:
    """Whether a fit meets its own data, or takes much of what was too much in ``current`` without it.

    One held-out channel can miss more than all the others: what it alone gains by is no explanation of them. Too much
    is also what the tolerances had to give: a gain that is wrong by thirty of its deviations leaves no misfit behind.
    Of several missing effects one may be all in what the data miss and another all in the tolerances: much of either
    will do.
    """
    if found.chi2_per_dof <= before.limits.chi2_per_dof or share_taken(found, current, before) >= _MUCH:
        return True
    missed = current.chi2_per_dof - before.noise_per_dof
    if missed > 0 and current.chi2_per_dof - found.chi2_per_dof >= _MUCH * missed:
        return True
    strained = before.strain_sd > before.limits.strain_sd
    return strained and strain_sd(found) <= (1 - _MOST) * before.strain_sd


def share_taken(found: Taking, current: Fit, before: Residual) -> float:
    """What a fit takes of what was too much in ``current`` without it: misfit beyond noise and bent tolerances.

    ``before`` is what ``current`` leaves. One where nothing was too much.
    """
    whole, scores, left = too_much(current, before), current.scores, found.scores
    taken = (current.chi2_per_dof - found.chi2_per_dof) * current.points + float(scores @ scores - left @ left)
    return taken / whole if whole > 0 else 1.0


def too_much(current: Fit, before: Residual) -> float:
    """What is too much of the cost of a fit that leaves ``before``: misfit beyond noise, and bent tolerances."""
    missed = (current.chi2_per_dof - before.noise_per_dof) * current.points
    # Scores that nothing bends have a square of one each at most.
    return missed + max(0.0, float(current.scores @ current.scores) - current.scores.size)


def shares_taken(found: Taking, current: Fit, left: float | None, before: Residual) -> tuple[float, float]:
    """What a fit takes of what was too much in ``current``: as in :func:`share_taken`, and of held-out data.

    ``before`` is what ``current`` leaves, ``left`` the held-out χ² per degree of freedom that the fit does. The second
    is 1 where held-out data are met, or none are held out.
    """
    fitted, was = share_taken(found, current, before), before.held_out_chi2_per_dof
    if left is None or was is None or left <= before.limits.held_out_per_dof:
        return fitted, 1.0
    excess = was - (before.held_out_noise_per_dof or 0.0)
    return fitted, (was - left) / excess if excess > 0 else 0.0


def held_out_nats(judge: Fit, found: Fit, without: Fit) -> float:
    """What held-out data say for ``found`` against ``without``, in nats, each value worth what it is to ``judge``."""
    return _nats(judge, found, without, found.problem.split.held)


def not_spoken_against(found: Foretelling, names: Fit) -> bool:
    """Whether held-out data do not prefer ``names`` to what is set against them, by more than chance fluctuation.

    Where nothing is held out nothing speaks.
    """
    held = names.problem.split.held
    if not held.any():
        return True
    between = _worth(names, held) * _square_sum(_of(names.problem, held, found.foretold - names.foretold))
    return _nats(names, found, names, held) > -max(_HELD_OUT_NATS, _CHANCE * math.sqrt(2 * between))


def preferred_by(winner: Fit, other: Fit) -> float:
    """By how many nats held-out data, or all where nothing is held out, prefer one fit to another.

    Each value is worth what it is to the one that misses less.
    """
    parts = winner.problem.split
    rows = parts.held if parts.held.any() else parts.train
    judge = min((winner, other), key=lambda f: _square_sum(_missed(f, rows)))
    return _nats(judge, winner, other, rows)


def _nats(judge: Fit, found: Foretelling, without: Foretelling, rows: Rows) -> float:
    return _worth(judge, rows) * (_square_sum(_missed(without, rows)) - _square_sum(_missed(found, rows)))


def _missed(found: Foretelling, rows: Rows) -> ComplexArray:
    """What a fit misses of some channels (C,)."""
    return _of(found.problem, rows, found.foretold - found.problem.measured.values)


def _of(problem: Problem, rows: Rows, change: ComplexArray) -> ComplexArray:
    """Some rows of changes (C, L) of A/F in standard deviations, what channels of a run share taken out."""
    return apart(problem.measured, rows, (change / problem.measured.sigma)[rows])


def _square_sum(standardised: ComplexArray) -> float:
    return float(np.sum(np.abs(standardised) ** 2))


def _worth(found: Fit, rows: Rows) -> float:
    """Independent values that one of some channels is worth: what a fit misses, and an error of form, are not noise."""
    rho = _missed(found, rows)
    worth = noise_share(found.problem.measured, rows).worth
    return min(1.0, independent_values(rho) / (2 * rho.size)) * worth


def _felt(found: Fit) -> float:
    """What the last effect, and nothing else, does to the held-out data, in squared standard deviations."""
    problem, last = found.problem, len(found.hypotheses[-1].parameters)
    rest = found.e[: found.e.size - last]
    try:
        without = anchor(problem, found.u, found.hypotheses[:-1], rest, slopes=False).predict(found.u, rest)
    except NoStructureError:
        return np.inf
    return _square_sum(_of(problem, problem.split.held, found.predicted - without))
