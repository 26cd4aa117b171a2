"""What effects make of a run together, in an order that does not hang on how a scenario lists them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from enum import IntEnum

from vgvt.data.plugin import is_bundled, whose_fault
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import Element, GroundSpring
from vgvt.effects.foreign import held_to_contract
from vgvt.effects.point_error import seats, shifted_m
from vgvt.effects.protocol import Effect
from vgvt.scenario.model import Scenario
from vgvt.scenario.points import sensor_points


class Turn(IntEnum):
    """When an effect acts on a scenario: after whatever it is measured by, or takes over.

    An effect says so in a class attribute ``turn``. Without one it acts first: most ask nothing of what others do.
    """

    STATED = 0
    """It adds to, or scales, what is stated."""
    TO_ALL_OF_IT = 1
    """It scales all that the airframe has of something then: every spring of it that is stated, or added."""
    IN_THE_RIG = 2
    """It is a part of the rig as it is then: the surges of a spring that is softer than stated, hung elsewhere."""
    AT_ROOTS = 3
    """It is a share of what a beam is then: a soft root by the compliance of the beam."""
    IN_JOINTS = 4
    """It gives a law to a joint that is there, or is made by then."""


def action_of(effect: Effect, scenario: Scenario, run: int) -> Action:
    """What an effect does to a run (counted from 0) of a scenario.

    PluginError, which names the effect, where one that is not bundled raises anything but InputError, gives no
    Action, or one that it may not give; functions in its Action raise it, too, where they fail. The effect is asked
    for the run that this one counts as (:meth:`~vgvt.scenario.instruments.Acquisition.counted_as`).
    """
    stated = scenario.acquisition
    plan, run = stated.as_counted(run)
    if plan is not stated:
        scenario = scenario.model_copy(update={"acquisition": plan})
    with whose_fault(effect, f"effect {effect.name!r}", f"act(run {run})"):
        action: object = effect.act(scenario, run)
        if not isinstance(action, Action):
            raise TypeError(f"it gave {type(action).__name__}, not an Action")
        if not is_bundled(type(effect).__module__):
            action = held_to_contract(effect, action, scenario, run)
    if plan is stated or action.scenario is None:
        return action
    made = action.scenario
    return replace(action, scenario=made.model_copy(update={"acquisition": made.acquisition.with_runs_of(stated)}))


def acted(
    effects: Sequence[Effect],
    scenario: Scenario,
    run: int,
    act: Callable[[Effect, Scenario, int], Action] = action_of,
) -> tuple[Scenario, tuple[Action, ...]]:
    """The scenario as a run (counted from 0) has it, and what each of the effects does, in the order of ``effects``.

    ``act(effect, scenario, run)`` is :func:`action_of` by default. Turns follow each other; within one, effects act in
    their order. Springs on accelerometers are where the effects together put these.
    """
    actions = [NOTHING] * len(effects)
    for k in sorted(range(len(effects)), key=lambda k: getattr(effects[k], "turn", Turn.STATED)):
        actions[k] = act(effects[k], scenario, run)
        changed = actions[k].scenario
        scenario = scenario if changed is None else changed
    return scenario, _on_sensors(scenario, tuple(actions))


def _on_sensors(scenario: Scenario, actions: tuple[Action, ...]) -> tuple[Action, ...]:
    """The actions with every spring on an accelerometer where that really sits."""
    errors = [e for action in actions for e in action.points]
    astray = {e.node for e in errors}
    if not astray:
        return actions
    places, at = {p.dof.node: p for p in sensor_points(scenario)}, seats(action.points for action in actions)

    def moved(element: Element) -> Element:
        if not isinstance(element, GroundSpring) or element.node is None or element.node not in astray:
            return element
        node = element.node
        seat = places[at.get(node, node)]
        own = [e for e in errors if e.node == node]
        return replace(
            element, part=seat.part, position_m=shifted_m(scenario.airframe, seat.part, seat.position_m, own)
        )

    return tuple(replace(action, elements=tuple(map(moved, action.elements))) for action in actions)
