"""Screen the catalogue: how much χ² each effect could buy beyond what the declared uncertainties could.

Data and each candidate's change of the prediction are projected off the tangent space of the calibrated
unknowns (one QR); the effect's sizes then have a closed form. Resonances are scanned.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.parameter import Parameter
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.level_grid import depends_on_level, level_grid
from vgvt.reconcile.search.closer_look import SLOTS, at_values, held
from vgvt.reconcile.search.scan import scan_of
from vgvt.reconcile.search.screened import Screened
from vgvt.reconcile.search.stand import Stand, step_from_neutral
from vgvt.reconcile.search.stand_on import stand_on
from vgvt.reconcile.work.one_thread import one_thread
from vgvt.reconcile.work.progress import Progress, part, silent
from vgvt.reconcile.work.team import ALONE, Task, Team

Array = NDArray[np.float64]
# Steps around the best of a scan, as shares of its own.
_FINE = 0.25
_KEPT, _WORTH_REFINING = 3, 1.0
WORTH_CHECKING = 0.5
"""Nats that a variant must promise to be looked at closer."""
_SIZED = 0.8


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
    stand, found = stand_on(null), list[list[Screened]]()
    for k, hypothesis in enumerate(hypotheses):
        tell(k / len(hypotheses), f"screen {hypothesis.name}")
        found.append(at_sizes(stand, hypothesis))
    return found


def at_sizes(stand: Stand, hypothesis: Hypothesis) -> list[Screened]:
    """A variant at the sizes of the closed form; of one that is scanned, its best few, then steps around the best."""
    if depends_on_level(stand.fit.problem, hypothesis):
        return [
            max(
                (at_values(stand, Screened(hypothesis, v, 0.0)) for v in level_grid(hypothesis)),
                key=lambda s: s.gain_nats,
            )
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


def _sized(stand: Stand, hypothesis: Hypothesis, start: dict[str, float], tuned: str) -> Screened:
    """The best sizes of an effect whose other values are given, by the closed form; what has none, as it is."""
    switches = [p for p in hypothesis.parameters if p.neutral is not None and p.name not in start]
    neutral = {p.name: float(p.neutral) for p in switches if p.neutral is not None}
    if not switches:
        reached = stand.linearly_followed(hypothesis, start)
        gain = -math.inf if reached is None else 0.5 * (stand.cost - reached)
        return Screened(hypothesis, start, gain, tuned=tuned)
    columns: dict[str, Array] = {}
    for p in switches:
        slope = stand.slope(hypothesis, {**start, **neutral}, p)
        if slope is not None and np.abs(slope).max() * step_from_neutral(p) > 1e-9:
            columns[p.name] = stand.projected(slope)
    middles = {p.name: p.at(0.5) for p in switches}
    if not columns:
        return Screened(hypothesis, {**start, **middles}, 0.0, visible=False, tuned=tuned)
    used = [p for p in switches if p.name in columns]
    choices = itertools.chain.from_iterable(itertools.combinations(used, r) for r in range(1, len(used) + 1))
    sized = [_with_sizes(stand.left, hypothesis, used, on, columns) for on in choices]
    best = max(sized, key=lambda s: s.at_values + math.log(s.hypothesis.share))
    unseen = {name: value for name, value in middles.items() if name not in columns}
    return Screened(best.hypothesis, {**start, **unseen, **best.values}, best.linear, tuned=tuned)


class _Sized(NamedTuple):
    """A variant with plausible values of its sizes, and nats: of what the closed form gives them, and of these."""

    hypothesis: Hypothesis
    values: dict[str, float]
    linear: float
    at_values: float


def _with_sizes(
    left: Array,
    hypothesis: Hypothesis,
    sizes: Sequence[Parameter],
    on: Sequence[Parameter],
    columns: dict[str, Array],
) -> _Sized:
    """The best of some sizes by the closed form, the others left out.

    What is best at nothing, or at less, has its least plausible value where it is not: in quiet data that does harm.
    """
    for p in sizes:
        hypothesis = hypothesis if p in on else hypothesis.without(p.name)
    matrix = np.array([columns[p.name] for p in on]).T
    amounts = _non_negative(matrix, left, [p.scale == "log" for p in on])
    neutral = np.array([float(p.neutral or 0.0) for p in on])
    values = {p.name: _inside(p, float(v)) for p, v in zip(on, neutral + amounts, strict=True)}
    plausible = np.array([*values.values()]) - neutral
    linear, at_values = (0.5 * float(left @ left - np.sum((left + matrix @ a) ** 2)) for a in (amounts, plausible))
    return _Sized(hypothesis, values, linear, at_values)


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
