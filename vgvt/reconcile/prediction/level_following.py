"""How what joints show follows the unknowns: one march of every run beside each, for the last steps of a fit.

A joint that slips shows nearly its friction by its motion, and whatever moves a resonance moves that. Held, it makes
slopes in the unknowns wrong by a third and more, and no step along a narrow valley leads down.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.mechanics.response import Matrices
from vgvt.reconcile.prediction.levels import Levels, marched_runs
from vgvt.reconcile.question.data import Measured

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# Of a stated deviation: far below what bends, and above what a step of time makes jump. At ten times as much slopes are
# wrong by 1 to 2 %, which along a valley hides nearly all of what is still to be gained.
_STEP = 3e-4


_Pair = tuple[ComplexArray, ComplexArray]
_Kind = tuple[tuple[int, ...], tuple[int, ...] | None]


@dataclass(frozen=True, slots=True, eq=False)
class Followed:
    """Of a group of runs what its joints' motion follows from; ``levels`` None where none is marched.

    ``channels`` (C,) and the ``rows`` of its runs are the group's, ``masses_kg`` (C,) of its sensors what its
    ``matrices`` do not hold; ``slopes`` are those of the matrices (k or more, …) in k amounts, ``mass_slopes`` (k, C)
    those of these masses, ``rests`` (k, J) those of where the weight holds the joints, rad (None: held).
    """

    channels: NDArray[np.intp]
    rows: tuple[NDArray[np.intp], ...]
    masses_kg: Array
    levels: Levels | None
    matrices: Matrices
    slopes: dict[str, Array]
    mass_slopes: Array
    rests: Array | None

    @property
    def kind(self) -> _Kind:
        """What slopes that were taken earlier must have been taken of."""
        return tuple(self.channels.tolist()), None if self.levels is None else self.levels.shown.shape


@dataclass(slots=True, eq=False)
class Following:
    """What a fit knows of it: slopes of its groups, kept until they are forgotten.

    ``of`` are the channels of those groups and how much their joints show there: of others they say nothing.
    """

    taken: tuple[_Pair | None, ...] | None = None
    of: tuple[_Kind, ...] = ()

    def forget(self) -> None:
        """They are of somewhere else: where they are asked for next they are taken anew."""
        self.taken = None

    def followed(self, measured: Measured, groups: Sequence[Followed], rates: Array) -> tuple[Levels | None, ...]:
        """Levels of groups that follow the unknowns, whose amounts of a stated deviation are ``rates`` (k,).

        They are taken anew also where runs are grouped otherwise than they were, as beside a change between them and
        without it, or joints are no longer what they were.
        """
        kinds = tuple(g.kind for g in groups)
        if self.taken is None or kinds != self.of:
            self.taken = tuple(None if g.levels is None else slopes_of(measured, g, g.levels, rates) for g in groups)
            self.of = kinds
        return tuple(
            None if g.levels is None else replace(g.levels, follows=pair)
            for g, pair in zip(groups, self.taken, strict=True)
        )


def slopes_of(measured: Measured, group: Followed, levels: Levels, rates: Array) -> _Pair:
    """Slopes (k, R, J, L) of what a group's joints show, and (k, C, L) of what they leave ringing, in k amounts.

    ``levels`` are the group's, ``rates`` (k,) the amounts of a stated deviation. What a march that runs away would
    change is held, and how much more one run's sensors weigh on a joint than the others'.
    """
    runs = np.array([measured.channels[group.channels[own[0]]].run for own in group.rows])
    shown = np.zeros((rates.size, *levels.shown.shape), dtype=complex)
    left_out = np.zeros((rates.size, *levels.left_out.shape), dtype=complex)
    for k, rate in enumerate(rates):
        step = _STEP * float(rate)
        changes = {name: step * by[k] for name, by in group.slopes.items()}
        joints = levels.joints if group.rests is None else levels.joints.turned(step * group.rests[k])
        masses = group.masses_kg + step * group.mass_slopes[k]
        still = joints is levels.joints and not group.mass_slopes[k].any()
        if still and not any(change.any() for change in changes.values()):
            continue
        moved = {name: getattr(group.matrices, name) + change for name, change in changes.items()}
        beside = replace(group.matrices, **moved)
        there = marched_runs(measured, runs, group.rows, joints, masses, beside)
        if all(np.isfinite(found).all() for found in there):
            shown[k], left_out[k] = (there[0] - levels.shown) / step, (there[1] - levels.left_out) / step
    return shown, left_out
