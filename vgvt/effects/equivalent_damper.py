"""A loss factor as the viscous damper that loses as much in a cycle at one frequency."""

from __future__ import annotations

import math


def equivalent_damper(stiffness: float, loss_factor: float, frequency_hz: float) -> float:
    """Damper c = η k / ω in parallel with a spring k; units of the stiffness times second.

    Equal loss a cycle, π η k X² = π c ω X² (Ewins, Modal Testing, 2nd ed., chapter 2).
    """
    return loss_factor * stiffness / (2 * math.pi * frequency_hz)
