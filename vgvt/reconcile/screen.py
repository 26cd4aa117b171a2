"""Screen the catalogue: how much χ² each effect could buy beyond what the declared uncertainties could.

Data and each candidate's change of the prediction are projected off the tangent space of the calibrated
unknowns (one QR); the effect's sizes then have a closed form. Resonances are scanned.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.parameter import Parameter
from vgvt.reconcile.fit import Fit
from vgvt.reconcile.hypothesis import Hypothesis
from vgvt.reconcile.level_grid import depends_on_level, level_grid
from vgvt.reconcile.one_thread import one_thread
from vgvt.reconcile.problem import Problem
from vgvt.reconcile.progress import Progress, part, silent
from vgvt.reconcile.scan import scan_of
from vgvt.reconcile.stand import Stand, step_from_neutral
from vgvt.reconcile.team import ALONE, Task, Team

Array = NDArray[np.float64]
# Steps around the best of a scan, as shares of its own.
_FINE = 0.25
_KEPT, _WORTH_REFINING = 3, 1.0
WORTH_CHECKING = 0.5
"""Nats that a variant must promise to be looked at closer."""
SLOTS, _OF_ONE = 9, 3
"""More than any short list asks for, in all; and of one effect."""
# Variants of one effect that are looked at in small.
_LOOKED_AT = 6
_SIZED = 0.8
_SHARES = (1.0, 0.5, 0.25, 0.125)


@dataclass(frozen=True, slots=True, eq=False)
class Screened:
    """A variant with the values to start a fit from, and the nats it could buy at best: half the drop of χ².

    ``remaining`` is the χ² that it would leave, ``start`` (scores,) those of the stand that it was screened at: of the
    unknowns and of the effects that are there already. ``tuned`` names the parameter that was scanned, as it moves a
    resonance: with a part of it the resonance is elsewhere, so it is no size. What has ``arrived`` is at the bottom of
    a fit already: coarse steps would lead away. What is ``upright`` was seen from a calibration that may not bend
    (:mod:`vgvt.reconcile.upright`), and is too small for coarse steps to tell.
    """

    hypothesis: Hypothesis
    values: dict[str, float]
    gain_nats: float
    visible: bool = True
    remaining: float = math.inf
    start: Array | None = None
    tuned: str = ""
    arrived: bool = False
    upright: bool = False

    @property
    def sizes(self) -> dict[str, float]:
        """Neutral values of what an effect can have a part of, by name."""
        mine = (p for p in self.hypothesis.parameters if p.name in self.values and p.name != self.tuned)
        return {p.name: float(p.neutral) for p in mine if p.neutral is not None}


@one_thread
def screen(
    null: Fit,
    hypotheses: Sequence[Hypothesis],
    tell: Progress = silent,
    *,
    least_nats: float = WORTH_CHECKING,
    slots: int = SLOTS,
    team: Team = ALONE,
) -> tuple[Screened, ...]:
    """All variants by what they could buy, best first; an effect that leaves A/F alone is not ``visible``.

    Sizes come from a closed form for every variant; the most promising ones are then checked at those sizes, down to
    what is promised ``least_nats`` and until ``slots`` of them hold. A ``team`` shares the former.
    """
    shares = team.work_off(sizing(null, hypotheses, team), part(tell, 0.0, _SIZED))
    return held(null, joined(shares), least_nats, slots, part(tell, _SIZED, 1.0))


def sizing(null: Fit, hypotheses: Sequence[Hypothesis], team: Team) -> list[Task]:
    """Tasks that give every variant the sizes of the closed form, one for each of a team."""
    count = min(team.workers, len(hypotheses))
    # Those of one effect, which cost alike, follow each other.
    return [(_shared, (null, hypotheses[k::count])) for k in range(count)]


def joined(shares: Sequence[Sequence[Sequence[Screened]]]) -> list[Screened]:
    """What such tasks found, in the order of the hypotheses."""
    longest = itertools.zip_longest(*shares, fillvalue=())
    return [s for together in longest for found in together for s in found]


@one_thread
def _shared(null: Fit, hypotheses: Sequence[Hypothesis], tell: Progress) -> list[list[Screened]]:
    """Some hypotheses at the sizes of the closed form."""
    stand, found = _stand_on(null), list[list[Screened]]()
    for k, hypothesis in enumerate(hypotheses):
        tell(k / len(hypotheses), f"screen {hypothesis.name}")
        found.append(at_sizes(stand, hypothesis))
    return found


@one_thread
def held(null: Fit, sized: Sequence[Screened], least_nats: float, slots: int, tell: Progress) -> tuple[Screened, ...]:
    """Variants at the sizes of the closed form, the most promising ones by what they hold of their promise."""
    stand = _stand_on(null)
    found = _check_the_best(stand, sized, least_nats, slots, lambda f: tell(f, "screen the most promising"))
    starts = (null.scores if s.start is None else s.start for s in found)
    done = (replace(s, remaining=stand.cost - 2 * s.gain_nats, start=u) for s, u in zip(found, starts, strict=True))
    return tuple(sorted(done, key=lambda s: -s.gain_nats))


# The last stand, with what it is known by, and the problem, whose identity is its own for as long as it is held here.
_last: list[tuple[tuple[object, ...], Problem, Stand]] = []


def _stand_on(null: Fit) -> Stand:
    """The stand on a fit; the last one is kept, with the slopes that it knows.

    A fit that was sent to a helper once more is the same by what it holds.
    """
    named = tuple((h.name, repr(sorted(h.settings.items()))) for h in null.hypotheses)
    key = (id(null.problem), named, null.scores.tobytes(), null.chi2, null.evidence_nats)
    if not _last or _last[0][0] != key:
        _last[:] = [(key, null.problem, Stand.of(null))]
    return _last[0][2]


def at_sizes(stand: Stand, hypothesis: Hypothesis) -> list[Screened]:
    """A variant at the sizes of the closed form; of one that is scanned, its best few, then steps around the best."""
    if depends_on_level(stand.fit.problem, hypothesis):
        return [
            max((_at(stand, Screened(hypothesis, v, 0.0)) for v in level_grid(hypothesis)), key=lambda s: s.gain_nats)
        ]
    scan = scan_of(stand.fit.problem, hypothesis)
    scanned = scan.tuned
    tried = (_sized(stand, hypothesis, values, scanned if scanned in values else "") for values in scan.starts)
    sized = sorted(tried, key=lambda s: -s.gain_nats)
    if not sized[0].tuned or sized[0].gain_nats <= _WORTH_REFINING:
        return sized[:_KEPT] if scanned else sized[:1]
    switches = {p.name for p in hypothesis.parameters if p.neutral is not None}
    others = {k: v for k, v in sized[0].values.items() if k not in switches}
    centre, steps = sized[0].values[scanned], math.exp(_FINE * scan.step) ** np.array([-3, -2, -1, 1, 2, 3])
    again = [_sized(stand, hypothesis, {**others, scanned: float(centre * s)}, scanned) for s in steps]
    return sorted([*sized[:_KEPT], max(again, key=lambda s: s.gain_nats)], key=lambda s: -s.gain_nats)


def _check_the_best(
    stand: Stand, sized: Sequence[Screened], least_nats: float, slots: int, tell: Callable[[float], None]
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
        tell(1 - len(queue) / len(sized))
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


def parted(s: Screened, share: float) -> dict[str, float]:
    """Values of a variant with a share of its sizes."""
    return {**s.values, **{k: n + share * (s.values[k] - n) for k, n in s.sizes.items()}}


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
        found = _at(stand, replace(s, values=parted(s, share)))
        best = found if best is None or found.gain_nats > best.gain_nats else best
        if found.gain_nats >= 0.5 * share * (2 - share) * s.gain_nats:
            break
    return s if best is None else best


def _sized(stand: Stand, hypothesis: Hypothesis, start: dict[str, float], tuned: str) -> Screened:
    """The best sizes of an effect whose other values are given, by the closed form; what has none, as it is."""
    switches = [p for p in hypothesis.parameters if p.neutral is not None and p.name not in start]
    neutral = {p.name: float(p.neutral) for p in switches if p.neutral is not None}
    if not switches:
        reached = stand.linearly_followed(hypothesis, start)
        gain = -math.inf if reached is None else 0.5 * (stand.cost - reached)
        return Screened(hypothesis, start, gain, tuned=tuned)
    left = stand.left
    columns, used = [], []
    for p in switches:
        slope = stand.slope(hypothesis, {**start, **neutral}, p)
        if slope is not None and np.abs(slope).max() * step_from_neutral(p) > 1e-9:
            columns.append(stand.projected(slope))
            used.append(p)
    if not columns:
        middles = {p.name: p.at(0.5) for p in switches}
        return Screened(hypothesis, {**start, **middles}, 0.0, visible=False, tuned=tuned)
    amounts = _non_negative(np.array(columns).T, left, [p.scale == "log" for p in used])
    values = {**start, **neutral}
    for p, amount in zip(used, amounts, strict=True):
        values[p.name] = neutral[p.name] + float(amount)
    predicted = left + np.array(columns).T @ amounts
    linear = 0.5 * float(left @ left - predicted @ predicted)
    inside = {p.name: _inside(p, values[p.name]) for p in used}
    return Screened(hypothesis, {**values, **inside}, linear, tuned=tuned)


def _at(stand: Stand, s: Screened) -> Screened:
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


def _non_negative(columns: Array, left: Array, positive: list[bool]) -> Array:
    """Least-squares amounts (k,), those of positive quantities not below zero."""
    best, amounts = math.inf, np.zeros(columns.shape[1])
    free = [k for k, p in enumerate(positive) if p]
    for off in itertools.chain.from_iterable(itertools.combinations(free, r) for r in range(len(free) + 1)):
        on = [k for k in range(columns.shape[1]) if k not in off]
        trial = np.zeros(columns.shape[1])
        if on:
            trial[on] = -np.linalg.lstsq(columns[:, on], left, rcond=1e-10)[0]
        if any(trial[k] < 0 for k in free):
            continue
        cost = float(np.sum((left + columns @ trial) ** 2))
        if cost < best:
            best, amounts = cost, trial
    return amounts


def _inside(p: Parameter, value: float) -> float:
    return min(max(value, p.low), p.high)
