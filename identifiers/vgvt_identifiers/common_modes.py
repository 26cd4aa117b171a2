"""Recognises the modes of one run in the others, by their poles and, where DOFs are shared, their shapes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Dof, modal_assurance

_STANDARD_DEVIATIONS = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class RunModes:
    """The modes of one run: poles (M,) rad/s, upper half plane, and receptance residues (M, R) over its responses.

    Standard deviations (M,) are NaN where unknown; infinite ones mark poles that were not estimated here.
    ``covariance`` (2 M, 2 M), where known, is that of all frequencies in Hz, then all damping ratios; zero
    rows mark poles that were not estimated.
    """

    run: int
    reference: Dof
    responses: tuple[Dof, ...]
    poles: NDArray[np.complex128]
    residues: NDArray[np.complex128]
    frequency_std_hz: NDArray[np.float64]
    damping_ratio_std: NDArray[np.float64]
    covariance: NDArray[np.float64] | None = None

    def __post_init__(self) -> None:
        modes = self.poles.size
        for name, shape in (
            ("residues", (modes, len(self.responses))),
            ("frequency_std_hz", (modes,)),
            ("damping_ratio_std", (modes,)),
        ):
            if getattr(self, name).shape != shape:
                raise ValueError(f"run {self.run}: {name} must be {shape}, got {getattr(self, name).shape}")


def common_modes(run_modes: tuple[RunModes, ...], tolerance: float = 0.02, least_mac: float = 0.5) -> NDArray[np.intp]:
    """Groups (M, runs) of modes that are one mode: its index in every run, -1 where a run lacks it.

    The run that the others agree with best is the template: each pairs its modes with the template's,
    one to one and all at once, so that a shift common to all modes of a run does no harm. Modes left
    over are grouped in the same way. The order of the runs does not matter.
    """
    owner = np.concatenate([np.full(m.poles.size, i) for i, m in enumerate(run_modes)])
    inner = np.concatenate([np.arange(m.poles.size) for m in run_modes])
    gain = _gains(run_modes, owner, inner, tolerance, least_mac)
    left = np.ones(owner.size, bool)
    rows: list[NDArray[np.intp]] = []
    while left.any():
        tables = [_paired(gain, owner, left, template) for template in range(len(run_modes))]
        table = max(tables, key=lambda t: t[0])[1]
        left[table[table >= 0]] = False
        rows.extend(table)
    return np.array([np.where(row >= 0, inner[row], -1) for row in rows])


def _paired(
    gain: NDArray[np.float64], owner: NDArray[np.intp], left: NDArray[np.bool_], template: int
) -> tuple[float, NDArray[np.intp]]:
    """Total gain of one run as template, and which mode of every run belongs to each of its modes, (M, runs)."""
    from scipy.optimize import linear_sum_assignment

    own = np.flatnonzero(left & (owner == template))
    table = np.full((own.size, int(owner.max()) + 1), -1)
    table[:, template] = own
    total = float(own.size)
    for run in range(table.shape[1]):
        theirs = np.flatnonzero(left & (owner == run))
        if run == template or not theirs.size:
            continue
        part = gain[np.ix_(own, theirs)]
        for i, j in zip(*linear_sum_assignment(part, maximize=True), strict=True):
            if part[i, j] > 0:
                table[i, run] = theirs[j]
                total += float(part[i, j])
    return total, table


def _gains(
    run_modes: tuple[RunModes, ...],
    owner: NDArray[np.intp],
    inner: NDArray[np.intp],
    tolerance: float,
    least_mac: float,
) -> NDArray[np.float64]:
    """Worth of pairing two modes (N, N): 2 less their pole distance over the largest allowed, 0 where they cannot."""
    poles = np.concatenate([m.poles for m in run_modes])
    std = np.concatenate([_pole_std(m) for m in run_modes])
    size = (np.abs(poles)[:, None] + np.abs(poles)) / 2
    distance = np.abs(poles[:, None] - poles) / size
    # Poorly known poles may lie further apart, but never so far that they are somebody else's.
    allowed = np.clip(_STANDARD_DEVIATIONS * np.hypot(std[:, None], std) / size, tolerance, 2 * tolerance)
    gain = np.where((distance > allowed) | (owner[:, None] == owner), 0.0, 2.0 - distance / allowed)
    for i, j in zip(*np.nonzero(gain), strict=True):
        mac = _shared_mac(run_modes[owner[i]], int(inner[i]), run_modes[owner[j]], int(inner[j]))
        if mac is not None and mac < least_mac:
            gain[i, j] = 0.0
    return np.asarray(gain)


def _pole_std(modes: RunModes) -> NDArray[np.float64]:
    """Standard deviation of |pole error|, rad/s; 0 where none is stated."""
    omega = np.abs(modes.poles)
    std = np.hypot(2 * np.pi * modes.frequency_std_hz, omega * modes.damping_ratio_std)
    return np.asarray(np.where(np.isfinite(std), std, 0.0))


def _shared_mac(first: RunModes, i: int, second: RunModes, j: int) -> float | None:
    """MAC at the DOFs that both runs measured under one reference; None for fewer than two, which say nothing."""
    place = {dof.unsigned: (k, dof.direction.sign) for k, dof in enumerate(second.responses)}
    shared = [(k, *place[d.unsigned], d.direction.sign) for k, d in enumerate(first.responses) if d.unsigned in place]
    if len(shared) < 2:
        return None
    one = np.array([first.residues[i, k] * sign for k, _, _, sign in shared])
    two = np.array([second.residues[j, k] * sign for _, k, sign, _ in shared])
    return float(modal_assurance(one, two)[0, 0])
