"""What effects did to scenarios a moment ago: a screen adds thousands of effects to the same few others.

What these do to the same aircraft is the same each time, and an edit of an airframe takes as long as much that follows.
"""

from __future__ import annotations

from functools import lru_cache

from vgvt.effects.acting import action_of
from vgvt.effects.action import Action
from vgvt.effects.protocol import Effect
from vgvt.scenario.model import Scenario

# Some effects in all runs of a campaign; each entry holds on to a scenario.
_KEPT = 128


def action_known(effect: Effect, scenario: Scenario, run: int) -> Action:
    """:func:`~vgvt.effects.acting.action_of`, asked once for the same object of a scenario. To be read, not changed."""
    try:
        hash(effect)
    except TypeError:
        # Not every effect can be hashed: one of somebody else's may hold a list.
        return action_of(effect, scenario, run)
    return _action(effect, _Same(scenario), run)  # type: ignore[arg-type]


class _Same:
    """A scenario that equals itself alone: to compare two takes as long as much of what is asked of them."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and other.scenario is self.scenario

    def __hash__(self) -> int:
        return id(self.scenario)


@lru_cache(maxsize=_KEPT)
def _action(effect: Effect, same: _Same, run: int) -> Action:
    return action_of(effect, same.scenario, run)
