"""Which of several shakers an effect is on: one of them by its number, or all."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

from vgvt.data import InputError
from vgvt.scenario.mirror import part_name
from vgvt.scenario.model import Scenario
from vgvt.scenario.planform import slid_m
from vgvt.scenario.rig import Shaker


def shaker_choice() -> Any:
    """The field of an effect that says which shaker it is on."""
    return dataclasses.field(default=0, metadata={"doc": "which shaker, counted from 1; 0 for all"})


def chosen_shakers(scenario: Scenario, shaker: int, effect: str) -> tuple[int, ...]:
    """Positions in ``scenario.shakers`` of the shaker of a number, or of all; InputError where there is none."""
    count = len(scenario.shakers)
    if not 0 <= shaker <= count:
        numbers = "0 or 1" if count == 1 else f"a number from 1 to {count}, or 0 for all"
        where = f"scenario {scenario.name}: effect {effect}: shaker"
        raise InputError(where, f"is {shaker}, and the scenario has {count}", f"Write {numbers}.")
    return tuple(range(count)) if shaker == 0 else (shaker - 1,)


def with_shakers(scenario: Scenario, chosen: tuple[int, ...], change: Callable[[Shaker], Shaker]) -> Scenario:
    """The scenario with some of its shakers changed."""
    first, *further = (change(s) if k in chosen else s for k, s in enumerate(scenario.shakers))
    return scenario.model_copy(update={"shaker": first, "further_shaker": tuple(further)})


def moved_on_its_part(scenario: Scenario, shaker: Shaker, dx_m: float, dy_m: float) -> Shaker:
    """The shaker with its drive point (dx, dy) further along the surface that it pushes, up or down with that."""
    part = part_name(scenario.airframe, shaker.attached_to, shaker.position_m[1])
    return shaker.model_copy(update={"position_m": slid_m(scenario.airframe, part, shaker.position_m, dx_m, dy_m)})
