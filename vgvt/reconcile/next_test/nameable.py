"""How large an effect has to be to get its name: what is just visible pays for its own freedom, and chance takes more.

Five standard deviations are 12.5 nats. From these a name pays for its parameters and for the variants that were tried
beside it; what remains must be more than an effect that is not there reaches.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from vgvt.effects.parameter import Parameter
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.candidates import freed

# Normal quantile of 95 %: chance leaves it its name in as many campaigns.
_DEVIATE = 1.645
_LEAST, _MOST = 0.2, 1e3
_SLIGHTLY = 1e-3
# A score beyond all that a fit can take.
_FAR = 1e6


def within_reach(hypothesis: Hypothesis, p: Parameter, change: float, sign: float = 1.0) -> float:
    """A change of a parameter from its neutral value as a fit can have it: no less than the least, infinite beyond all.

    A fit keeps values near what is plausible: what is smaller is fitted as the least there is.
    """
    index, neutral = [q.name for q in hypothesis.parameters].index(p.name), float(p.neutral or 0.0)
    far = _FAR * np.eye(len(hypothesis.parameters))[index]
    ends = sorted(sign * (hypothesis.values(side)[p.name] - neutral) for side in (-far, far))
    return math.inf if change > ends[1] else max(change, ends[0])


def nameable_ratio(
    hypothesis: Hypothesis,
    p: Parameter,
    smallest: float,
    *,
    deviations: float,
    raw: float,
    threshold_nats: float,
    power: int = 1,
) -> float:
    """How many times ``smallest`` gets an effect its name in 95 of 100 campaigns, by evidence on fitted data alone.

    ``smallest`` is a change of a parameter from its neutral value that moves data and tolerances by so many
    ``deviations``, which grow with its ``power``, and by ``raw`` ones where every line counts whole; a name needs
    ``threshold_nats``. What is fitted beside the size, a place as a rule, is taken to change all of the signature
    within its plausible range. Held-out data, and rivals, may ask for more. Infinite where a thousand times is not
    enough.
    """
    neutral = float(p.neutral or 0.0)
    free = freed(hypothesis)
    name, beside = p.name, len(free.parameters) - 1
    index = [q.name for q in hypothesis.parameters].index(name)

    def score(change: float) -> float:
        return float(hypothesis.scores({name: neutral + change})[index])

    def beyond(log_ratio: float) -> float:
        """Nats beyond what a name needs that are left where chance is bad."""
        ratio = math.exp(log_ratio)
        change, seen = smallest * ratio, deviations * ratio**power
        # Of the logarithm of the size, per score: what one deviation of the prior does to the data follows from it.
        stretch = 2 * _SLIGHTLY / (score(change * (1 + _SLIGHTLY)) - score(change * (1 - _SLIGHTLY)))
        told = raw * ratio**power
        freedom = 0.5 * math.log1p((power * told * stretch) ** 2) + 0.5 * beside * math.log1p(told**2)
        paid = freedom + 0.5 * score(change) ** 2 - math.log(free.share)
        return 0.5 * seen**2 - _DEVIATE * seen - paid - threshold_nats

    low, high = math.log(_LEAST), math.log(_MOST)
    if not math.isfinite(smallest) or beyond(high) < 0:
        return math.inf
    return math.exp(brentq(beyond, low, high, xtol=1e-3)) if beyond(low) < 0 else _LEAST
