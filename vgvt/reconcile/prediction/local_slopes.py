"""How matrices change with the unknowns where a fit has wandered far from the scenario as stated.

Matrices are nearly straight in factors and shifts, so the derivatives of the bare aircraft at its stated values serve
within the tolerances. A calibration that imitates a missing effect leaves them by tens of standard deviations: the
aircraft then hangs otherwise, and a slope taken at home points elsewhere. On the way back from there an effect takes
over, and what it adds moves the masses, too: a wing that turns at its root swings all of its winglet.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.acting import action_of
from vgvt.reconcile.prediction.grouping import Group, assembled, changed_places, home
from vgvt.reconcile.question.data import MeasuredChannel
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import MATRICES, Problem
from vgvt.reconcile.question.uncertain import Unknown
from vgvt.scenario.airframe import Airframe
from vgvt.scenario.mirror import expanded_beams
from vgvt.simulation.reduced import Structure

Array = NDArray[np.float64]
# Standard deviations within which slopes serve: at ten times as many they are wrong by half of themselves.
SERVE = 5.0
# Scores' distance from where slopes were taken at which they may mislead. Far out the way is long and every tangent
# rough: a share of the way, then.
_AWAY, _AWAY_SHARE = 1.0, 0.25
_STEP = 0.02
# Scores' distance to which slopes of the whole aircraft are the same.
_SAME = 0.1
# Of an effect's range: a root of this softness is some per cent of what a wing gives; and scores that change it little.
_MUCH, _AS_LOOSE = 0.1, 0.3
# One for each start of a round's fits, and a few on their way.
_KEPT = 6


@dataclass(frozen=True, slots=True, eq=False)
class Origin:
    """Where slopes were taken: scores ``u`` (problem.size,) and those of the hypotheses, ``e``.

    ``whole`` where they were taken of the aircraft with all that the hypotheses do to it.
    """

    u: Array
    e: Array
    whole: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class LocalSlopes:
    """Changes per unit of each unknown's amount, by name of the matrix, (unknowns, …) over ``joints`` and ``places``.

    Where they are not the problem's own, the ``equilibrium`` (unknowns, joints) is among the values.
    ``channels`` are those of the group of runs that they belong to, None for all; ``whole`` as in their origin.
    """

    joints: tuple[str, ...]
    places: tuple[str, ...]
    values: dict[str, Array]
    channels: NDArray[np.intp] | None = None
    whole: bool = False

    def rows(self, places: Sequence[str]) -> list[int]:
        """Indices of a structure's places: a misplaced sensor borrows those of its home."""
        return [self.places.index(p if p in self.places else home(p)) for p in places]

    def rests(self, joints: Sequence[str]) -> Array:
        """Changes (unknowns, n) of where the weight holds n joints; zeros where these, or that, are not known."""
        found = np.zeros((self.values["drive"].shape[0], len(joints)))
        if "equilibrium" in self.values:
            for k, joint in enumerate(joints):
                if joint in self.joints:
                    found[:, k] = self.values["equilibrium"][:, self.joints.index(joint)]
        return found


def origin_at(problem: Problem, u: Array, e: Array, hypotheses: tuple[Hypothesis, ...] = ()) -> Origin | None:
    """Where slopes that serve at u and e are to be taken: None for the problem's own, or here."""
    wandered = float(np.abs(u[: len(problem.unknowns)] - problem.at).max(initial=0.0))
    return None if wandered <= SERVE and not _loose(problem, hypotheses, e) else Origin(u.copy(), e.copy())


def from_elsewhere(
    problem: Problem, u: Array, e: Array, origin: Origin | None, hypotheses: tuple[Hypothesis, ...] = ()
) -> bool:
    """Whether slopes taken at an ``origin``, None for the problem's own, may be what misleads at u and e."""
    known = slice(0, len(problem.unknowns))
    wandered = np.abs(u[known] - problem.at).max(initial=0.0)
    if origin is None:
        return bool(wandered > _AWAY) or _loose(problem, hypotheses, e)
    away = np.abs(u - origin.u)[known].max(initial=0.0)
    if away > max(_AWAY, _AWAY_SHARE * wandered):
        return True
    return bool(np.abs(e - origin.e).max(initial=0.0) > _AS_LOOSE and _loose(problem, hypotheses, e))


def whole_near(u: Array, e: Array, last: Origin | None) -> Origin:
    """Where slopes of the whole aircraft are to be taken: the ``last`` place, or here where that is some way off."""
    if last is not None and last.whole and last.e.size == e.size:
        moved = np.concatenate([u - last.u, e - last.e])
        if np.abs(moved).max(initial=0.0) <= _SAME:
            return last
    return Origin(u.copy(), e.copy(), whole=True)


def _loose(problem: Problem, hypotheses: tuple[Hypothesis, ...], e: Array) -> bool:
    """Whether an effect holds a part by a joint that gives way a lot: what each unknown moves is then something else.

    Where the effect is fitted, that is; a stand that is only looked at has the slopes that it was fitted with.
    """
    start = 0
    for hypothesis in hypotheses:
        stop = start + len(hypothesis.parameters)
        scores, start = e[start:stop], stop
        values = hypothesis.values(scores)
        # A joint with a law of its own is there at any size of that law.
        much = any(
            p.neutral is None or abs(values[p.name] - p.neutral) > _MUCH * (p.high - p.neutral)
            for p in hypothesis.parameters
        )
        look = _held if much else _in_pieces
        if hypothesis.parameters and _edited_airframes(problem, hypothesis, scores, look):
            return True
    return False


def _in_pieces(airframe: Airframe) -> tuple[bool, int]:
    """Whether the body is in two halves, and how many items hang on hinges.

    However stiffly they do: halves have a body's inertia between them, and a surface's mode is where its hinge has it.
    """
    return airframe.body.carry_through_stiffness_n_m_per_rad is not None, len(airframe.hinged)


def _held(airframe: Airframe) -> tuple[bool, int, list[tuple[bool, bool]]]:
    """That, and which roots are rigid in bending and in torsion."""
    roots = [
        (b.root_bending_stiffness_n_m_per_rad is None, b.root_torsional_stiffness_n_m_per_rad is None)
        for b in expanded_beams(airframe)
    ]
    return *_in_pieces(airframe), roots


def slopes_for(
    problem: Problem, hypotheses: tuple[Hypothesis, ...], origin: Origin | None, group: Group
) -> LocalSlopes:
    """The slopes that serve one group of runs: the problem's own where there is no ``origin``.

    Left out, unless they are those of the ``whole``, are effects whose values are fixed, which are only looked at, and
    those that leave the aircraft's own coordinates alone: what is hung on it moves with it, whatever the unknowns are.
    """
    own = LocalSlopes(problem.nominal.joints, problem.nominal.places, problem.slopes)
    if origin is None:
        return own
    kept, scores = [], []
    ends = np.cumsum([0, *(len(h.parameters) for h in hypotheses)])
    for hypothesis, start, stop in zip(hypotheses, ends[:-1], ends[1:], strict=True):
        if origin.whole or (hypothesis.parameters and _edited_airframes(problem, hypothesis, origin.e[start:stop])):
            kept.append(hypothesis)
            scores.append(origin.e[start:stop])
    e = np.concatenate([np.zeros(0), *scores])
    asked = _Asked(
        problem, id(problem.start), problem.unknowns, problem.measured.channels, tuple(kept), origin.u.tobytes(),
        e.tobytes(), origin.whole,
    )  # fmt: skip
    for found in _slopes(asked):
        covers = found.channels is None or bool(np.isin(group.channels, found.channels).all())
        if covers and set(found.joints) <= set(group.structure.joints):
            return found
    return own


def _edited_airframes(
    problem: Problem, hypothesis: Hypothesis, scores: Array, look: Callable[[Airframe], object] = lambda a: a
) -> bool:
    """Whether an effect edits the airframe in any run, as far as ``look`` looks: coordinates may be others then.

    One that refuses the aircraft as stated edits nothing of it.
    """
    effect, stated = hypothesis.effect(hypothesis.values(scores)), problem.start.scenario
    if effect is None:
        return False
    try:
        edited = [action_of(effect, stated, run).scenario for run in range(len(problem.measured.runs))]
    except ValueError:
        return False
    return any(s is not None and look(s.airframe) != look(stated.airframe) for s in edited)


@dataclass(frozen=True, slots=True)
class _Asked:
    """What slopes are taken of: an aircraft with its channels, whatever these have measured, and where."""

    problem: Problem = field(compare=False)
    start: int
    unknowns: tuple[Unknown, ...]
    channels: tuple[MeasuredChannel, ...]
    hypotheses: tuple[Hypothesis, ...]
    u: bytes
    e: bytes
    whole: bool


@lru_cache(maxsize=_KEPT)
def _slopes(asked: _Asked) -> tuple[LocalSlopes, ...]:
    problem, hypotheses, whole = asked.problem, asked.hypotheses, asked.whole
    origin, scores = np.frombuffer(asked.u), np.frombuffer(asked.e)
    here = assembled(problem, origin, hypotheses, scores)
    if here is None:
        return ()
    count, names = len(problem.unknowns), (*MATRICES, "equilibrium")
    found = [{n: np.zeros((count, *getattr(g.structure, n).shape)) for n in names} for g in here]
    for k, unknown in enumerate(problem.unknowns):
        for step in (_STEP, -_STEP):
            aside = origin.copy()
            aside[k] += step
            span = unknown.amount(float(aside[k])) - unknown.amount(float(origin[k]))
            # As far as a bounded quantity goes: no score beyond changes anything.
            there = assembled(problem, aside, hypotheses, scores) if span else here
            if there is None or not all(map(_alike, here, there)):
                if step < 0:
                    # Across the edge, then.
                    break
                # No such aircraft a step further: the stated values must do.
                return ()
            for own, one, other in zip(found, here, there, strict=True):
                for name, values in own.items():
                    values[k] = (getattr(other.structure, name) - getattr(one.structure, name)) / (span or 1.0)
            if not changed_places(here, there):
                break
    return tuple(
        LocalSlopes(g.structure.joints, g.structure.places, own, g.channels, whole)
        for g, own in zip(here, found, strict=True)
    )


def _alike(one: Group, other: Group) -> bool:
    a: Structure = one.structure
    b: Structure = other.structure
    return a.joints == b.joints and a.places == b.places and np.array_equal(one.channels, other.channels)
