"""Where a beam is cut into cells: evenly, but that its axis bends, and a shaker pushes, between two and not within one.

A cell gives way about one axis. What it held of the other side of a bend would give way about a wrong one, which is an
error of first order in its length. A chain twists in steps, one a cell, and has its beam's twist only where cells meet:
what pushed elsewhere would work on another twist, an error of first order, too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.airframe import MOST_CELLS, Beam
from vgvt.scenario.axis import Axis, beam_axis

# Half of it each way from its mean, and up to a sixteenth of a cell's compliance is about a wrong axis.
_SHARP_RAD = 0.5
_ROUNDING = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """The cells of a beam: arc lengths ``edges_m`` (K + 1,), and by what angle the axis bends in each, (K,).

    To be read and not changed.
    """

    edges_m: NDArray[np.float64]
    bent_rad: NDArray[np.float64]


def cells_of(beam: Beam, pushed_m: tuple[float, ...] = ()) -> Cells:
    """The cells of a beam that is pushed at some arc lengths; its mirror image has the same.

    Bends of less than half a degree are let be. No cell is shorter than half or longer than twice the even one: of
    bends that are nearer than that one to each other, or to an end of the beam, the sharpest lies between two cells;
    and so does every pushed point that is not nearer than half of it to an end, such a bend or one before it.
    """
    return _cells(beam_axis(beam), beam.cells, pushed_m)


def bent_within_a_cell(beam: Beam) -> str | None:
    """What is to be said of a beam, mirrored or not, that is cut too coarsely for its bends; None where it is not."""
    axis, bent = beam_axis(beam), cells_of(beam).bent_rad.max()
    if bent <= _SHARP_RAD:
        return None
    more = range(beam.cells + 1, MOST_CELLS + 1)
    enough = next((n for n in more if _cells(axis, n).bent_rad.max() <= _SHARP_RAD), None)
    advice = "draw its axis with fewer stations" if enough is None else f"write cells = {enough}, not {beam.cells}"
    return (
        f"the axis of beam {beam.name!r} bends by {math.degrees(bent):.0f}° within one of its cells, which "
        f"gives way about its mean direction; {advice}"
    )


# Thousands of variants of one aircraft differ in stiffness and mass, not in where their beams lie.
@lru_cache(maxsize=128)
def _cells(axis: Axis, cells: int, pushed_m: tuple[float, ...] = ()) -> Cells:
    frames = np.stack([axis.tangent, axis.normal, np.cross(axis.tangent, axis.normal)], axis=1)
    turned = np.linalg.matrix_norm(frames[1:] - frames[:-1]) / math.sqrt(8)
    bends, arcs = 2 * np.arcsin(np.minimum(turned, 1.0)), axis.arc_length_m
    edges = _edges(arcs[1:-1], np.round(np.degrees(bends)), float(arcs[-1]), cells, pushed_m)
    within = ~np.isin(arcs[1:-1], edges)
    bent = np.zeros(cells)
    np.add.at(bent, np.searchsorted(edges, arcs[1:-1][within]) - 1, bends[within])
    return Cells(edges, bent)


def _edges(
    arcs_m: NDArray[np.float64],
    bends_deg: NDArray[np.float64],
    length_m: float,
    cells: int,
    pushed_m: Sequence[float],
) -> NDArray[np.float64]:
    """Arc lengths (cells + 1,) of the edges, given the bends and where they are, (B,) each, and where it is pushed."""
    ends, even = [0.0, length_m], length_m / cells
    # The sharpest first; of equal ones, as they are on an arc, those next to the root.
    for k in np.argsort(-bends_deg, kind="stable")[: np.count_nonzero(bends_deg)]:
        if np.abs(np.array(ends) - arcs_m[k]).min() >= (1 - _ROUNDING) * even:
            ends.append(float(arcs_m[k]))
    edges = _divided(ends, cells)
    for arc in pushed_m:
        if len(ends) <= cells and np.abs(np.array(ends) - arc).min() >= (1 - _ROUNDING) * 0.5 * even:
            tried = _divided([*ends, arc], cells)
            if np.diff(tried).max() <= (1 + _ROUNDING) * 2 * even:
                ends, edges = [*ends, arc], tried
    return edges


def _divided(ends_m: Sequence[float], cells: int) -> NDArray[np.float64]:
    """Arc lengths (cells + 1,) of edges that hold all of some ends, as evenly as these let them be."""
    ends = sorted(ends_m)
    pieces = np.diff(ends)
    counts = np.ones(pieces.size, dtype=int)
    while counts.sum() < cells:
        counts[np.argmax(pieces / counts)] += 1
    inner = [np.linspace(ends[i], ends[i + 1], n + 1)[:-1] for i, n in enumerate(counts)]
    return np.concatenate([*inner, ends[-1:]])
