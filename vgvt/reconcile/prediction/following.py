"""What an effect adds may follow from the aircraft it is added to: a spring's surge from the spring's stiffness.

A step of that unknown then moves more than its own matrices, and a slope without that leads a fit astray: where peaks
are sharp it stops beside the bottom, as no step that it can think of leads down.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from vgvt.data import InputError
from vgvt.effects.acting import action_of
from vgvt.effects.elements import Element
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Nominal, Problem

_STEP = 0.02


@lru_cache(maxsize=4096)
def leaders(problem: Problem, hypothesis: Hypothesis) -> tuple[int, ...]:
    """Indices of the unknowns that what a hypothesis adds follows from.

    None of an effect that edits the scenario: what that does follows from everything.
    """
    effect = hypothesis.effect(hypothesis.values(np.zeros(len(hypothesis.parameters))))
    if effect is None:
        return ()

    def added(start: Nominal) -> tuple[Element, ...] | None:
        try:
            action = action_of(effect, start.scenario, len(problem.measured.runs) - 1)
        except (InputError, ValueError):
            return None
        return action.elements if action.scenario is None else None

    stated = added(problem.start)
    if not stated:
        return ()
    moved = (added(beyond(problem, k)[0]) for k in range(len(problem.unknowns)))
    return tuple(k for k, elements in enumerate(moved) if elements is not None and elements != stated)


@lru_cache(maxsize=512)
def beyond(problem: Problem, index: int) -> tuple[Nominal, float]:
    """The aircraft as stated but for one unknown a little further, and by how much of its amount."""
    unknown, start = problem.unknowns[index], problem.start
    scenario = unknown.edit(start.scenario, unknown.amount(_STEP))
    return Nominal(scenario, start.layouts, start.structure), unknown.change(_STEP)
