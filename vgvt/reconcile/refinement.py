"""What the chain's cells cost, made up for: modal stiffness that gives a coarse chain the frequencies of a fine one.

A chain errs by a few tenths of a per cent in frequency, by another share in each mode. A calibration would put
that into EI and masses. The error is known before any test: it is computed once, from the same scenario with
several times as many cells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from vgvt.data.assurance import modal_assurance
from vgvt.effects.beams import with_beams
from vgvt.scenario.model import Scenario
from vgvt.simulation.reduced import Layouts, Structure, structure

Array = NDArray[np.float64]
_FINER, _MOST_CELLS = 4, 60
_SAME_SHAPE = 0.8


@dataclass(frozen=True, slots=True, eq=False)
class Refinement:
    """What to add to a coarse structure over its coordinates: ``stiffness`` (n, n) and rows ``axis`` (places, n)."""

    places: tuple[str, ...]
    stiffness: Array
    axis: Array


def refinement(scenario: Scenario, layouts: Layouts, coarse: Structure, limit_hz: float) -> Refinement:
    """What makes up for the cells of ``coarse``, the structure of a scenario with its sides written out.

    Stiffness Σ M φ (ω² of the fine chain - own ω²) φᵀ M over the modes up to a limit that both chains have, and
    rows Σ (fine chain's shape - own) φᵀ M: sensors ride on straight links, and the beam between is curved.
    """
    beams = [b.name for b in scenario.airframe.beam]
    cells = max((b.cells for b in scenario.airframe.beam), default=0)
    times = min(_FINER, _MOST_CELLS / max(cells, 1))
    change, rows = np.zeros_like(coarse.stiffness), np.zeros_like(coarse.axis)
    if times <= 1.5:
        return Refinement(coarse.places, change, rows)
    finer = with_beams(scenario, beams, lambda b: b.model_copy(update={"cells": round(times * b.cells)}))
    layout = layouts.plan(finer)
    fine = structure(layout, layout.grid, None)
    own, shapes, seen = _modes(coarse, limit_hz)
    there, _, seen_there = _modes(fine, 1.5 * limit_hz)
    likeness = modal_assurance(seen, seen_there)
    # What the cells still err by at this refinement, in second order, goes along.
    rest = 1 / (1 - 1 / times**2)
    for k, square in enumerate(own):
        match = int(np.argmax(likeness[k]))
        if likeness[k, match] > _SAME_SHAPE and int(np.argmax(likeness[:, match])) == k:
            weight = coarse.mass @ shapes[:, k]
            change += rest * (there[match] - square) * np.outer(weight, weight)
            sign = np.sign(seen[k] @ seen_there[match])
            rows += rest * np.outer(sign * seen_there[match, :-1] - seen[k, :-1], weight)
    return Refinement(coarse.places, change, rows)


def _modes(s: Structure, limit_hz: float) -> tuple[Array, Array, Array]:
    """Squared frequencies (m,), mass-normalised shapes (n, m), and what the points see of them (m, places + 1)."""
    squares, shapes = scipy.linalg.eigh((s.stiffness + s.stiffness.T) / 2, (s.mass + s.mass.T) / 2)
    keep = squares <= (2 * np.pi * limit_hz) ** 2
    shapes = shapes[:, keep]
    return squares[keep], shapes, (np.vstack([s.axis, s.drive]) @ shapes).T
