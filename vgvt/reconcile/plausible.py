"""Could there be such a thing? A name whose place or resonance lies beyond what its effect plausibly has is none.

Data outweigh any prior: where the right effect is not in the catalogue, another one is bent until it does the same. A
gram half a metre behind the aircraft is an inertia, an absorber far above the band a mass.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from vgvt.effects.parameter import Parameter
from vgvt.reconcile.posterior import honest

if TYPE_CHECKING:
    from vgvt.reconcile.fit import Fit
    from vgvt.reconcile.rivals import Rival

# The plausible range is two standard deviations of the prior; beyond it by one more, and surely beyond it.
_RANGE, _BEYOND, _SURE = 2.0, 3.0, 2.0


def implausible(fit: Fit, index: int = -1) -> tuple[str, ...]:
    """What of a hypothesis of a fit lies surely beyond its plausible range, in words; empty where nothing does.

    How large an effect is, is for the data to say: sizes, which have a neutral value, are not asked; nor are angles
    all round, which come back to where they were.
    """
    index %= len(fit.hypotheses)
    parameters = fit.hypotheses[index].parameters
    start = fit.u.size + sum(len(h.parameters) for h in fit.hypotheses[:index])
    scores = np.abs(fit.scores[start : start + len(parameters)])
    asked = [k for k, p in enumerate(parameters) if p.neutral is None and not _all_round(p) and scores[k] > _BEYOND]
    if not asked:
        return ()
    known = honest(fit)
    sd = np.sqrt(np.diag(known.covariance)[start : start + len(parameters)])
    values = known.values(index)
    return tuple(
        _words(parameters[k], values[parameters[k].name][0]) for k in asked if scores[k] - _SURE * sd[k] > _RANGE
    )


def likelier(confirmed: Sequence[Rival], within_nats: float) -> list[Rival]:
    """Rivals without those that are no plausible thing, where a plausible one is within reach of the best of all."""
    kept = [r for r in confirmed if not implausible(r.fit)]
    best = max((r.gain_nats for r in confirmed), default=0.0)
    return kept if any(r.gain_nats > best - within_nats for r in kept) else list(confirmed)


def _all_round(p: Parameter) -> bool:
    return p.unit == "rad" and p.high - p.low >= 2 * math.pi


def _words(p: Parameter, value: float) -> str:
    unit = f" {p.unit}" if p.unit else ""
    return f"{p.name} of {value:.3g}{unit}, where {p.low:g} to {p.high:g}{unit} is plausible"
