"""Changes between runs that differ in their course alone: one derivative serves every course.

To first order a change that has come so far in a run does that share of what the whole of it does there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.effects.acting import action_of
from vgvt.effects.action import Action
from vgvt.effects.parameter import Parameter
from vgvt.effects.run_schedule import Shape, progress
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem

# The first run is what the others are compared with: a step there touches every run that any course can.
_WHOLE = 2


def whole_and_shares(
    problem: Problem, hypothesis: Hypothesis, values: dict[str, float], p: Parameter, size: float
) -> tuple[Hypothesis, NDArray[np.float64]] | None:
    """The variant in which all has happened by the second run, and the share (runs,) of it that this one has in each.

    ``values`` are those of all parameters but the size ``p``, which is ``size`` off its neutral value at the end. None
    for what is no change between runs, acts on channels, or is not in every run what the whole is at a share of its
    size.
    """
    settings = dict(hypothesis.settings)
    if "from_run" not in settings and "shape" not in settings:
        return None
    course = hypothesis.effect({**values, p.name: p.neutral or 0.0})
    if course is None:
        return None
    runs = len(problem.measured.runs)
    shape: Shape = getattr(course, "shape", "step")
    told = (getattr(course, "time_constant_runs", 1.0), getattr(course, "from_run", _WHOLE))
    shares = np.array([progress(shape, run, runs, *told) for run in range(runs)])
    if hasattr(course, "shape"):
        settings["shape"] = "step"
    whole = replace(hypothesis, settings={**settings, "from_run": _WHOLE})
    for run, share in enumerate(shares):
        amounts = ((hypothesis, size), (whole, size * float(share)))
        pair = [_action(problem, h, {**values, p.name: (p.neutral or 0.0) + amount}, run) for h, amount in amounts]
        if pair[0] is None or pair[1] is None or pair[0].channels or not pair[0].same_rig(pair[1]):
            return None
    return whole, shares


def _action(problem: Problem, hypothesis: Hypothesis, values: dict[str, float], run: int) -> Action | None:
    effect = hypothesis.effect(values)
    try:
        return None if effect is None else action_of(effect, problem.scenario, run)
    except (InputError, ValueError):
        return None
