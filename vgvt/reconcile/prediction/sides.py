"""What a parameter changes in a structure: the difference of two that stand beside the same one without the effect."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.registry import effects_of
from vgvt.reconcile.prediction.adjacent import beside
from vgvt.reconcile.prediction.carried import Structures
from vgvt.reconcile.prediction.following import beyond, leaders
from vgvt.reconcile.prediction.grouping import Group, assembled, changed_places, parted
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Nominal, Problem

Array = NDArray[np.float64]
_EFFECT_STEP = 0.002
# Beside a joint that slips, where slopes follow what it shows: resonances are sharp, and their marches bend sooner.
_FOLLOWED_STEP = 5e-5
_EFFECT = "effect-"


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """Groups at e and a step of one parameter away: what their difference is over the step is its slope."""

    here: tuple[Group, ...]
    there: tuple[Group, ...]
    step: float


@dataclass(frozen=True, slots=True, eq=False)
class _Apart:
    """The hypothesis at a ``place`` among some, with its scores ``mine``, and the ``others`` with theirs, ``rest``.

    Its scores begin at ``begin`` in e.
    """

    hypothesis: Hypothesis
    mine: Array
    others: tuple[Hypothesis, ...]
    rest: Array
    begin: int
    place: int

    def beside(
        self, problem: Problem, u: Array, bare: tuple[Group, ...], mine: Array, like: tuple[Group, ...],
        start: Nominal | None = None,
    ) -> tuple[Group, ...] | None:  # fmt: skip
        """It added last to a rig without it, which is cheap, over the coordinates of groups that are ``like`` it."""
        last = (*self.others, self.hypothesis)
        found = beside(problem, u, bare, last, np.concatenate([self.rest, mine]), start)
        if found is None:
            return None
        # What effects add is named after their order.
        own, count = len(effects_of(problem.scenario)), len(last)
        order = [*(k for k in range(count) if k != self.place), self.place]
        known = {str(own + j): f"{_EFFECT}{own + k}" for j, k in enumerate(order)}
        named = []
        whole = {channel: other for other in like for channel in other.channels.tolist()}
        for group in found:
            joints, other = tuple(_renamed(joint, known) for joint in group.structure.joints), whole[group.channels[0]]
            # A step from nothing may part runs that were alike.
            if set(joints) != set(other.structure.joints) or not np.isin(group.channels, other.channels).all():
                return None
            s = replace(group.structure, joints=joints).onto(other.structure.joints)
            named.append(replace(group, structure=s))
        return tuple(named)


def _renamed(joint: str, known: dict[str, str]) -> str:
    effect, _, rest = joint.removeprefix(_EFFECT).partition("-")
    return f"{known[effect]}-{rest}" if joint.startswith(_EFFECT) and effect in known else joint


def _apart(hypotheses: tuple[Hypothesis, ...], e: Array) -> Iterator[_Apart]:
    ends = np.cumsum([0, *(len(h.parameters) for h in hypotheses)])
    for k, hypothesis in enumerate(hypotheses):
        begin, end = int(ends[k]), int(ends[k + 1])
        others = (*hypotheses[:k], *hypotheses[k + 1 :])
        yield _Apart(hypothesis, e[begin:end], others, np.concatenate([e[:begin], e[end:]]), begin, k)


def sides_of(
    structures: Structures, u: Array, hypotheses: tuple[Hypothesis, ...], e: Array, groups: tuple[Group, ...]
) -> list[Side]:
    """For every parameter of the hypotheses, groups a step away from those at e, both parted alike.

    A step is added to the rig without the effect, as the stated aircraft has it; of ``whole`` structures it is
    assembled: what a hook does by moving depends on how high it is.
    """
    problem, sides = structures.problem, list[Side]()
    size = _EFFECT_STEP if structures.follows is None else _FOLLOWED_STEP
    for one in _apart(hypotheses, e):
        mine = one.mine
        bare = structures.beside(u, one.others, one.rest) if mine.size and not structures.whole else None
        here = None if bare is None else one.beside(problem, u, bare, mine, groups)
        for j in range(mine.size):
            side = None
            for step in (size, -size):
                moved = mine + step * np.eye(mine.size)[j]
                near, start = None, groups
                if bare is not None and here is not None:
                    near, start = one.beside(problem, u, bare, moved, groups), here
                if near is None:
                    away, start = e.copy(), groups
                    away[one.begin + j] += step
                    near = assembled(problem, u, hypotheses, away)
                if near is None:
                    continue
                start, near = parted((start, near))
                if _alike(start, near):
                    side = Side(start, near, one.hypothesis.reach(j, step)) if side is None else side
                    if not changed_places(start, near):
                        side = Side(start, near, one.hypothesis.reach(j, step))
                        break
            sides.append(side if side is not None else Side(groups, groups, size))
    return sides


def together(
    groups: tuple[Group, ...], sides: Sequence[Side], pulled: Sequence[tuple[int, Side]]
) -> tuple[tuple[Group, ...], list[Side], list[tuple[int, Side]]]:
    """The same with all groups parted alike."""
    every = [*sides, *(side for _, side in pulled)]
    groups, *ends = parted([groups, *(end for side in every for end in (side.here, side.there))])
    same = [replace(side, here=ends[2 * k], there=ends[2 * k + 1]) for k, side in enumerate(every)]
    indices = (index for index, _ in pulled)
    return groups, same[: len(sides)], list(zip(indices, same[len(sides) :], strict=True))


def widened(sides: Sequence[Side], groups: tuple[Group, ...]) -> list[Side] | None:
    """Sides of an aircraft as those of one on which more hangs, whose ``groups`` these are; None where it has not all.

    A step of what was there before changes what it did, whatever hangs beside it.
    """
    found = []
    for side in sides:
        ends = [tuple(_wider(end, group) for group in groups) for end in (side.here, side.there)]
        here, there = (tuple(g for g in end if g is not None) for end in ends)
        if len(here) < len(groups) or len(there) < len(groups):
            return None
        found.append(Side(here, there, side.step))
    return found


def _wider(known: tuple[Group, ...], like: Group) -> Group | None:
    """Of some groups the channels and coordinates of one that is ``like`` it, None where they are not all there."""
    for group in known:
        if set(group.structure.joints) <= set(like.structure.joints) and np.isin(like.channels, group.channels).all():
            at = [int(np.flatnonzero(group.channels == channel)[0]) for channel in like.channels]
            return replace(
                group, structure=group.structure.onto(like.structure.joints), channels=like.channels,
                rows=group.rows[at], masses_kg=group.masses_kg[at],
            )  # fmt: skip
    return None


def pulled_by(
    structures: Structures, u: Array, hypotheses: tuple[Hypothesis, ...], e: Array, groups: tuple[Group, ...]
) -> list[tuple[int, Side]]:
    """Unknowns that what a hypothesis adds follows from, and groups with that as a step of the unknown has it."""
    problem, found = structures.problem, list[tuple[int, Side]]()
    for one in _apart(hypotheses, e):
        known = leaders(problem, one.hypothesis)
        bare = structures.beside(u, one.others, one.rest) if known else None
        if bare is None:
            continue
        for index in known:
            start, step = beyond(problem, index)
            here, there = (one.beside(problem, u, bare, one.mine, groups, where) for where in (None, start))
            if here is not None and there is not None:
                found.append((index, Side(here, there, step)))
    return found


def _alike(one: tuple[Group, ...], other: tuple[Group, ...]) -> bool:
    return len(one) == len(other) and all(
        a.structure.joints == b.structure.joints and np.array_equal(a.channels, b.channels)
        for a, b in zip(one, other, strict=True)
    )
