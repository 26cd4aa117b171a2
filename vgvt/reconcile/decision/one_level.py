"""What one level of force cannot settle: whether a name that depends on level is right."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vgvt.reconcile.question.level_grid import bends, several_levels

if TYPE_CHECKING:
    from vgvt.reconcile.decision.attribute import Attribution
    from vgvt.reconcile.evidence.rivals import Rival


def rests_on_one_level(found: Attribution) -> tuple[str, ...]:
    """Names among those that explain the data which depend on level, where every run has the same; else none.

    A sweep passes through many amplitudes, so that one level does show a nonlinear joint; but a wrong damping or a
    linear joint elsewhere bends peaks alike, and only another level says which of them moves.
    """
    names = dict.fromkeys(r.name for r in _nonlinear(found))
    return tuple(names) if names and not several_levels(found.null.problem) else ()


def bends_at_one_level(found: Attribution) -> bool:
    """Whether one of them is a joint whose stiffness depends on level: what it leaves is for a second one to say.

    Anything else that depends on level is foretold as it is about rest, by superposition, and judged by that.
    """
    problem = found.null.problem
    return not several_levels(problem) and any(bends(problem, r.hypothesis) for r in _nonlinear(found))


def _nonlinear(found: Attribution) -> list[Rival]:
    return [r for a in found.rounds for r in (a.winner, *a.alike) if not r.hypothesis.linear]
