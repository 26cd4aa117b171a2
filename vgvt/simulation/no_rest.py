"""What to change in an aircraft that does not hang still: the hook, or what gives way under its weight."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.scenario.model import Scenario


def no_rest(scenario: Scenario, centre_of_gravity_m: NDArray[np.float64], problem: str) -> InputError:
    """The error of a scenario whose aircraft, with its centre of gravity (3,), comes to no rest for a reason."""
    hook_m = scenario.suspension.hook_m
    if hook_m[2] > centre_of_gravity_m[2]:
        return InputError(
            f"scenario {scenario.name}: airframe and effects",
            f"{problem}, though the hook is above the centre of gravity",
            "Make stiffer what gives way under its weight: roots of beams, what effects put on springs or let play.",
        )
    hook, cg = (tuple(round(float(x), 3) for x in place) for place in (hook_m, centre_of_gravity_m))
    return InputError(
        f"scenario {scenario.name}: suspension.hook_m",
        f"{problem} with the hook at {hook} m",
        f"Put the hook above the centre of gravity, which is at {cg} m.",
    )
