"""Changes between runs whose courses differ in what is held out alone: fitted data cannot tell them apart.

A shaker remounted before the third run or before the fourth is the same to a fit that does not see the third, and so is
a gain to one that does not see its channel there: which of them it tried says nothing, and what was held out must not
refuse the effect for it. Each course has paid for being one of many
(:attr:`~vgvt.reconcile.question.hypothesis.Hypothesis.share`), so that held-out data may choose.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError, PluginError
from vgvt.effects.acting import action_of
from vgvt.effects.action import Action, ChannelFilter
from vgvt.effects.parameter import parameters_of
from vgvt.reconcile.fitting.fit import NEAR, Fit, cost_at, fit
from vgvt.reconcile.fitting.foretold import held_out_chi2
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.work.progress import Progress, naming
from vgvt.reconcile.work.team import ALONE, Team

Array = NDArray[np.float64]
_COURSE = ("from_run", "shape")
# Of the best fit's gain, from which on a change is worth other courses, and how many are fitted.
_AHEAD, _TRIED = 0.25, 2


def best_course(found: Fit, hypotheses: Sequence[Hypothesis]) -> Fit:
    """The fit with that course of its last effect that meets held-out data best, of those that are one where fitted.

    ``hypotheses`` are all variants; the fit itself where its effect has no course, or where every other one differs.
    """
    problem, own = found.problem, found.hypotheses[-1]
    if not problem.split.held.any() or not set(_COURSE) & set(own.settings):
        return found
    scores = found.e[found.e.size - len(own.parameters) :]
    here, best, least = _done(problem, own, scores), found.hypotheses, found.held_out_chi2_per_dof or 0.0
    for there in _other_courses(problem, hypotheses, own):
        if not _alike(problem, here, _done(problem, there, scores)):
            continue
        joined = (*found.hypotheses[:-1], there)
        try:
            predicted = anchor(problem, found.u, joined, found.e, slopes=False).predict(found.u, found.e)
        except NoStructureError:
            continue
        missed = held_out_chi2(problem, predicted) or 0.0
        if missed < least:
            best, least = joined, missed
    if best is found.hypotheses:
        return found
    # Judged anew: sensors rove with the runs of a group, so that what is fitted is the same to a few digits only.
    again = fit(problem, best, found.u, found.e, (), origin=found.origin, follow=found.followed)
    return replace(again, converged=found.converged)


def in_other_courses(
    current: Fit, found: Sequence[Fit], hypotheses: Sequence[Hypothesis], tell: Progress, team: Team = ALONE
) -> list[Fit]:
    """The best fit of a change between runs, from where it arrived in the other courses that do best there.

    A screen from where unknowns are bent knows which effect it is sooner than when it happened. A course that is one
    with a fitted one where fitted is left to :func:`best_course`.
    """
    changes = [f for f in found if set(_COURSE) & set(f.hypotheses[-1].settings)]
    best = max(changes, key=lambda f: f.evidence_nats, default=None)
    ahead = max((f.evidence_nats - current.evidence_nats for f in found), default=0.0)
    if best is None or best.evidence_nats - current.evidence_nats <= _AHEAD * ahead:
        return []
    problem, own = best.problem, best.hypotheses[-1]
    scores = best.e[best.e.size - len(own.parameters) :]
    # With a size more, or one less, it is another thing to begin with.
    fitted = [f.hypotheses[-1] for f in changes if _sized_alike(f.hypotheses[-1], own)]
    done = [_done(problem, h, scores) for h in fitted]
    others = [
        h for h in _other_courses(problem, hypotheses, own)
        if not any(_alike(problem, there, _done(problem, h, scores)) for there in done)
    ]  # fmt: skip
    joined = [(*best.hypotheses[:-1], h) for h in others]
    costs = [(cost_at(problem, j, best.u, best.e), j) for j in joined]
    nearest = [j for cost, j in sorted(costs, key=lambda c: c[0])[:_TRIED] if np.isfinite(cost)]
    fits = team.work_off([(_fitted_in, (best, j)) for j in nearest], tell)
    return [f for f in fits if f is not None]


def _fitted_in(found: Fit, hypotheses: tuple[Hypothesis, ...], tell: Progress) -> Fit | None:
    """Hypotheses fitted from where another fit of as many parameters arrived; None where there is no such aircraft."""
    try:
        return fit(found.problem, hypotheses, found.u, found.e, NEAR, naming(tell, hypotheses[-1]))
    except NoStructureError:
        return None


def _other_courses(problem: Problem, hypotheses: Sequence[Hypothesis], own: Hypothesis) -> list[Hypothesis]:
    """A hypothesis with each other course that variants differ in from it alone; what is fitted of it is no setting.

    Those that begin at some run stand for every other run too: of many not all are variants.
    """
    found: dict[str, Hypothesis] = {}
    rest = {k: v for k, v in own.settings.items() if k not in _COURSE}
    # A size that was left out is a setting of this one alone.
    chosen = rest.keys() - {p.name for p in parameters_of(own.cls) if p.neutral is not None}
    for h in hypotheses:
        if h.cls is not own.cls or any(h.settings.get(k) != rest[k] for k in chosen):
            continue
        course = {k: v for k, v in h.settings.items() if k in _COURSE}
        runs = range(2, len(problem.measured.runs) + 1) if "from_run" in course else ()
        for settings in ({**rest, **course, **({"from_run": run} if runs else {})} for run in runs or (None,)):
            if settings != own.settings:
                found[repr(sorted(settings.items()))] = replace(own, settings=settings)
    return list(found.values())


def _sized_alike(one: Hypothesis, other: Hypothesis) -> bool:
    """Whether two variants of one effect have the same parameters to fit."""
    return one.cls is other.cls and [p.name for p in one.parameters] == [p.name for p in other.parameters]


def _done(problem: Problem, hypothesis: Hypothesis, scores: Array) -> tuple[Action, ...] | None:
    """What an effect does to every run of which a channel is fitted; None where it refuses its values."""
    effect = hypothesis.effect(hypothesis.values(scores))
    try:
        runs = sorted(_fitted(problem))
        return None if effect is None else tuple(action_of(effect, problem.scenario, run) for run in runs)
    except (InputError, ValueError):
        return None


def _fitted(problem: Problem) -> dict[int, set[str]]:
    """Labels of the points whose channels are fitted, of every run that has any."""
    found: dict[int, set[str]] = {}
    for channel, train in zip(problem.measured.channels, problem.split.train, strict=True):
        if train:
            found.setdefault(channel.run, set()).add(str(channel.dof))
    return found


def _alike(problem: Problem, one: tuple[Action, ...] | None, other: tuple[Action, ...] | None) -> bool:
    """Whether two courses do the same to what is fitted."""
    if one is None or other is None:
        return False
    frequency, fitted = problem.measured.frequency_hz, _fitted(problem)
    measured = {str(channel.dof) for channel in problem.measured.channels}

    def filters(action: Action, run: int) -> list[tuple[str, bytes]]:
        unseen = measured - fitted[run]
        linear = [c for c in action.channels if isinstance(c, ChannelFilter) and c.channels not in unseen]
        return [(c.channels, np.asarray(c.response(frequency)).tobytes()) for c in linear]

    same = zip(one, other, sorted(fitted), strict=True)
    try:
        return all(a.same_rig(b) and filters(a, run) == filters(b, run) for a, b, run in same)
    except PluginError:  # whoever asks what it does there is told
        return False
