"""Joints whose stiffness depends on level, begun beside the linear effect that they resemble.

Where unknowns stand beside a soft root that was fitted from the stated values is near to where they stand beside a
joint that is as soft on the average. From there the joint's own stiffness is scanned, on which peaks hang and to which
no tangent leads; its size is left to the first steps of fits from several, and the best of these goes on with an
allowance that shrinks slowly.

What sticks in one run and slips in another is like no linear effect. Where none stands out, and runs are of several
levels or hold what no linear answer explains, joints are begun from the stated values, where steps must forgive more.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.fitting.fit import FORGIVING, Fit, cost_at, fit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.harmonics import answers_jaggedly
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.level_grid import several_levels
from vgvt.reconcile.search.from_stated import from_stated
from vgvt.reconcile.search.screened import Screened
from vgvt.reconcile.work.progress import Progress, naming, part
from vgvt.reconcile.work.team import ALONE, Task, Team

Array = NDArray[np.float64]
_Stages = tuple[tuple[float, int], ...]
GENTLY = ((0.3, 6), (0.1, 4), (0.03, 4), (0.0, 20))
"""For a start with peaks that overlap, and a size that may be anything."""
_FROM_STATED = (FORGIVING, ((0.03, 4), (0.0, 30)))
"""For one from the stated values: while its size is looked for, and afterwards."""
# What starts leave per value, of what data are judged by, where they have not met them.
_MISSED = 1.5
# Shares of a plausible range: of what says how big an effect is, of the rest, and of the rest around the best of these.
_SIZES, _OTHERS = (0.2, 0.5, 0.8), tuple(np.linspace(0.1, 0.95, 18).tolist())
_BETWEEN = tuple(np.linspace(-0.04, 0.04, 9).tolist())


def beside_likeness(
    current: Fit, joints: Sequence[Hypothesis], linear: Sequence[Hypothesis], tell: Progress, team: Team = ALONE
) -> tuple[Screened, ...]:
    """Starts of ``joints``, one of each effect, beside the best of ``linear`` effects that these could be taken for.

    Only variants of its side are looked at; where none of these meets the data, also from where the fit of that effect
    began. Where no such effect stands out from the stated values, or none of its side is asked for, all are, from
    there, if runs are of several levels or show by themselves that something is not linear; else nothing.
    """
    alike = {name for h in joints for name in _alike(h)}
    found = from_stated(current, [h for h in linear if h.linear and h.name in alike], part(tell, 0.0, 0.3), team)
    near = _fitted(current, found[0], GENTLY, part(tell, 0.3, 0.4)) if found else None
    starts: list[Screened] = []
    if near is not None:
        chosen, side = near.hypotheses[-1].name, near.hypotheses[-1].settings.get("side")
        looked = [h for h in joints if chosen in _alike(h) and h.settings.get("side") == side]
        gently, before = (GENTLY[:1], GENTLY[1:]), found[0].start
        starts += _started(current, near.scores[: current.scores.size], looked, gently, part(tell, 0.4, 0.6), team)
        # A fit that went down to its bottom may have bent the unknowns to where no joint beside them leads back from.
        if starts and before is not None and min(s.remaining for s in starts) > _MISSED * current.points:
            starts += _started(current, before, looked, gently, part(tell, 0.6, 0.8), team)
    if not starts and (several_levels(current.problem) or answers_jaggedly(current.problem.measured.harmonics)):
        stated = np.concatenate([np.zeros(current.u.size), current.e])
        starts += _started(current, stated, joints, _FROM_STATED, part(tell, 0.8, 1.0), team)
    best: dict[str, Screened] = {}
    for s in sorted(starts, key=lambda s: s.remaining):
        best.setdefault(s.hypothesis.name, s)
    return tuple(best.values())


def _started(
    current: Fit,
    scores: Array,
    looked: Sequence[Hypothesis],
    stages: tuple[_Stages, _Stages],
    tell: Progress,
    team: Team,
) -> list[Screened]:
    """One start of each effect among the joints that are ``looked`` at, from unknowns at ``scores``."""
    names = dict.fromkeys(h.name for h in looked)
    tasks: list[Task] = [(_begun, (current, scores, [h for h in looked if h.name == n], stages)) for n in names]
    return [s for s in team.work_off(tasks, tell) if s is not None]


def _begun(
    current: Fit, scores: Array, variants: Sequence[Hypothesis], stages: tuple[_Stages, _Stages], tell: Progress
) -> Screened | None:
    """The best of one joint's variants from unknowns at ``scores``, fitted by two stages; None where none is possible.

    Of several sizes the first stage says which one goes on.
    """
    there = _softest(current, scores, variants, part(tell, 0.0, 0.4))
    ends = np.linspace(0.4, 0.7, len(there) + 1)
    fits = [_fitted(current, s, stages[0], part(tell, float(ends[n]), float(ends[n + 1]))) for n, s in enumerate(there)]
    reached = max((f for f in fits if f is not None), key=lambda f: f.evidence_nats, default=None)
    ended = None if reached is None else _fitted(current, _at(current, reached), stages[1], part(tell, 0.7, 1.0))
    return None if ended is None else _at(current, ended)


def _alike(hypothesis: Hypothesis) -> tuple[str, ...]:
    """Names that an effect could be taken for."""
    names: tuple[str, ...] = hypothesis.cls.confused_with  # type: ignore[attr-defined]
    return names


def _softest(current: Fit, scores: Array, variants: Sequence[Hypothesis], tell: Progress) -> list[Screened]:
    """The best of some variants with unknowns at ``scores`` (scores,), its stiffness scanned: one of each size."""
    scanned: list[tuple[float, Hypothesis, dict[str, float]]] = []
    for k, hypothesis in enumerate(variants):
        tell(0.8 * k / len(variants), f"{hypothesis.name} beside its likeness")
        scanned += [_costing(current, scores, hypothesis, shares) for shares in _grid(hypothesis)]
    _, hypothesis, shares = min(scanned, key=lambda s: s[0])
    tell(0.8, f"{hypothesis.name} beside its likeness")
    rest = [p.name for p in hypothesis.parameters if p.neutral is None]
    around = itertools.product(*([shares[name] + d for d in _BETWEEN] for name in rest))
    nearer = [{**shares, **dict(zip(rest, values, strict=True))} for values in around]
    _, _, shares = min((_costing(current, scores, hypothesis, s) for s in nearer), key=lambda s: s[0])
    sizes = [p.name for p in hypothesis.parameters if p.neutral is not None]
    return [
        Screened(hypothesis, _values(hypothesis, {**shares, **dict.fromkeys(sizes, size)}), 0.0, start=scores)
        for size in _SIZES
    ]


def _grid(hypothesis: Hypothesis) -> list[dict[str, float]]:
    """Shares of the ranges of an effect's parameters to try, by name."""
    choices = [[(p.name, share) for share in (_OTHERS if p.neutral is None else _SIZES)] for p in hypothesis.parameters]
    return [dict(shares) for shares in itertools.product(*choices)]


def _values(hypothesis: Hypothesis, shares: dict[str, float]) -> dict[str, float]:
    return {p.name: p.at(shares[p.name]) for p in hypothesis.parameters}


def _costing(
    current: Fit, scores: Array, hypothesis: Hypothesis, shares: dict[str, float]
) -> tuple[float, Hypothesis, dict[str, float]]:
    """What a fit lowers, where nothing is fitted."""
    u, known = np.split(scores, [current.u.size])
    e = np.concatenate([known, hypothesis.scores(_values(hypothesis, shares))])
    return cost_at(current.problem, (*current.hypotheses, hypothesis), u, e), hypothesis, shares


def _at(current: Fit, found: Fit) -> Screened:
    """Where a fit of ``current``'s model and one effect more has arrived, to be gone on from."""
    values = {name: value[0] for name, value in found.values(len(current.hypotheses)).items()}
    start = found.scores[: current.scores.size]
    return Screened(found.hypotheses[-1], values, 0.5 * current.chi2, remaining=found.chi2, start=start, arrived=True)


def _fitted(current: Fit, s: Screened, stages: tuple[tuple[float, int], ...], tell: Progress) -> Fit | None:
    """A fit from a start; None where there is no such aircraft."""
    assert s.start is not None
    u, known = np.split(s.start, [current.u.size])
    e, hypotheses = np.concatenate([known, s.hypothesis.scores(s.values)]), (*current.hypotheses, s.hypothesis)
    try:
        return fit(current.problem, hypotheses, u, e, stages, naming(tell, s.hypothesis), judged=stages[-1][0])
    except NoStructureError:
        return None
