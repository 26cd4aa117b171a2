"""Which points to measure: a greedy start and exchanges on the Fisher information, shapes kept apart.

The criterion is the worst mode's relative deviation of damping (a minimax design; Kammer, J. Guidance
14(2), 1991, chooses sensors by the determinant instead). Shapes must stay distinguishable: no AutoMAC above a limit.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vgvt.data.assurance import auto_mac

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

_RIDGE = 1e-12
_EXCHANGES = 60
_WORTH = 1.0005


def worst_relative_damping(poles: Complex, informations: Array, wanted: NDArray[np.intp]) -> Array:
    """Largest std(ζ)/ζ among the ``wanted`` of poles (U,), for a batch of information matrices (B, 2 U, 2 U), (B,)."""
    count = poles.size
    size = np.sqrt(np.maximum(np.diagonal(informations, axis1=1, axis2=2), 1e-300))
    scaled = informations / size[:, :, None] / size[:, None, :] + _RIDGE * np.eye(2 * count)
    covariance = np.linalg.inv(scaled) / size[:, :, None] / size[:, None, :]
    x, y, radius = poles.real[wanted], poles.imag[wanted], np.abs(poles[wanted])
    a, b = x**2 / radius**3 - 1 / radius, x * y / radius**3
    real, imag = covariance[:, wanted, wanted], covariance[:, count + wanted, count + wanted]
    mixed = covariance[:, wanted, count + wanted]
    variance = np.maximum(a**2 * real + b**2 * imag + 2 * a * b * mixed, 0.0)
    return np.asarray((np.sqrt(variance) / (-x / radius)).max(axis=1))


def least_distinct(shapes: Complex, chosen: NDArray[np.intp]) -> float:
    """Largest AutoMAC off the diagonal of shapes (M, D) at the chosen points (S,); 0 for a single mode."""
    mac = auto_mac(shapes[:, chosen])
    return float((mac - np.diag(np.diag(mac))).max(initial=0.0))


def chosen_points(
    information: Array, poles: Complex, wanted: NDArray[np.intp], shapes: Complex, count: int, largest_mac: float
) -> NDArray[np.intp]:
    """The ``count`` points of (D,) with the best worst mode whose AutoMAC stays below ``largest_mac`` if it can.

    ``information`` (D, 2 U, 2 U) is each point's, ``shapes`` (M, D) of the modes to keep apart.
    """
    if count >= len(information):
        return np.arange(len(information))
    chosen = added_points(information, poles, wanted, (), count)
    return np.sort(_exchanged(chosen, information, poles, wanted, shapes, largest_mac))


def added_points(
    information: Array, poles: Complex, wanted: NDArray[np.intp], kept: Sequence[int], count: int
) -> NDArray[np.intp]:
    """``count`` points of (D,), those ``kept`` and what helps the worst mode most beside them, one after the other."""
    chosen = [int(k) for k in kept]
    total = information[chosen].sum(axis=0)
    while len(chosen) < min(count, len(information)):
        free = np.setdiff1d(np.arange(len(information)), chosen)
        best = free[int(np.argmin(worst_relative_damping(poles, total + information[free], wanted)))]
        chosen.append(int(best))
        total = total + information[best]
    return np.array(chosen, dtype=np.intp)


def _exchanged(
    chosen: NDArray[np.intp],
    information: Array,
    poles: Complex,
    wanted: NDArray[np.intp],
    shapes: Complex,
    largest_mac: float,
) -> NDArray[np.intp]:
    """Swap one point for another while shapes are too alike, then while that helps and keeps them apart."""
    for _ in range(_EXCHANGES):
        total = information[chosen].sum(axis=0)
        now = float(worst_relative_damping(poles, total[None], wanted)[0])
        alike = least_distinct(shapes, chosen)
        free = np.setdiff1d(np.arange(information.shape[0]), chosen)
        out, into = (m.ravel() for m in np.meshgrid(np.arange(chosen.size), free, indexing="ij"))
        after = worst_relative_damping(poles, total - information[chosen[out]] + information[into], wanted)
        swap = _best_swap(chosen, out, into, after, shapes, largest_mac, alike, now)
        if swap is None:
            return chosen
        chosen = chosen.copy()
        chosen[out[swap]] = into[swap]
    return chosen


def _best_swap(
    chosen: NDArray[np.intp],
    out: NDArray[np.intp],
    into: NDArray[np.intp],
    after: Array,
    shapes: Complex,
    largest_mac: float,
    alike: float,
    now: float,
) -> int | None:
    """The swap to make, None for none: one that sets too similar shapes apart, else the best that keeps them so."""
    if alike > largest_mac:
        macs = np.array([least_distinct(shapes, _swapped(chosen, o, i)) for o, i in zip(out, into, strict=True)])
        if macs.min() >= alike - 1e-9:
            return None
        enough = np.flatnonzero(macs <= largest_mac)
        return int(enough[np.argmin(after[enough])]) if enough.size else int(np.argmin(macs))
    for swap in np.argsort(after):
        if after[swap] * _WORTH > now:
            return None
        if least_distinct(shapes, _swapped(chosen, out[swap], into[swap])) <= largest_mac:
            return int(swap)
    return None


def _swapped(chosen: NDArray[np.intp], out: int, into: int) -> NDArray[np.intp]:
    changed = chosen.copy()
    changed[out] = into
    return changed


def dealt(order: list[int], runs: int) -> list[list[int]]:
    """Points in order of worth, dealt to the runs there and back, so that every run gets good ones."""
    hands: list[list[int]] = [[] for _ in range(runs)]
    for k, point in enumerate(order):
        turn, place = divmod(k, runs)
        hands[place if turn % 2 == 0 else runs - 1 - place].append(point)
    return [sorted(hand) for hand in hands]
