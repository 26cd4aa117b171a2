"""Nameless things sought where nothing has a name, or names leave something: each place is a task of its own.

The way down to a thing is as long as a fit's, and there are several places, models without it and starts. Who helps
takes a place; where nobody does, what comes later is only sought where what came before is not enough.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from typing import NamedTuple

from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.beside_nameless import Array, places_beside, starts_beside
from vgvt.reconcile.evidence.nameless import Nameless, with_nameless
from vgvt.reconcile.evidence.still_explained import StillExplained
from vgvt.reconcile.evidence.strain import strain_sd
from vgvt.reconcile.fitting.fit import FAR, FORGIVING, Fit
from vgvt.reconcile.fitting.rough_start import rough_start
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.thresholds import Limits
from vgvt.reconcile.work.progress import Progress
from vgvt.reconcile.work.team import Task, Team

Stages = tuple[tuple[float, int], ...]
Scores = tuple[Array, Array]
# Stages for a start that the calibration has bent towards what is missing.
_BENT = FAR[:-1]
# Bottoms whose costs are as near as this are one.
_SAME = 2.0


class Without(NamedTuple):
    """A model without the thing: names that are ``kept``, by index, and the fit of these ``alone``."""

    kept: tuple[int, ...]
    alone: Fit


def sought(
    asked: Attribution, models: Iterable[Without], worthless: float, team: Team, tell: Progress
) -> Iterator[tuple[Without, Nameless | None]]:
    """The nameless thing that does best beside each of some models, however far its start is, in their order.

    A fit is given up that promises no cost below a ``worthless`` one. Where nothing has a name the tolerances are bent
    as far as they could be: where a thing does not meet the data from there, misplaced peaks are forgiven first, and
    then the stated values are begun from. Where nobody helps, a model is asked for when it is its turn.
    """
    shared = [models] if team.workers > 1 else ([model] for model in models)
    for at_once in map(list, shared):
        tasks = [_tasks(asked, model, worthless) for model in at_once]
        found = iter(team.work_off([task for own in tasks for task in own], tell))
        for model, own in zip(at_once, tasks, strict=True):
            there = [n for n in islice(found, len(own)) if n is not None]
            yield model, max(there, key=lambda n: n.evidence_nats, default=None)


def met(there: Nameless, most: Limits) -> bool:
    """Whether it leaves no more than campaigns leave in which nothing is missing, of data and of tolerances."""
    return most.met_by(there.chi2_per_dof, there.held_out_chi2_per_dof) and strain_sd(there) <= most.strain_sd


def _tasks(asked: Attribution, model: Without, worthless: float) -> list[Task]:
    """A task for each place at which a thing beside a model may be."""
    starts = tuple(starts_beside(asked.final, model.kept, model.alone))
    # What is known of two bends the tolerances no more.
    bent, most = not model.kept, asked.null_residual.limits
    places = places_beside(asked.final, model.alone)
    return [(_lowest, (model.alone, where, starts, bent, worthless, most)) for where in places]


def _lowest(
    alone: Fit, where: StillExplained, starts: Sequence[Scores], bent: bool, worthless: float, most: Limits,
    tell: Progress,
) -> Nameless | None:  # fmt: skip
    """The thing at a place that does best, from one start after the other until one meets the data, or is known."""
    best: Nameless | None = None
    seen: list[float] = []
    for k, (u, e, stages) in enumerate(_begun(alone, starts, bent)):
        tell(k / (len(starts) + 2), f"one nameless thing, {where.words}")
        there = with_nameless(alone.problem, alone.hypotheses, u, e, where, worthless, stages)
        if there is None:
            continue
        if best is None or there.evidence_nats > best.evidence_nats:
            best = there
        if met(there, most) or any(abs(there.cost - cost) < _SAME for cost in seen):
            break
        seen.append(there.cost)
    return best


def _begun(alone: Fit, starts: Sequence[Scores], bent: bool) -> Iterator[tuple[Array, Array, Stages]]:
    """Scores u and e to begin from, and the stages that come first, those that nearly always do before the others."""
    for u, e in starts:
        yield u, e, ()
    if not bent:
        return
    yield alone.u, alone.e, _BENT
    try:
        begun = rough_start(alone.problem, alone.hypotheses, alone.e)
    except NoStructureError:
        return
    yield *begun, FORGIVING
