"""Where the unknowns go beside an effect that they make up for almost wholly: along with it, from no size on.

A tenth more inertia that the tolerance of the inertia takes back is a tenth of a tenth off by the slopes of both, and
that is more than peaks are wide: no step of a tangent finds back from there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.parameter import Parameter
from vgvt.reconcile.fitting.misfit import data_misfit, jacobian
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.stand import Stand

Array = NDArray[np.float64]
# Shares of the way, short ones first, and how many of those behind say where the next one begins.
_SHARES = tuple((k / 12) ** 1.5 for k in range(1, 13))
_BEHIND = 3
# Share of what is left by which it may be off.
_HOLDS = 0.1


def holds(stand: Stand, hypothesis: Hypothesis, values: dict[str, float], shown: Array) -> bool:
    """Whether the aircraft that the unknowns have got to leaves what is ``shown`` (2 N + scores,), once assembled."""
    null = stand.fit
    u, e = np.split(null.scores + shown[null.points :], [null.u.size])
    added = (*null.hypotheses, replace(hypothesis, settings={**hypothesis.settings, **values}))
    try:
        predicted = anchor(null.problem, u, added, e, slopes=False).predict(u, e)
    except NoStructureError:
        return True
    off = data_misfit(stand.back.fit.problem, predicted, null.sigma) - shown[: null.points]
    return bool(np.linalg.norm(off) < _HOLDS * np.linalg.norm(shown))


def shown_in_parts(
    stand: Stand, hypothesis: Hypothesis, values: dict[str, float], p: Parameter, most: float
) -> Array | None:
    """What :meth:`Stand.shown` tells of an effect's size ``p`` (2 N + scores,), structures assembled anew on the way.

    None where there is no such aircraft anywhere on it, or where a part of the size leaves a square sum of more than
    ``most``, which is to be undercut at the whole of it.
    """
    null, neutral = stand.fit, float(p.neutral or 0.0)
    shares, way, reached = [0.0], [null.scores], None
    for share in _SHARES:
        part = {**values, p.name: neutral + share * (values[p.name] - neutral)}
        added = (*null.hypotheses, replace(hypothesis, settings={**hypothesis.settings, **part}))
        if reached is None:
            first = stand.shown(hypothesis, part, {p.name: neutral})
            if first is None:
                return None
            start = null.scores + first[null.points :]
        else:
            start = _lagrange(np.array(shares[-_BEHIND:]), share) @ np.array(way[-_BEHIND:])
        u, e = np.split(start, [null.u.size])
        try:
            here = anchor(null.problem, u, added, e, rough=True)
            tangent = jacobian(here, u, e, here.predict(u, e), null.sigma)
        except NoStructureError:
            return None
        reached = stand.back.at(tangent, u).follow_on(here, start)
        # Once the way is lost, each part leads the next one farther off: to wings of no stiffness at all in the end.
        if reached is None or reached.cost > most:
            return None
        shares.append(share)
        way.append(reached.scores)
    return None if reached is None else np.concatenate([reached.misfit, reached.scores - null.scores])


def _lagrange(known: Array, at: float) -> Array:
    """Weights (n,) of what is ``known`` at n abscissae in the polynomial through them, at another."""
    apart = known[:, None] - known + np.eye(known.size)
    return np.asarray(((at - known + np.eye(known.size) * (1 - at + known)) / apart).prod(axis=1))
