"""Hammer hits as forces in time: short pushes, a little different each time, and sometimes two for one."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

# A bounce comes back with about half of the speed.
_BOUNCE = 0.5


def impact_train(
    time_s: ArrayLike,
    generator: np.random.Generator,
    hits: int,
    block_s: float,
    first_s: float,
    contact_s: float,
    strength_scatter: float = 0.0,
    timing_scatter_s: float = 0.0,
    double_probability: float = 0.0,
    double_interval_s: float = 0.04,
) -> NDArray[np.float64]:
    """Pushes of unit peak, one in each of ``hits`` blocks, ``first_s`` after its start, shape of ``time_s``.

    Each lasts ``contact_s`` and rises and falls as a squared sine: half-sine-like as a hammer on a spring of a
    tip, but with a soft beginning and end. Strengths are normal with a standard deviation of
    ``strength_scatter`` (never below a tenth), times even within ``timing_scatter_s``. A double
    hit, half as strong, follows with some probability. Ewins, Modal Testing, 2nd ed., chapter 3.
    """
    time = np.asarray(time_s, dtype=float)
    strength = np.maximum(1 + strength_scatter * generator.standard_normal(hits), 0.1)
    start = np.arange(hits) * block_s + first_s + timing_scatter_s * generator.uniform(-1, 1, hits)
    double = generator.uniform(size=hits) < double_probability
    pushes = [*zip(start, strength, strict=True)]
    pushes += [(t + contact_s + double_interval_s, _BOUNCE * s) for t, s in pushes[:]]
    kept = np.concatenate([np.ones(hits, bool), double])
    force = np.zeros_like(time)
    for (begin, peak), keep in zip(pushes, kept, strict=True):
        inside = (time > begin) & (time < begin + contact_s) & bool(keep)
        force[inside] += peak * np.sin(np.pi * (time[inside] - begin) / contact_s) ** 2
    return force
