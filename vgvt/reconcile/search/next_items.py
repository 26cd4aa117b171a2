"""Things at an item of the airframe: from where a fit arrived, the same effect at the items next to it.

A flap that swings on its hinge moves the same peaks as the flap beside it, and by most of the same. From afar the wrong
one may come nearest, and where it arrived another one is a few steps from its own bottom. What has a place can slide
there; an item is a setting.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from vgvt.reconcile.fitting.fit import FAR, Fit, fit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.scan import tuned_alike, where_it_swings
from vgvt.reconcile.work.progress import Progress, naming, part
from vgvt.reconcile.work.team import ALONE, Task, Team

# Of the best fit's gain, from which on a thing is worth a look beside it; how many are next to it; how far it may walk.
_AHEAD, _NEXT, _STEPS = 0.25, 4, 3


def at_next_items(
    current: Fit, found: Sequence[Fit], hypotheses: Sequence[Hypothesis], tell: Progress, team: Team = ALONE
) -> list[Fit]:
    """The best fit of a thing at an item, at the items next to that, and on from there while one of these does better.

    ``hypotheses`` are all variants; those that were fitted already are not fitted again.
    """
    things = [f for f in found if _is_thing(f.hypotheses[-1])]
    best = max(things, key=lambda f: f.evidence_nats, default=None)
    ahead = max((f.evidence_nats - current.evidence_nats for f in found), default=0.0)
    if best is None or best.evidence_nats - current.evidence_nats <= _AHEAD * ahead:
        return []
    own = best.hypotheses[-1].cls
    fitted = [f.hypotheses[-1].settings for f in things if f.hypotheses[-1].cls is own]
    more: list[Fit] = []
    for step in range(_STEPS):
        tries = [(h, start) for h, start in _next_to(best, hypotheses) if h.settings not in fitted][:_NEXT]
        fitted += [h.settings for h, _ in tries]
        tasks: list[Task] = [(_fitted_there, (best, h, start)) for h, start in tries]
        reached = [f for f in team.work_off(tasks, part(tell, step / _STEPS, (step + 1) / _STEPS)) if f is not None]
        more += reached
        ahead_of_all = max(reached, key=lambda f: f.evidence_nats, default=best)
        if ahead_of_all.evidence_nats <= best.evidence_nats:
            break
        best = ahead_of_all
    return more


def _is_thing(hypothesis: Hypothesis) -> bool:
    return hypothesis.linear and "item" in hypothesis.settings


def _next_to(found: Fit, hypotheses: Sequence[Hypothesis]) -> Iterator[tuple[Hypothesis, dict[str, float]]]:
    """Other variants of a fit's last effect, with values that swing as fast as what was fitted.

    The same item on the other side, or on both, which does most of the same, and then the nearest ones on its own side.
    """
    problem, own = found.problem, found.hypotheses[-1]
    values = {name: value[0] for name, value in found.values(len(found.hypotheses) - 1).items()}
    here = where_it_swings(problem, own)
    away: list[tuple[float, Hypothesis]] = []
    for h in hypotheses:
        there = where_it_swings(problem, h) if h.cls is own.cls and h.settings != own.settings else None
        if here is None or there is None:
            continue
        if h.settings["item"] == own.settings["item"]:
            away.append((0.0, h))
        elif h.settings.get("side") == own.settings.get("side"):
            away.append((float(np.hypot(*np.subtract(there, here))), h))
    for _, h in sorted(away, key=lambda a: a[0]):
        alike = tuned_alike(problem, own, values, h)
        if alike is not None:
            yield h, alike


def _fitted_there(found: Fit, hypothesis: Hypothesis, values: dict[str, float], tell: Progress) -> Fit | None:
    """The last effect of a fit in another variant, fitted from where that arrived; None where nothing hangs so."""
    before = found.e[: found.e.size - len(found.hypotheses[-1].parameters)]
    start = np.concatenate([before, hypothesis.scores(values)])
    joined = (*found.hypotheses[:-1], hypothesis)
    try:
        return fit(found.problem, joined, found.u, start, FAR, naming(tell, hypothesis))
    except NoStructureError:
        return None
