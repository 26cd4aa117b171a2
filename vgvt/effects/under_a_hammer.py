"""Which effects a hammer test can have: none that act on the shaker, its stinger or its force transducer."""

from __future__ import annotations

from vgvt.data import InputError
from vgvt.effects.acting import action_of
from vgvt.effects.action import Action
from vgvt.effects.elements import MountCompliance, RotationSpring
from vgvt.effects.protocol import Effect, Family
from vgvt.scenario.model import Scenario


def act_on(effect: Effect, scenario: Scenario, run: int) -> Action:
    """What an effect does to a run (counted from 0); InputError where it needs a shaker and there is a hammer."""
    if scenario.excitation.kind != "impact":
        return action_of(effect, scenario, run)
    shaken = InputError(
        f"scenario {scenario.name}: effect {effect.name}",
        "acts on the shaker, its stinger or its force transducer, and a hammer test has none of them",
        "Leave the effect out, or drive the test with a shaker.",
    )
    try:
        action = action_of(effect, scenario, run)
    except InputError as error:
        # What it misses about the shaker is beside the point. An effect that can choose a shaker is on one.
        on_a_shaker = effect.family in (Family.MOUNT, Family.DRIVE_PATH) or hasattr(effect, "shaker")
        raise (shaken if on_a_shaker else error) from error
    if _needs_shaker(action, scenario):
        raise shaken
    return action


def _needs_shaker(action: Action, scenario: Scenario) -> bool:
    """Whether an action is on what a hammer test lacks; one that does not rove hits a moved or leaning drive point."""
    changed = action.scenario or scenario
    roving = scenario.hammer is not None and bool(scenario.hammer.nodes)
    drives = {shaker.node for shaker in scenario.shakers}
    return (
        action.command is not None
        or any(isinstance(element, MountCompliance | RotationSpring) for element in action.elements)
        or (changed.stinger, changed.transducer) != (scenario.stinger, scenario.transducer)
        or (roving and (changed.shakers != scenario.shakers or any(p.node in drives for p in action.points)))
    )
