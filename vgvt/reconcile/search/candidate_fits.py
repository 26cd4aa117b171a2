"""Fits of a round's candidates: where each starts, which go on to the end, and what is done where one loses its way."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.evidence.plausible import PLACES
from vgvt.reconcile.fitting.fit import FAR, NEAR, Fit, cost_at, fit
from vgvt.reconcile.fitting.fit_unless_behind import HOPELESS, fit_unless_behind
from vgvt.reconcile.fitting.rough_start import rough_start
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.candidates import freed
from vgvt.reconcile.search.scan import BY_ITSELF_M
from vgvt.reconcile.search.screened import Screened, parted
from vgvt.reconcile.work.progress import Progress, naming
from vgvt.reconcile.work.team import ALONE, Team

FINALISTS = 4
"""As many as a far-off round fits to the end."""
# Share of its size at which an effect can only do a little harm.
_LITTLE = 0.125
# Worse by more than what a superfluous parameter costs in evidence.
_LOST = 10.0
# From where peaks overlap towards the bottom of what forgives as much as a far-off fit's first steps, and how near two
# of the same effect there are one.
_OVERLAPPING, _MET = ((0.6, 4), (FAR[0][0], 8)), 1.0
# What a fit begun anew is given before it is asked how far behind it is.
_FIRST = ((0.0, 6),)


def finalists(current: Fit, chosen: Sequence[Screened], tell: Progress, team: Team = ALONE) -> tuple[Screened, ...]:
    """Those of the short list that do best by a few steps that forgive misplaced peaks, at what these arrived at.

    And what was foremost without forgiveness, however it does by these.
    """
    reached = team.work_off([(_begun, (current, s)) for s in chosen], tell)
    found: list[tuple[float, Screened]] = []
    for s, there in zip(chosen, reached, strict=True):
        if there is not None:
            here = {k: v[0] for k, v in there.values(len(current.hypotheses)).items()}
            ahead = replace(s, values={**s.values, **here}, start=there.scores[: current.scores.size])
            found.append((there.evidence_nats, ahead))
    kept: list[tuple[float, Screened]] = []
    for nats, s in sorted(found, key=lambda f: -f[0]):
        twin = next((k for k, (n, o) in enumerate(kept) if n - nats < _MET and _met(s, o)), None)
        # Two starts of one effect that have met are one.
        if twin is None:
            kept.append((nats, s))
        elif s.foremost:
            kept[twin] = (kept[twin][0], replace(kept[twin][1], foremost=True))
    return tuple(s for k, (_, s) in enumerate(kept) if k < FINALISTS or s.foremost)


def _met(one: Screened, other: Screened) -> bool:
    """Whether two starts are those of one variant, and at one place if it has one."""
    at = [[s.values.get(name, 0.0) for pair in PLACES for name in pair] for s in (one, other)]
    return freed(one.hypothesis).same(freed(other.hypothesis)) and math.dist(*at) < BY_ITSELF_M


def _begun(current: Fit, s: Screened, tell: Progress) -> Fit | None:
    """A candidate after a few steps that forgive misplaced peaks; None where there is no such aircraft.

    From where it was screened, or from where peaks overlap where that does better: a stand whose unknowns are bent to
    imitate the effect that is now there is further from the truth than the stated values, and what is sharp and moves
    with an unknown is not met by steps from these alone.
    """
    hypothesis, u, start = _start(current, s)
    hypotheses, tell = (*current.hypotheses, hypothesis), naming(tell, hypothesis)
    found: list[Fit] = []
    coarse = ((False, FAR[:1]), (True, _OVERLAPPING))
    for overlapping, stages in ((False, ()),) if s.arrived else coarse:
        try:
            at, e = rough_start(current.problem, hypotheses, start) if overlapping else (u, start)
            found.append(fit(current.problem, hypotheses, at, e, stages, tell, judged=FAR[0][0]))
        except NoStructureError:
            continue
    return max(found, key=lambda f: f.evidence_nats, default=None)


def begun_anew(current: Fit, chosen: Sequence[Screened], best: float, tell: Progress, team: Team = ALONE) -> list[Fit]:
    """Candidates fitted from where peaks overlap, for a round in which all fits leave much: ``best`` is their least χ².

    Coarse steps forgive misplaced peaks, and not sharp ones: from far off these lead astray. What stays far behind
    is no candidate: near the stated values evidence would thank it for every tolerance that it keeps.
    """
    found = team.work_off([(_anew, (current, s, best)) for s in chosen], tell)
    return [f for f in found if f is not None and f.chi2 < HOPELESS * best]


def _anew(current: Fit, s: Screened, best: float, tell: Progress) -> Fit | None:
    """A candidate fitted from where peaks overlap; None where there is no such aircraft."""
    hypothesis, _, e = _start(current, s)
    hypotheses = (*current.hypotheses, hypothesis)
    try:
        u, e = rough_start(current.problem, hypotheses, e)
        return fit_unless_behind(current.problem, hypotheses, u, e, _FIRST, best, naming(tell, hypothesis))
    except NoStructureError:
        return None


def _start(current: Fit, s: Screened) -> tuple[Hypothesis, NDArray[np.float64], NDArray[np.float64]]:
    """A candidate with its place freed where it has one, and the scores u and e (of all effects) to start from."""
    hypothesis = freed(s.hypothesis)
    own = {k: float(v) for k, v in s.hypothesis.settings.items() if k in {p.name for p in hypothesis.parameters}}
    known = current.scores if s.start is None else s.start
    u, e = np.split(known, [current.u.size])
    return hypothesis, u, np.concatenate([e, hypothesis.scores({**own, **s.values})])


def fitted_from(current: Fit, s: Screened, stages: tuple[tuple[float, int], ...], tell: Progress) -> Fit | None:
    """A candidate fitted from where the screen left it, or with little of it from where the model without it is.

    The screen follows the unknowns along straight lines, which sharp resonances leave soon: the better start is taken.
    A model with one effect more can do as well as the one without: a fit that lost its way is done again from there.
    """
    hypothesis, u, start = _start(current, s)
    little = _start(current, replace(s, values=parted(s, _LITTLE), start=None))[1:]
    hypotheses, tell = (*current.hypotheses, hypothesis), naming(tell, hypothesis)
    stages = NEAR if s.arrived else stages
    if stages == NEAR:
        u, start = min((u, start), little, key=lambda where: cost_at(current.problem, hypotheses, *where))
    try:
        found = fit(current.problem, hypotheses, u, start, stages, tell)
    except NoStructureError:
        return None
    if found.evidence_nats < current.evidence_nats - _LOST and stages != NEAR:
        try:
            again = fit(current.problem, hypotheses, *little, NEAR, tell)
        except NoStructureError:
            return found
        return max(found, again, key=lambda f: f.evidence_nats)
    return found
