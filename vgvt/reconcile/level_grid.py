"""Where to look for effects that depend on level: no closed form gives their size, so a coarse grid over their ranges.

At vanishing size such an effect is not absent: a joint that hardly stiffens is still a joint.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from vgvt.data import InputError
from vgvt.effects.elements import JointLaw
from vgvt.effects.parameter import Parameter
from vgvt.reconcile.hypothesis import Hypothesis
from vgvt.reconcile.problem import Problem

# Shares of a plausible range, in its own scale: the first for what says how big the effect is, the second for the rest.
_SIZES, _OTHERS = (0.2, 0.5, 0.8), (0.3, 0.7)
_ANOTHER_LEVEL = 1.3


def depends_on_level(problem: Problem, hypothesis: Hypothesis) -> bool:
    """Whether the prediction knows a nonlinear joint in what a hypothesis adds."""
    if hypothesis.linear:
        return False
    effect = hypothesis.effect({p.name: _share(p, 0.5) for p in hypothesis.parameters})
    if effect is None:
        return False
    try:
        elements = effect.act(problem.scenario, 0).elements
    except (InputError, ValueError):
        return False
    return any(isinstance(e, JointLaw) for e in elements)


def level_grid(hypothesis: Hypothesis) -> list[dict[str, float]]:
    """Parameter values to try."""
    choices = [
        [(p.name, _share(p, share)) for share in (_SIZES if p.neutral is not None else _OTHERS)]
        for p in hypothesis.parameters
    ]
    return [dict(values) for values in itertools.product(*choices)]


def several_levels(problem: Problem) -> bool:
    """Whether some run shook harder than another, by more than a drive that is left alone."""
    size = np.sqrt(np.mean(np.abs(problem.measured.force) ** 2, axis=1))
    return bool(size.max() > _ANOTHER_LEVEL * size.min())


def worth_trying(problem: Problem, hypotheses: Sequence[Hypothesis]) -> list[Hypothesis]:
    """Hypotheses without what one level cannot tell apart anyway: there, one variant of a nonlinear effect is enough.

    Each costs marches over whole records, and the verdict will ask for another level whichever variant it is.
    """
    if several_levels(problem):
        return list(hypotheses)
    found: list[Hypothesis] = []
    for hypothesis in hypotheses:
        twins = any(known.name == hypothesis.name for known in found)
        if not (twins and depends_on_level(problem, hypothesis)):
            found.append(hypothesis)
    return found


def _share(p: Parameter, share: float) -> float:
    if p.scale == "log":
        return math.exp((1 - share) * math.log(p.low) + share * math.log(p.high))
    return (1 - share) * p.low + share * p.high
