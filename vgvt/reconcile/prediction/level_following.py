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
_Rows = tuple[NDArray[np.intp], ...]
_Kind = tuple[tuple[int, ...], tuple[int, ...] | None]
_Of = tuple[NDArray[np.intp], _Rows, Array, Levels | None, Matrices, dict[str, Array], Array | None]


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

    def followed(self, measured: Measured, groups: Sequence[_Of], rates: Array) -> tuple[Levels | None, ...]:
        """Levels of groups that follow the unknowns: of each what :func:`slopes_of` is given, and ``rates``.

        They are taken anew also where runs are grouped otherwise than they were, as with a change between them that a
        step has taken back, or joints are no longer what they were.
        """
        kinds = tuple(
            (tuple(channels.tolist()), None if levels is None else levels.shown.shape)
            for channels, _, _, levels, _, _, _ in groups
        )
        if self.taken is None or kinds != self.of:
            self.taken = tuple(
                None
                if levels is None
                else slopes_of(measured, channels, rows, masses_kg, levels, matrices, slopes, rests, rates)
                for channels, rows, masses_kg, levels, matrices, slopes, rests in groups
            )
            self.of = kinds
        joined = zip((g[3] for g in groups), self.taken, strict=True)
        return tuple(None if levels is None else replace(levels, follows=pair) for levels, pair in joined)


def slopes_of(
    measured: Measured,
    channels: NDArray[np.intp],
    rows: tuple[NDArray[np.intp], ...],
    masses_kg: Array,
    levels: Levels,
    matrices: Matrices,
    slopes: dict[str, Array],
    rests: Array | None,
    rates: Array,
) -> _Pair:
    """Slopes (k, R, J, L) of what joints of a group show, and (k, C, L) of what they leave ringing, in k amounts.

    ``channels`` (C,) and the ``rows`` of its runs are the group's, ``masses_kg`` (C,) of its sensors what its
    ``matrices`` do not hold; ``slopes`` are those of the matrices (k or more, …), ``rests`` (k, J) those of where the
    weight holds the joints, rad (None: held), and ``rates`` (k,) the amounts of a stated deviation. What a march that
    runs away would change is held, and how much more one run's sensors weigh on a joint than the others'.
    """
    runs = np.array([measured.channels[channels[own[0]]].run for own in rows])
    shown = np.zeros((rates.size, *levels.shown.shape), dtype=complex)
    left_out = np.zeros((rates.size, *levels.left_out.shape), dtype=complex)
    for k, rate in enumerate(rates):
        step = _STEP * float(rate)
        changes = {name: step * by[k] for name, by in slopes.items()}
        joints = levels.joints if rests is None else levels.joints.turned(step * rests[k])
        if joints is levels.joints and not any(change.any() for change in changes.values()):
            continue
        beside = replace(matrices, **{name: getattr(matrices, name) + change for name, change in changes.items()})
        there = marched_runs(measured, runs, rows, joints, masses_kg, beside)
        if all(np.isfinite(found).all() for found in there):
            shown[k], left_out[k] = (there[0] - levels.shown) / step, (there[1] - levels.left_out) / step
    return shown, left_out
