"""Names of what depends on level and is foretold as it is at rest: no record can show that it is such a thing.

Only joints are followed level by level. A mass that rattles is foretold as one on a springy seat, and a mass that is
not in the catalogue is that, too: what such a name gains, it gains by what is linear about it. So it stands where
something linear stands beside it, or a joint that is followed, or where the records hold what no linear structure
makes; alone it is a lead.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vgvt.data.shown import listed
from vgvt.reconcile.question.level_grid import depends_on_level

if TYPE_CHECKING:
    from vgvt.reconcile.decision.addition import Addition
    from vgvt.reconcile.evidence.rivals import Rival
    from vgvt.reconcile.question.problem import Problem


def shows_nothing_of_it(problem: Problem, addition: Addition) -> bool:
    """Whether no record can tell a name, and all that does as well, from what it is at rest."""
    return all(rests(problem, r) for r in (addition.winner, *addition.alike))


def rests(problem: Problem, rival: Rival) -> bool:
    """Whether a rival depends on level, its prediction does not, and no record says that something does.

    A record says so where it holds harmonics that those of its force do not explain.
    """
    hypothesis = rival.hypothesis
    if hypothesis.linear or depends_on_level(problem, hypothesis):
        return False
    return not any(h.unexplained for h in problem.measured.harmonics)


def why_at_rest(rival: Rival) -> str:
    """Why such a name is a lead, and what to do about it, in words."""
    known: Any = rival.hypothesis.cls
    return (
        f"{rival.name} depends on level and is foretold as it is at rest, where it acts like something linear, and no "
        f"record shows it to be more (it is confused with {listed(known.confused_with)}); to tell: "
        f"{known.separating_test}"
    )
