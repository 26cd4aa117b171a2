"""Where to look for effects that depend on level: no closed form gives their size, so a coarse grid over their ranges.

At vanishing size such an effect is not absent: a joint that hardly stiffens is still a joint.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from vgvt.data import InputError
from vgvt.effects.acting import action_of
from vgvt.effects.elements import HingedFlap, JointLaw
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem

# Shares of a plausible range, in its own scale: the first for what says how big the effect is, the second for the rest.
_SIZES, _OTHERS = (0.2, 0.5, 0.8), (0.3, 0.7)
_ANOTHER_LEVEL = 1.3


def depends_on_level(problem: Problem, hypothesis: Hypothesis) -> bool:
    """Whether the prediction knows a nonlinear joint in what a hypothesis adds."""
    return any(isinstance(e, JointLaw) for e in _elements(problem, hypothesis))


def bends(problem: Problem, hypothesis: Hypothesis) -> bool:
    """Whether a hypothesis adds a joint whose stiffness depends on level, known to the prediction or not."""
    elements = _elements(problem, hypothesis)
    return any(isinstance(e, JointLaw) or (isinstance(e, HingedFlap) and e.gap_rad > 0) for e in elements)


def _elements(problem: Problem, hypothesis: Hypothesis) -> tuple[object, ...]:
    """What a nonlinear hypothesis adds to the first run, in the middle of its range; nothing for a linear one."""
    if hypothesis.linear:
        return ()
    effect = hypothesis.effect({p.name: p.at(0.5) for p in hypothesis.parameters})
    if effect is None:
        return ()
    try:
        return tuple(action_of(effect, problem.scenario, 0).elements)
    except (InputError, ValueError):
        return ()


def level_grid(hypothesis: Hypothesis) -> list[dict[str, float]]:
    """Parameter values to try."""
    choices = [
        [(p.name, p.at(share)) for share in (_SIZES if p.neutral is not None else _OTHERS)]
        for p in hypothesis.parameters
    ]
    return [dict(values) for values in itertools.product(*choices)]


def several_levels(problem: Problem) -> bool:
    """Whether some run shook harder than another, by more than a drive that is left alone."""
    size = problem.measured.level_n
    return bool(size.max() > _ANOTHER_LEVEL * size.min())


def linear_first(problem: Problem, hypotheses: Sequence[Hypothesis]) -> tuple[list[Hypothesis], list[Hypothesis]]:
    """Hypotheses to try at once, and those that can wait: at one level, joints whose stiffness depends on it.

    There one variant of an effect is enough: each costs marches over whole records, and whichever variant it is, the
    verdict will ask for another level.
    """
    if several_levels(problem):
        return list(hypotheses), []
    at_once: list[Hypothesis] = []
    later: dict[str, Hypothesis] = {}
    for hypothesis in hypotheses:
        if hypothesis.name in later:
            continue
        if bends(problem, hypothesis):
            later[hypothesis.name] = hypothesis
        else:
            at_once.append(hypothesis)
    return at_once, list(later.values())
