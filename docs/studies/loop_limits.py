"""How large an effect is against what gets a name: around its own aircraft, as a fit that is told the truth has it.

Sizes are drawn around the nominal aircraft, before anything is measured. A mode that tolerances move towards the edge
of the band shows half of an effect with it: what is above the limit there need not be above that of its own campaign.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from vgvt.effects import available_effects, parameters_of
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.next_test.power import power
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.candidates import candidates


def own_ratio(told: Fit, truth: dict[str, dict[str, Any]]) -> float | None:
    """The largest of an effect's sizes over what gets it a name; None for what has no size, or no such limit.

    Judged where the aircraft of a fit stands that is told the ``truth``, the effect taken away; None where it falls
    without it.
    """
    try:
        here = fit(told.problem, (), told.u, np.zeros(0), ())
    except NoStructureError:
        return None
    found: list[float] = []
    for name, said in truth.items():
        cls = available_effects()[name]
        sizes = {p.name for p in parameters_of(cls) if p.neutral is not None}
        one = candidates(told.problem, {name: cls})[0]
        fixed = Hypothesis(cls, {k: v for k, v in said.items() if k not in sizes}, one.share, places=one.places)
        limits = {p.parameter: p.named for p in power(here, [fixed])}
        found += [abs(said[s]) / limits[s] for s in sizes & said.keys() if np.isfinite(limits.get(s, np.nan))]
    return max(found, default=None)
