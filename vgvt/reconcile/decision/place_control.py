"""The wrong-place control: the winner offered where it is not; where that does as well, its place is not determined."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.acting import action_of
from vgvt.reconcile.evidence.confirmation import preferred_by
from vgvt.reconcile.evidence.plausible import PLACES
from vgvt.reconcile.fitting.fit import FAR, Fit
from vgvt.reconcile.fitting.fit_unless_behind import fit_unless_behind
from vgvt.reconcile.prediction.grouping import NoStructureError, effects_at
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.candidates import freed, places
from vgvt.reconcile.search.shortlist import BIASED
from vgvt.reconcile.work.progress import Progress, silent
from vgvt.reconcile.work.team import ALONE, Team

if TYPE_CHECKING:
    from vgvt.reconcile.decision.addition import Addition
    from vgvt.reconcile.evidence.rivals import Rival

Array = NDArray[np.float64]
Place = tuple[float, float]
Ends = tuple[Place, ...]

APART_M = 0.25
"""Places nearer than this are one place: a station of the candidates' grid is about twice as long."""
_NEIGHBOURS = 2
# What a fit elsewhere is given before it is asked how far behind it is.
_FIRST = (*FAR[:-1], (0.0, 6))
_OTHER_SIDE = {"left": "right", "right": "left"}
# What says where a thing is that has no place in metres.
_WHERE = ("side", "node", "other_node", "sensors", "channels", "item", "shaker", "beam")


@dataclass(frozen=True, slots=True, eq=False)
class ElsewhereTrial:
    """The winner's effect fitted elsewhere: ``where`` in words, and its fit."""

    where: str
    fit: Fit


def controlled(
    addition: Addition, judged: Callable[[Fit], Rival], set_nats: float, tell: Progress = silent, team: Team = ALONE
) -> Addition:
    """A round whose equivalence set holds the winner's effect elsewhere too, where that does as well on held-out data.

    And as another name would have to, on those that were fitted, unless much is still missing: held-out channels that
    hardly move know of no place. ``judged`` makes a rival of a fit as the round did.
    """
    winner = addition.winner
    trials = elsewhere(winner.fit, tell, team)
    added = [judged(t.fit) for t in trials if as_good(t.fit, winner.fit, set_nats)]
    if winner.fit.chi2_per_dof < BIASED:
        added = [r for r in added if r.gain_nats > winner.gain_nats - set_nats]
    return replace(addition, equivalent=(*addition.equivalent, *added), rivals=(*addition.rivals, *added))


def elsewhere(winner: Fit, tell: Progress = silent, team: Team = ALONE) -> tuple[ElsewhereTrial, ...]:
    """The winner's last effect fitted at its mirror image and, its place held, at the two nearest other stations.

    Nothing for an effect that has neither a place nor a side.
    """
    offers, own = _offers(winner), ends_of(winner)
    found = team.work_off([(_fitted_at, (winner, *offer)) for offer in offers], tell)
    # One that wandered back says nothing.
    return tuple(
        ElsewhereTrial(where, fitted)
        for (where, _, _), fitted in zip(offers, found, strict=True)
        if fitted is not None and (not own or _moved(ends_of(fitted), own) > APART_M)
    )


def _fitted_at(winner: Fit, where: str, hypothesis: Hypothesis, values: dict[str, float], tell: Progress) -> Fit | None:
    """The effect somewhere else, fitted; None where there is no such aircraft."""
    tell(0.0, f"control: {hypothesis.name} {where}")
    before = winner.e[: winner.e.size - len(winner.hypotheses[-1].parameters)]
    start = np.concatenate([before, hypothesis.scores(values)])
    try:
        return fit_unless_behind(
            winner.problem, (*winner.hypotheses[:-1], hypothesis), winner.u, start, _FIRST, winner.chi2
        )
    except NoStructureError:
        return None


def as_good(other: Fit, winner: Fit, set_nats: float) -> bool:
    """Whether held-out data, or all where nothing is held out, prefer the winner by less than ``set_nats``."""
    return preferred_by(winner, other) < set_nats


def place_of(fit: Fit) -> Place | None:
    """Where the last effect of a fit sits, (x, y) in metres; None for one without a place."""
    return next(iter(ends_of(fit)), None)


def ends_of(fit: Fit) -> Ends:
    """The places (x, y) in metres of the last effect of a fit: two of one from a point to another, none of many."""
    hypothesis = fit.hypotheses[-1]
    values = {**hypothesis.settings, **{k: v[0] for k, v in fit.values(len(fit.hypotheses) - 1).items()}}
    return tuple((float(values[x]), float(values[y])) for x, y in PLACES if x in values and y in values)


def distinct_places(fits: Sequence[Fit]) -> tuple[Ends, ...]:
    """The places of the last effects of some fits, the first of those that are one place, in order."""
    return tuple(ends_of(fits[k]) for k in _apart_from_all(fits))


def _apart_from_all(fits: Sequence[Fit]) -> list[int]:
    """Which fits have a place of their own, the first of those that are one place."""
    found: dict[int, Ends] = {}
    for k, fitted in enumerate(fits):
        place = ends_of(fitted)
        if place and all(_moved(place, other) > APART_M for other in found.values()):
            found[k] = place
    return list(found)


def open_places(addition: Addition) -> tuple[str, ...]:
    """Where else the winner's effect does as well, in words: other points, or settings that say where it is."""
    return tuple(there.where for there in members_elsewhere(addition))


@dataclass(frozen=True, slots=True, eq=False)
class MemberElsewhere:
    """A rival that is the winner's effect elsewhere: ``where`` in words, and ``not_there``, where the winner is."""

    where: str
    not_there: str
    rival: Rival


def members_elsewhere(addition: Addition) -> tuple[MemberElsewhere, ...]:
    """The winner's effect at every other place where it does as well.

    Not what says the same of the same channels in other words, as a sensor's number does of the point where it sits.
    A/F is a quotient: what happens to its force, and what happens to all responses, is one place, too.
    """
    winner = addition.winner
    same = [r for r in addition.equivalent if r.name == winner.name and r is not winner]
    placed = [same[k - 1] for k in _apart_from_all([winner.fit, *(r.fit for r in same)])[1:]]
    found = [MemberElsewhere(_at(ends_of(r.fit)), _at(ends_of(winner.fit)), r) for r in placed]
    own, touched = winner.hypothesis.settings, _touched(winner.fit) if same else None
    by_settings: dict[str, MemberElsewhere] = {}
    for r in same:
        other = {k: v for k, v in r.hypothesis.settings.items() if k in _WHERE and v != own.get(k)}
        if other and (touched is None or _touched(r.fit) != touched):
            here = {k: own[k] for k in other if k in own}
            by_settings.setdefault(_with(other), MemberElsewhere(_with(other), _with(here), r))
    return (*found, *by_settings.values())


def _at(ends: Ends) -> str:
    return "at " + " and ".join(f"x = {x:.2f} m, y = {y:.2f} m" for x, y in ends)


def _with(settings: Mapping[str, object]) -> str:
    return "with " + ", ".join(f"{k} = {v}" for k, v in settings.items()) if settings else "as it was found"


def _touched(fit: Fit) -> tuple[frozenset[str], ...] | None:
    """The channels of each run that the last effect of a fit changes; None where it changes none, or refuses."""
    made = effects_at(fit.problem, fit.hypotheses, fit.e)
    if made is None:
        return None
    scenario, found = fit.problem.scenario, []
    label = {p.dof.node: str(p.dof) for p in fit.problem.layouts.first.grid}
    for run, nodes in enumerate(scenario.acquisition.run_nodes):
        try:
            changed = {c.channels for c in action_of(made[-1], scenario, run).channels}
        except ValueError:
            return None
        shared = bool(changed & {"force", "drive", "response", "all"})
        found.append(frozenset(label[n] for n in nodes) if shared else frozenset(changed))
    return tuple(found) if any(found) else None


def _offers(winner: Fit) -> list[tuple[str, Hypothesis, dict[str, float]]]:
    """Where else, the hypothesis there, and the values to start from."""
    hypothesis = winner.hypotheses[-1]
    values = {k: v[0] for k, v in winner.values(len(winner.hypotheses) - 1).items()}
    place = place_of(winner)
    if place is None:
        side = str(hypothesis.settings.get("side", ""))
        if side not in _OTHER_SIDE:
            return []
        other = replace(hypothesis, settings={**hypothesis.settings, "side": _OTHER_SIDE[side]})
        return [(f"on the {_OTHER_SIDE[side]}", other, values)]
    free = freed(hypothesis)
    offers = []
    ends = ends_of(winner)
    there = tuple((x, -y) for x, y in ends)
    if _moved(ends, there) > APART_M:
        placed = {k: v for pair, point in zip(PLACES, there, strict=False) for k, v in zip(pair, point, strict=True)}
        offers.append(("at the mirror image", free, {**values, **placed}))
    every = places(winner.problem)
    stations = sorted((p for p in every if _apart(p, place) > APART_M), key=lambda p: _apart(p, place))
    for p in stations[:_NEIGHBOURS]:
        there_alone = {**free.settings, "x_m": p[0], "y_m": p[1]}
        held = replace(free, settings=there_alone, share=free.share / len(every), places=len(every))
        rest = {k: v for k, v in values.items() if k not in ("x_m", "y_m")}
        offers.append((f"at x = {p[0]:.2f} m, y = {p[1]:.2f} m", held, rest))
    return offers


def _apart(one: Place, other: Place) -> float:
    return float(np.hypot(one[0] - other[0], one[1] - other[1]))


def _moved(one: Ends, other: Ends) -> float:
    """How far the end that moved most has moved between two places of one thing; which end is called first is naught.

    A thing with another number of ends is elsewhere.
    """
    if len(one) != len(other):
        return np.inf
    return min(max(map(_apart, one, turned)) for turned in permutations(other))
