"""How far a change between runs has come in a run: a line, a decay to a new state, or a step."""

from __future__ import annotations

import math
from typing import Literal

Shape = Literal["linear", "exponential", "step"]


def progress(shape: Shape, run: int, runs: int, time_constant_runs: float, from_run: int) -> float:
    """Fraction of a change in ``run`` (counted from 0) of ``runs``.

    'linear' and 'exponential' go from 0 in the first run to 1 in the last (0 where there is
    only one); 'step' is 1 from ``from_run`` (counted from 1) on.
    """
    if shape == "step":
        return float(run + 1 >= from_run)
    if runs < 2:
        return 0.0
    if shape == "linear":
        return run / (runs - 1)
    return math.expm1(-run / time_constant_runs) / math.expm1(-(runs - 1) / time_constant_runs)


def after(run: int, from_run: int) -> bool:
    """Whether a change at the start of ``from_run`` (counted from 1) has happened in ``run`` (counted from 0)."""
    return run + 1 >= from_run


def check_schedule(time_constant_runs: float, from_run: int) -> None:
    """ValueError for a schedule that is none."""
    if not time_constant_runs > 0:
        raise ValueError("time_constant_runs must be above 0")
    if from_run < 2:
        raise ValueError("from_run must be 2 or more: the first run is what the others are compared with")
