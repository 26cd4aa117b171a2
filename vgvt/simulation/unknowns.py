"""What a campaign forces any method to fit: the modes of the band, and those outside it that nothing else stands for.

A mode outside the band is an unknown, too, where leaving it to the rest terms would cost more than its unknowns
do; Akaike, IEEE Transactions on Automatic Control 19(6), 1974. At the same price there are more terms for the modes
below.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.simulation.fisher import BACKGROUND, Forces, Lines, background_columns, mode_columns, stacked

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

FURTHER_TERMS = (-3, -2)
"""Powers of s that are added where the modes below the band, rigid-body motions mostly, ask for them."""
_ROUND_OFF = 1e-20


@dataclass(frozen=True, slots=True, eq=False)
class Unknowns:
    """Indices (U,) of the modes whose poles and residues are unknown, in order, and the powers of s of the rest."""

    modes: NDArray[np.intp]
    background: tuple[int, ...]


def unknowns(
    lines: Lines,
    poles: Complex,
    inside: NDArray[np.intp],
    weight: Array,
    responses: Complex,
    forces: Forces | None = None,
) -> Unknowns:
    """The modes ``inside`` (I,) the band, and of all others (poles (M,), rad/s) those that a run asks for.

    ``weight`` (K,) is 4 |F|² / G on the ``lines``, ``responses`` (S, K) the accelerances that are measured; with the
    ``forces`` of all modes 4 / G, and the accelerations. One by one, what takes most of the misfit beyond its price is
    added; a mode has 2 S + 2 unknowns, a power of s has S for each force.
    """
    root = np.sqrt(weight * lines.width_hz)
    outside = np.setdiff1d(np.arange(poles.size), inside)
    blocks = [mode_columns(lines, poles[[k]], _of(forces, [k])) for k in outside]
    further = background_columns(lines, FURTHER_TERMS, forces)
    # A block for each force; where one asks for them, all get them.
    blocks += np.split(further, further.shape[1] // len(FURTHER_TERMS), axis=1)
    prices = np.full(len(blocks), len(FURTHER_TERMS) * len(responses))
    prices[: outside.size] = 2 * len(responses) + 2
    known = mode_columns(lines, poles[inside], _of(forces, inside))
    fixed = np.hstack([known, background_columns(lines, BACKGROUND, forces)])
    candidates = np.array([_unit(stacked(block, root)) for block in blocks])
    misfit = stacked(responses.T, root)
    chosen: list[int] = []
    basis = np.linalg.qr(_unit(stacked(fixed, root)))[0]
    while True:
        misfit = misfit - basis @ (basis.T @ misfit)
        candidates = candidates - basis @ (basis.T @ candidates)
        left = np.linalg.qr(candidates)[0]
        gain = (np.swapaxes(left, 1, 2) @ misfit) ** 2
        # What round-off has left of a candidate stands for nothing.
        told = (candidates**2).sum(axis=1).min(axis=1) > _ROUND_OFF
        worth = np.where(told, gain.sum(axis=(1, 2)), 0.0) - prices
        worth[chosen] = -np.inf
        best = int(np.argmax(worth))
        if worth[best] <= 0:
            break
        chosen.append(best)
        basis = left[best]
    more = max(chosen, default=-1) >= outside.size
    modes = np.union1d(inside, outside[[k for k in chosen if k < outside.size]]).astype(np.intp)
    return Unknowns(modes, (*FURTHER_TERMS, *BACKGROUND) if more else BACKGROUND)


def _of(forces: Forces | None, modes: NDArray[np.intp] | list[int]) -> Forces | None:
    return None if forces is None else forces.of(modes)


def _unit(columns: Array) -> Array:
    size = np.linalg.norm(columns, axis=0)
    return np.asarray(columns / np.where(size > 0, size, 1.0))
