"""A closer look at what a screen promises: first at a small part of the size, then at as much of it as holds."""

from __future__ import annotations

import heapq
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.level_grid import depends_on_level
from vgvt.reconcile.search.screened import Screened, parted
from vgvt.reconcile.search.stand import Stand
from vgvt.reconcile.search.stand_on import stand_on
from vgvt.reconcile.work.one_thread import one_thread
from vgvt.reconcile.work.progress import Progress

SLOTS, _OF_ONE = 9, 3
"""More than any short list asks for, in all; and of one effect."""
# Variants of one effect that are looked at in small.
_LOOKED_AT = 6
_SHARES = (1.0, 0.5, 0.25, 0.125)


@one_thread
def held(null: Fit, sized: Sequence[Screened], least_nats: float, slots: int, tell: Progress) -> tuple[Screened, ...]:
    """Variants at the sizes of the closed form, the most promising ones by what they hold of their promise.

    Down to what is promised ``least_nats``, and until ``slots`` of them hold.
    """
    stand = stand_on(null)
    found = _check_the_best(stand, sized, least_nats, slots, tell)
    starts = (null.scores if s.start is None else s.start for s in found)
    done = (replace(s, remaining=stand.cost - 2 * s.gain_nats, start=u) for s, u in zip(found, starts, strict=True))
    return tuple(sorted(done, key=lambda s: -s.gain_nats))


def _check_the_best(
    stand: Stand, sized: Sequence[Screened], least_nats: float, slots: int, tell: Progress
) -> list[Screened]:
    """The best of every variant's sizes, looked at ever closer, the most promising first, while it could be asked for.

    First a small part of the size, then as much of it as holds: what is behind those that hold theirs stays at its
    promise. A stand that is far off promises everything; of one effect only the first few are then looked at.
    """
    queue = [(-s.gain_nats, k, 0, s) for k, s in enumerate(sized)]
    heapq.heapify(queue)
    best: dict[Hypothesis, Screened] = {}
    held: list[str] = []
    known: dict[str, list[float]] = {}
    while queue:
        _, k, closer, s = heapq.heappop(queue)
        tell(1 - len(queue) / len(sized), "screen the most promising")
        name = s.hypothesis.name
        # Those that held theirs came off the queue before: they are ahead of whatever is left.
        enough = held.count(name) >= _OF_ONE
        enough = enough or sum(min(n, _OF_ONE) for n in Counter(held).values()) >= slots
        if closer < 2 and not enough and s.gain_nats >= least_nats and _checkable(stand, s):
            seen = known.setdefault(name, [])
            if closer == 0 and len(seen) >= _LOOKED_AT:
                s = replace(s, gain_nats=min(s.gain_nats, min(seen)))
            else:
                found = _checked(stand, s) if closer else _in_small(stand, s)
                seen += [] if closer else [found.gain_nats]
                heapq.heappush(queue, (-found.gain_nats, k, closer + 1, found))
                continue
        if s.hypothesis not in best or s.gain_nats > best[s.hypothesis].gain_nats:
            best[s.hypothesis] = s
            if closer == 2:
                held.append(name)
    return list(best.values())


def _checkable(stand: Stand, s: Screened) -> bool:
    return s.visible and not depends_on_level(stand.fit.problem, s.hypothesis)


def _in_small(stand: Stand, s: Screened) -> Screened:
    """A variant whose promise is what a small part of its size lets expect of the whole by the closed form."""
    share = _SHARES[-1] if s.sizes else 1.0
    reached = stand.followed(s.hypothesis, parted(s, share), s.sizes)
    gain = -math.inf if reached is None else 0.5 * (stand.cost - reached[0]) / (share * (2 - share))
    return replace(s, gain_nats=min(gain, s.gain_nats))


def _checked(stand: Stand, s: Screened) -> Screened:
    """What a variant buys in truth at the sizes that the closed form gave, or at parts of them.

    Effects saturate, and what the unknowns can imitate they cannot follow far in a few steps: a part that holds what
    the closed form promises of it is a start from where a fit finds the rest.
    """
    best = None
    for share in _SHARES if s.sizes else _SHARES[:1]:
        found = at_values(stand, replace(s, values=parted(s, share)))
        best = found if best is None or found.gain_nats > best.gain_nats else best
        if found.gain_nats >= 0.5 * share * (2 - share) * s.gain_nats:
            break
    return s if best is None else best


def at_values(stand: Stand, s: Screened) -> Screened:
    """A variant at its values, the unknowns following."""
    visible = depends_on_level(stand.fit.problem, s.hypothesis)
    if not visible:
        moved = stand.change(s.hypothesis, s.values)
        if moved is None:
            return replace(s, gain_nats=-math.inf)
        visible = bool(np.abs(moved).max() > 1e-9)
    reached = stand.followed(s.hypothesis, s.values, s.sizes) if visible else None
    if reached is None:
        return replace(s, gain_nats=0.0 if not visible else -math.inf, visible=visible)
    return replace(s, gain_nats=0.5 * (stand.cost - reached[0]), visible=visible, start=reached[1])
