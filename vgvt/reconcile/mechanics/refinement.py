"""What the chain's cells cost, made up for: modal stiffness that gives a coarse chain the frequencies of a fine one.

A chain errs by a few tenths of a per cent in frequency, by another share in each mode. A calibration would put
that into EI and masses. The error is known before any test: it is computed once, from the same scenario with
several times as many cells.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from vgvt.data.assurance import modal_assurance
from vgvt.effects.beams import with_beams
from vgvt.scenario.axis import beam_axis
from vgvt.scenario.model import Scenario
from vgvt.simulation.reduced import Layouts, Structure, structure

Array = NDArray[np.float64]
_FINER, _FEWEST_CELLS = 4, 12
MOST_CELLS = 60
"""On the finest beam: more are not worth their time."""
_LONG = 0.5
# Where no more than so many times its cells are worth having, a chain is compared with one of a few more than those.
_HARDLY_FINER, _A_FEW_MORE = 1.5, 1.25
_SAME_SHAPE = 0.8
# Of a mode's frequency, more than what few cells cost: seen at five points one torsion mode looks like another.
_NEAR = 0.25
# Of the limit, three times the band: modes above this are at rest as far as the band goes.
_STATIC = 0.5
# Of the limit: twice the band.
_TOLD = 2 / 3


@dataclass(frozen=True, slots=True, eq=False)
class Refinement:
    """What to add to a structure over its coordinates: ``stiffness``, ``damping`` (n, n), rows ``axis`` (places, n),
    ``drive`` (n,).

    ``flexibility`` (places,), m/N, is what modes too high to be matched give more than the structure's own, at rest.
    ``furthest`` is the largest share of its frequency by which a mode below two thirds of the limit is moved.
    """

    places: tuple[str, ...]
    stiffness: Array
    damping: Array
    axis: Array
    drive: Array
    flexibility: Array
    furthest: float = 0.0

    @classmethod
    def none(cls, own: Structure) -> Refinement:
        """Nothing to add to a structure."""
        return cls(
            own.places,
            np.zeros_like(own.stiffness),
            np.zeros_like(own.damping),
            np.zeros_like(own.axis),
            np.zeros_like(own.drive),
            np.zeros(len(own.places)),
        )

    def less(self, other: Refinement) -> Refinement:
        """The difference of two over the same coordinates."""
        return Refinement(
            self.places,
            self.stiffness - other.stiffness,
            self.damping - other.damping,
            self.axis - other.axis,
            self.drive - other.drive,
            self.flexibility - other.flexibility,
        )


def meshed(scenario: Scenario) -> Scenario:
    """The scenario with at least 12 cells on each long beam: with fewer, placebos are given names."""
    length = {b.name: float(beam_axis(b).arc_length_m[-1]) for b in scenario.airframe.beam}
    few = {
        b.name
        for b in scenario.airframe.beam
        if b.cells < _FEWEST_CELLS and length[b.name] >= _LONG * max(length.values())
    }
    return with_beams(scenario, few, lambda b: b.model_copy(update={"cells": _FEWEST_CELLS})) if few else scenario


def twice_as_fine(scenario: Scenario) -> Scenario | None:
    """The scenario with twice as many cells on every beam; None where that would be more than are worth having."""
    if 2 * max((b.cells for b in scenario.airframe.beam), default=MOST_CELLS) > MOST_CELLS:
        return None
    beams = [b.name for b in scenario.airframe.beam]
    return with_beams(scenario, beams, lambda b: b.model_copy(update={"cells": 2 * b.cells}))


def to_continuum(scenario: Scenario, layouts: Layouts, own: Structure, limit_hz: float) -> Refinement:
    """What ``own``, the structure of a scenario with its sides written out, lacks of a beam without cells."""
    cells = max((b.cells for b in scenario.airframe.beam), default=0)
    times = min(_FINER, MOST_CELLS / max(cells, 1))
    if times <= _HARDLY_FINER:
        # As many cells as are worth having, or nearly.
        return towards(_times_as_fine(scenario, _A_FEW_MORE * max(times, 1.0)), layouts, own, limit_hz)
    finer = _times_as_fine(scenario, times)
    # What the cells still err by at this refinement, in second order, goes along.
    return towards(finer, layouts, own, limit_hz, 1 / (1 - 1 / times**2))


def _times_as_fine(scenario: Scenario, times: float) -> Scenario:
    names = [b.name for b in scenario.airframe.beam]
    return with_beams(scenario, names, lambda b: b.model_copy(update={"cells": round(times * b.cells)}))


def towards(other: Scenario, layouts: Layouts, own: Structure, limit_hz: float, share: float = 1.0) -> Refinement:
    """What gives a structure the modes of the same aircraft cut into other cells, up to a limit that both chains have.

    Stiffness Σ M φ (ω² of the other chain - own ω²) φᵀ M, damping alike at equal modal damping, and rows
    Σ (other chain's shape - own) φᵀ M. ``share`` is by how much what the other chain changes is to be exceeded.
    """
    there = layouts.plan(other)
    target = structure(there, there.grid)
    squares, shapes, seen = _modes(own)
    squares_there, shapes_there, seen_there = _modes(target)
    within = int(np.searchsorted(squares, (2 * np.pi * limit_hz) ** 2))
    within_there = int(np.searchsorted(squares_there, (2 * np.pi * 1.5 * limit_hz) ** 2))
    likeness = modal_assurance(seen[:within], seen_there[:within_there])
    ratio = np.log(np.maximum(squares[:within, None], 1e-9) / np.maximum(squares_there[None, :within_there], 1e-9)) / 2
    likeness[np.abs(ratio) > _NEAR] = 0.0
    found, furthest = Refinement.none(own), 0.0
    stiffness, damping, axis, drive = found.stiffness, found.damping, found.axis, found.drive
    high, high_there = (s > (2 * np.pi * _STATIC * limit_hz) ** 2 for s in (squares, squares_there))
    for k, square in enumerate(squares[:within]):
        match = int(np.argmax(likeness[k]))
        if likeness[k, match] <= _SAME_SHAPE or int(np.argmax(likeness[:, match])) != k:
            continue
        high[k] = high_there[match] = False
        if square < (2 * np.pi * _TOLD * limit_hz) ** 2:
            furthest = max(furthest, abs(ratio[k, match]))
        shape, shape_there = shapes[:, k], shapes_there[:, match]
        weight = own.mass @ shape
        lost = float(shape_there @ target.damping @ shape_there - shape @ own.damping @ shape)
        moved = share * (np.sign(seen[k] @ seen_there[match]) * seen_there[match] - seen[k])
        stiffness += share * (squares_there[match] - square) * np.outer(weight, weight)
        damping += share * lost * np.outer(weight, weight)
        axis += np.outer(moved[:-1], weight)
        drive += moved[-1] * weight
    # Not exceeded: next to the drive it falls with the first power of a cell's length.
    lacking = _at_rest(squares_there, seen_there, high_there) - _at_rest(squares, seen, high)
    return replace(found, flexibility=lacking, furthest=furthest)


def _at_rest(squares: Array, seen: Array, chosen: NDArray[np.bool_]) -> Array:
    """Static flexibility (places,) between drive and places, m/N, of some modes."""
    return np.asarray((seen[chosen, -1] / squares[chosen]) @ seen[chosen, :-1])


def _modes(s: Structure) -> tuple[Array, Array, Array]:
    """Squared frequencies (n,), mass-normalised shapes (n, n), and what places and drive see (n, places + 1)."""
    squares, shapes = scipy.linalg.eigh((s.stiffness + s.stiffness.T) / 2, (s.mass + s.mass.T) / 2)
    return squares, shapes, (np.vstack([s.axis, s.drive]) @ shapes).T
