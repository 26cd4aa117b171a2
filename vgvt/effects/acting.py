"""What effects make of a run together, in an order that does not hang on how a scenario lists them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import IntEnum

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.protocol import Effect
from vgvt.scenario.model import Scenario


class Turn(IntEnum):
    """When an effect acts on a scenario: after whatever it is measured by, or takes over.

    An effect says so in a class attribute ``turn``. Without one it acts first: most ask nothing of what others do.
    """

    STATED = 0
    """It adds to, or scales, what is stated."""
    IN_THE_RIG = 1
    """It is a part of the rig as it is then: the surges of a spring that is softer than stated, hung elsewhere."""
    AT_ROOTS = 2
    """It is a share of what a beam is then: a soft root by the compliance of the beam."""
    IN_JOINTS = 3
    """It gives a law to a joint that is there, or is made by then."""


def acted(
    effects: Sequence[Effect],
    scenario: Scenario,
    run: int,
    act: Callable[[Effect, Scenario, int], Action] | None = None,
) -> tuple[Scenario, tuple[Action, ...]]:
    """The scenario as a run (counted from 0) has it, and what each of the effects does, in the order of ``effects``.

    ``act(effect, scenario, run)`` is the effect's own by default. Turns follow each other; within one, effects act in
    their order.
    """
    actions = [NOTHING] * len(effects)
    for k in sorted(range(len(effects)), key=lambda k: getattr(effects[k], "turn", Turn.STATED)):
        actions[k] = effects[k].act(scenario, run) if act is None else act(effects[k], scenario, run)
        changed = actions[k].scenario
        scenario = scenario if changed is None else changed
    return scenario, tuple(actions)
