"""Poles of single runs for modes that all runs together have shown: a roving sensor's mass moves them a little."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import ModalModel
from vgvt_identifiers.common_modes import RunModes
from vgvt_identifiers.fraction_poles import ModePoles
from vgvt_identifiers.merged_claim import merged_claim, merged_pole

_ALIKE = 2.0  # ratio of dampings of one mode in two runs; a run on a node of the mode fits something else there
_MOST, _HARDLY = 0.5, 0.1  # of the runs
_KNOWN = 0.3  # of its own width: a pole that is known less well is no better than the common one


def own_poles(common: ModePoles, own: ModePoles, resolution_rad_s: float) -> tuple[ModePoles, NDArray[np.bool_]]:
    """The common poles (M,) with those of one run in their place where the run tells them well, and where that is (M,).

    A run's pole may lie as far from the common one as its own width; each is used once, the nearest pairs first.
    """
    poles, std = common.poles_rad_s.copy(), common.std_rad_s.copy()
    seen = np.zeros(poles.size, dtype=bool)
    width = np.abs(common.poles_rad_s.real)[:, None]
    distance = np.abs(common.poles_rad_s[:, None] - own.poles_rad_s)
    ratio = np.abs(own.poles_rad_s.real) / width
    known = np.hypot(*own.std_rad_s.T) < _KNOWN * np.abs(own.poles_rad_s.real) + resolution_rad_s
    possible = (distance < width + resolution_rad_s) & (ratio < _ALIKE) & (ratio > 1 / _ALIKE) & known
    taken: set[int] = set()
    for mode, other in sorted(zip(*np.nonzero(possible), strict=True), key=lambda pair: distance[pair]):
        if not seen[mode] and int(other) not in taken:
            poles[mode], std[mode], seen[mode] = own.poles_rad_s[other], own.std_rad_s[other], True
            taken.add(int(other))
    return ModePoles(poles, std), seen


def moved_modes(common: ModePoles, seen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Modes (M,) to drop as the doubles of a neighbour, ``seen`` (runs, M) saying which run tells which by itself.

    A common denominator takes up a mode that moves between runs as two: most
    runs tell the one or the other, hardly a run tells both.
    """
    poles, told = common.poles_rad_s, seen.mean(axis=0)
    width = np.abs(poles.real)
    moved = np.zeros(poles.size, dtype=bool)
    for mode in np.argsort(told, kind="stable"):
        for other in np.flatnonzero(np.abs(poles - poles[mode]) < np.maximum(width, width[mode])):
            either, both = seen[:, mode] | seen[:, other], seen[:, mode] & seen[:, other]
            if other != mode and not moved[other] and either.mean() >= _MOST and both.mean() < _HARDLY:
                moved[mode] = True
    return moved


def claim_of_own_poles(run_modes: tuple[RunModes, ...], seen: NDArray[np.bool_], advice: tuple[str, ...]) -> ModalModel:
    """The modal model of runs that list the same M modes, with poles of their own where ``seen`` (runs, M) says so."""
    modes = run_modes[0].poles.size
    nobody, first = np.logical_not(seen.any(axis=0)), np.arange(len(run_modes)) == 0
    groups = [np.where(first if nobody[i] else seen[:, i], i, -1) for i in range(modes)]
    merged = [merged_pole(run_modes, group) for group in groups]
    flags = tuple(("common_pole",) if alone else p.flags for p, alone in zip(merged, nobody, strict=True))
    omega = 2 * np.pi * np.array([p.natural_frequency_hz for p in merged])
    damping = np.array([p.damping_ratio for p in merged])
    shared = tuple(
        replace(
            m,
            poles=omega * (-damping + 1j * np.sqrt(1 - damping**2)),
            frequency_std_hz=np.array([p.natural_frequency_std_hz for p in merged]),
            damping_ratio_std=np.array([p.damping_ratio_std for p in merged]),
        )
        for m in run_modes
    )
    return merged_claim(shared, poles="common", flags=flags, advice=advice)
