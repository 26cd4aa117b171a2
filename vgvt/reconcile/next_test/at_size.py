"""The size at which an effect shows by so many deviations: foretold by a slope, and looked at where that says it is.

A slope says nothing of what is there at any size: a joint that goes with the effect, or one whose answer hangs on the
level and not on the size. So no size is told that does not keep its promise when the effect has it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.parameter import Parameter
from vgvt.reconcile.evidence.lasting import Imitated
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.in_parts import holds, shown_in_parts
from vgvt.reconcile.search.stand import Stand

Array = NDArray[np.float64]
Views = tuple[tuple[float, float], ...]

# Deviations are those that were asked for, to a tenth.
_KEPT = math.log(1.1)
_LOOKS, _FARTHEST = 10, 10.0
# Times what is left of a change that the unknowns make up for: beyond, slopes of either err by as much as is left.
_MADE_UP = 300.0
# Between two sizes as near as this deviations jump; a look between two is by so much off either.
_NEAR, _INSIDE = 1.15, 1.03
# What hardly falls with its size shows by a thing that is there at any.
_GROWS = 0.2


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """What a campaign sees from a stand, by both views of the model's own error.

    A view are deviations that show, which are those that give a name, and those where every line counts whole; what
    data say line by line is tempered to its ``worth``.
    """

    stand: Stand
    alike: Imitated
    worth: float

    @classmethod
    def of(cls, stand: Stand, worth: float) -> Sight:
        """What the unknowns of a stand leave to be seen."""
        return cls(stand, Imitated.of(stand.fit.problem, stand.fit.tangent), worth)

    def views(self, change: Array, seen: Array) -> Views:
        """Of a change (2 N + scores,) of the misfit vector, of which ``seen`` no score can imitate."""
        length = float(np.linalg.norm(seen))
        if length == 0:
            return ((0.0, 0.0), (0.0, 0.0))
        # What the tolerances have to give counts whole, what data say is tempered.
        given = float(np.linalg.norm(seen[self.stand.fit.points :])) / length
        lasting = self.alike.deviations(change)
        return ((length * math.sqrt(self.worth + (1 - self.worth) * given**2), length), (lasting, lasting))

    def at(
        self, hypothesis: Hypothesis, values: dict[str, float], p: Parameter, promised: float | None = None
    ) -> Views | None:
        """The views of an effect at some values, its size ``p`` among them; None where that is impossible.

        Standing still, the unknowns leave curvature that they share with it. So they follow, unless a slope has
        ``promised`` so many deviations at this size, and keeps that: then there is no such curvature. Where following
        leads astray, what they leave standing still is less, and is what counts.
        """
        change = self.stand.change(hypothesis, values)
        if change is None:
            return None
        views = self.views(change, self.stand.projected(change))
        if promised is not None and kept(views, promised):
            return views
        neutral = {p.name: float(p.neutral or 0.0)}
        shown = self.stand.shown(hypothesis, values, neutral)
        if shown is None:
            return None
        made_up = np.linalg.norm(change) > _MADE_UP * np.linalg.norm(shown)
        if made_up and not holds(self.stand, hypothesis, values, shown):
            along = shown_in_parts(self.stand, hypothesis, values, p, float(shown @ shown))
            shown = shown if along is None else min(shown, along, key=lambda left: float(left @ left))
        return min(self.views(shown, shown), views, key=least)


def least(views: Views) -> float:
    """Deviations that show by the view that sees least."""
    return min(shown for shown, _ in views)


def kept(views: Views, wanted: float) -> bool:
    """Whether as many deviations show as were wanted."""
    found = least(views)
    return found > 0 and abs(math.log(found / wanted)) < _KEPT


def size_of(
    views_at: Callable[[float], Views | None], foretold: float, wanted: float, power: int, most: float = math.inf
) -> tuple[float, Views] | None:
    """The size that shows by the deviations ``wanted``, with its views, in a few looks from the size ``foretold``.

    Deviations are taken to grow with its ``power`` until two looks tell. Where they jump past what is wanted, as when a
    sensor comes to sit on another link, it is the size just beyond. Where the ``most`` that is plausible shows by less,
    it is foretold from there. None where no such size is found, as where more
    show and do not fall with it.
    """
    size, known = foretold, []
    less, more = 0.0, math.inf
    beyond: tuple[float, Views] | None = None
    for _ in range(_LOOKS):
        views = views_at(size)
        if views is None or not 0 < least(views) < math.inf:
            return None
        if kept(views, wanted):
            return size, views
        if least(views) < wanted:
            if size >= most:
                times = (wanted / least(views)) ** (1 / power)
                (shown, raw), (lasting, last) = views
                grown = times**power
                return size * times, ((grown * shown, grown * raw), (grown * lasting, grown * last))
            less = max(less, size)
        elif size < more:
            more, beyond = size, (size, views)
        if beyond is not None and more < _NEAR * less:
            return beyond
        known.append((math.log(size), math.log(least(views))))
        rate = float(power)
        if len(known) > 1:
            (size_0, seen_0), (size_1, seen_1) = known[-2:]
            rate = (seen_1 - seen_0) / (size_1 - size_0)
            if rate < _GROWS and not less:
                return None
        # Too few are there at any size, and grow further up.
        before = size
        size *= min(max((wanted / least(views)) ** (1 / max(rate, _GROWS)), 1 / _FARTHEST), _FARTHEST)
        if beyond is not None and less and not less * _INSIDE < size < more / _INSIDE:
            size = math.sqrt(less * more)
        size = min(size, max(most, before))
    return None
