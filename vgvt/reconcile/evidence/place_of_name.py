"""Where a name sits, as a place for a thing of any law: what is there may be no such thing as it is called.

A relative of what no catalogue has is bent to do at one place what that does, and another relative takes the rest. Who
fitted the first one found the place, which need be no sensor's.
"""

from __future__ import annotations

import numpy as np

from vgvt.reconcile.evidence.free_places import label_at
from vgvt.reconcile.evidence.plausible import PLACES
from vgvt.reconcile.evidence.still_explained import StillExplained
from vgvt.reconcile.fitting.fit import Fit

_AT = PLACES[0]


def place_of_name(found: Fit, index: int, beside: StillExplained) -> StillExplained | None:
    """The place of a hypothesis of a fit, for a law in every run; None of what is at none, or begins with a run.

    It costs as many places as its prior holds that are as sharp, times those that every campaign is asked for, of which
    the one ``beside`` knows.
    """
    hypothesis = found.hypotheses[index]
    values = {**hypothesis.settings, **{name: value for name, (value, _, _) in found.values(index).items()}}
    if not values.keys() >= set(_AT) or "from_run" in hypothesis.settings:
        return None
    x_m, y_m = (float(values[axis]) for axis in _AT)
    runs = len(found.problem.measured.runs)
    asked = max(beside.asked, round(beside.asked * _as_sharp(found, index)))
    course = (1.0,) * runs
    return StillExplained(label_at(x_m, y_m), "structure", 0.0, course=course, asked=asked, point_m=(x_m, y_m))


def _as_sharp(found: Fit, index: int) -> float:
    """How many places told as sharply as that of a hypothesis its prior holds; 1 where that is no parameter of it."""
    before = found.u.size + sum(len(h.parameters) for h in found.hypotheses[:index])
    free = [k for k, p in enumerate(found.hypotheses[index].parameters) if p.name in _AT]
    sd = np.sqrt(np.diag(found.covariance)[[before + k for k in free]])
    return float(np.prod(1 / np.minimum(sd, 1.0)))
