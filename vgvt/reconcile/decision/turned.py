"""Another hold-out, where the first one is what is missed: a fault that only held-out data show is in no fit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.evidence.residual import Residual
from vgvt.reconcile.question.holdout import split
from vgvt.reconcile.question.problem import Problem

# So much more than what held-out data may leave in all, a channel of theirs is missed.
_MISSED = 1.5
_DRAWS = 40


def turned(found: Attribution) -> Problem | None:
    """The problem with the channels to fit that were missed while they were held out; None where that is not the case.

    A loose cable on a held-out channel, a change before a held-out run: the fit meets its own data, and no candidate
    has any to fit. Of further hold-outs, drawn as the first one was, the first that leaves most of them to the fit.
    """
    after, problem = found.final_residual, found.final.problem
    if not _missed_alone(after):
        return None
    missed = missed_channels(found)
    weight = np.where(missed, _each(after), 0.0)
    draws = [split(problem.scenario, problem.measured, turn) for turn in range(1, _DRAWS + 1)]
    chosen = min(draws, key=lambda draw: float(weight[draw.held].sum()))
    return replace(problem, split=chosen) if chosen.held.any() and (missed & chosen.train).any() else None


def counts_instead(found: Attribution, again: Attribution) -> bool:
    """Whether what another hold-out says counts instead of the first: a name where there was none, or data met by it.

    Both are asked for what keeps its name (:func:`~vgvt.reconcile.decision.leads.as_leads`): a name that the turn
    would lose is none to go by.
    """
    return bool(again.rounds) and (not found.rounds or again.final_residual.adequate)


def missed_channels(found: Attribution) -> NDArray[np.bool_]:
    """Which held-out channels, (C,), the final model misses by more than held-out data may be missed by."""
    after = found.final_residual
    return found.final.problem.split.held & (_each(after) > _MISSED * after.limits.held_out_per_dof)


def words_of_turn(first: Attribution, again: Problem) -> str:
    """Why the verdict rests on another hold-out than the first one."""
    labels = np.array(first.final_residual.labels)
    missed = ", ".join(labels[missed_channels(first)])
    held = ", ".join(labels[again.split.held])
    return (
        f"Of the data held out at first {missed} were missed, while the fit met its own: judged again with them among "
        f"what is fitted, and {held} held out"
    )


def _missed_alone(after: Residual) -> bool:
    """Whether held-out data are missed, and they alone."""
    met = after.train_chi2_per_dof <= after.limits.chi2_per_dof and after.smooth_per_dof <= after.limits.smooth_per_dof
    return met and (after.held_out_chi2_per_dof or 0.0) > after.limits.held_out_per_dof


def _each(after: Residual) -> NDArray[np.float64]:
    """χ² per degree of freedom of every channel, (C,)."""
    return np.asarray(np.mean(np.abs(after.standardised) ** 2, axis=1))
