"""Things at an item of the airframe: from where a fit arrived, the same effect at the items next to it.

A flap that swings on its hinge moves the same peaks as the flap beside it, and by most of the same. From afar the wrong
one may come nearest, and where it arrived another one is a few steps from its own bottom. What has a place can slide
there; an item is a setting.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from vgvt.reconcile.fitting.fit import FAR, Fit, cost_at, fit
from vgvt.reconcile.fitting.rough_start import rough_start
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.scan import BY_ITSELF_M, tuned_alike, where_it_swings
from vgvt.reconcile.work.progress import Progress, naming, part
from vgvt.reconcile.work.team import ALONE, Task, Team

# Of the best fit's gain, from which on a thing is worth a look beside it; how many are next to it; how far it may walk.
_AHEAD, _NEXT, _STEPS = 0.25, 4, 3


def at_next_items(
    current: Fit,
    found: Sequence[Fit],
    hypotheses: Sequence[Hypothesis],
    tell: Progress,
    team: Team = ALONE,
    *,
    placed: bool = False,
) -> list[Fit]:
    """The best fit of a thing at an item, at the items next to that, and on from there while one of these does better.

    Where ``placed`` asks for it, what swings at a place of its own is tried at the items there. ``hypotheses`` are all
    variants; those that were fitted already are not fitted again.
    """
    ahead = max((f.evidence_nats - current.evidence_nats for f in found), default=0.0)
    fitted = [(f.hypotheses[-1].cls, f.hypotheses[-1].settings) for f in found]
    more: list[Fit] = []
    walks = [_is_thing, _swings_at_a_place] if placed else [_is_thing]
    for k, begins in enumerate(walks):
        best = max((f for f in found if begins(f)), key=lambda f: f.evidence_nats, default=None)
        if best is not None and best.evidence_nats - current.evidence_nats > _AHEAD * ahead:
            more += _walked(best, hypotheses, fitted, part(tell, k / len(walks), (k + 1) / len(walks)), team)
    return more


def _walked(
    best: Fit,
    hypotheses: Sequence[Hypothesis],
    fitted: list[tuple[type, Mapping[str, Any]]],
    tell: Progress,
    team: Team,
) -> list[Fit]:
    """Fits at the items next to one, and on from there while one does better; all become ``fitted``."""
    more: list[Fit] = []
    for step in range(_STEPS):
        tries = [(h, start) for h, start in _next_to(best, hypotheses) if (h.cls, h.settings) not in fitted][:_NEXT]
        fitted += [(h.cls, h.settings) for h, _ in tries]
        tasks: list[Task] = [(_fitted_there, (best, h, start)) for h, start in tries]
        reached = [f for f in team.work_off(tasks, part(tell, step / _STEPS, (step + 1) / _STEPS)) if f is not None]
        more += reached
        ahead_of_all = max(reached, key=lambda f: f.evidence_nats, default=best)
        if ahead_of_all.evidence_nats <= best.evidence_nats:
            break
        best = ahead_of_all
    return more


def _is_thing(found: Fit) -> bool:
    return _at_an_item(found.hypotheses[-1])


def _at_an_item(hypothesis: Hypothesis) -> bool:
    return hypothesis.linear and "item" in hypothesis.settings


def _swings_at_a_place(found: Fit) -> bool:
    """Whether a fit's last effect is something that swings where it says itself."""
    own = found.hypotheses[-1]
    places = {"x_m", "y_m"} & ({*own.settings} | {p.name for p in own.parameters})
    return own.linear and bool(places) and bool(where_it_swings(found.problem, own))


def _next_to(found: Fit, hypotheses: Sequence[Hypothesis]) -> Iterator[tuple[Hypothesis, dict[str, float]]]:
    """Other variants of a fit's last effect, with values that swing as fast as what was fitted.

    The same item on the other side, or on both, which does most of the same, and then the nearest ones on its own side.
    Of what has a place of its own: things at the items nearest to it.
    """
    problem, own = found.problem, found.hypotheses[-1]
    values = {name: value[0] for name, value in found.values(len(found.hypotheses) - 1).items()}
    here = where_it_swings(problem, own, values)
    away: list[tuple[float, Hypothesis]] = []
    for h in hypotheses if here else ():
        if not _at_an_item(own):
            there = where_it_swings(problem, h) if _at_an_item(h) else ()
            nearest = min((_apart(here[0], place) for place in there), default=BY_ITSELF_M)
            away += [(nearest, h)] if nearest < BY_ITSELF_M else []
        elif h.cls is own.cls and h.settings != own.settings and (there := where_it_swings(problem, h)):
            if h.settings["item"] == own.settings["item"]:
                away.append((0.0, h))
            elif h.settings.get("side") == own.settings.get("side"):
                away.append((_apart(here[0], there[0]), h))
    for _, h in sorted(away, key=lambda a: a[0]):
        alike = tuned_alike(problem, own, values, h)
        if alike is not None:
            yield h, alike


def _apart(one: tuple[float, float], other: tuple[float, float]) -> float:
    """How far two places (x, y) are from each other, in metres."""
    return float(np.hypot(one[0] - other[0], one[1] - other[1]))


def _fitted_there(found: Fit, hypothesis: Hypothesis, values: dict[str, float], tell: Progress) -> Fit | None:
    """The last effect of a fit in another variant, fitted from where that arrived; None where nothing hangs so.

    Another effect begins where peaks overlap, if that is nearer: unknowns that made up for what an absorber is not are
    far from where they belong beside a flap.
    """
    before = found.e[: found.e.size - len(found.hypotheses[-1].parameters)]
    start = np.concatenate([before, hypothesis.scores(values)])
    joined = (*found.hypotheses[:-1], hypothesis)
    try:
        starts = [(found.u, start)]
        if hypothesis.cls is not found.hypotheses[-1].cls:
            starts.append(rough_start(found.problem, joined, start))
        u, e = min(starts, key=lambda where: cost_at(found.problem, joined, *where))
        return fit(found.problem, joined, u, e, FAR, naming(tell, hypothesis))
    except NoStructureError:
        return None
