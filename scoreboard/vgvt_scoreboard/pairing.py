"""Who is who: a one-to-one pairing of two modal models by pole distance, with a MAC gate.

MAC alone mis-pairs look-alikes (two bending modes seen by too few sensors), frequency alone
mis-pairs close modes; Allemang, The modal assurance criterion, Sound and Vibration 37(8), 2003.
The assignment is optimal over all pairs at once (Kuhn, The Hungarian method, 1955).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from vgvt.data import ModalModel, modal_assurance


@dataclass(frozen=True, slots=True)
class PairingRule:
    """When two modes may be the same one, and what a pair costs.

    A pair is admissible when its poles are no further apart than
    ``max_pole_distance`` (a fraction of the frequency) and its MAC is at least
    ``min_mac``; where no method could know the shape, the poles alone decide, within
    ``max_pole_distance_alone``. Its cost is distance / max_pole_distance + mac_weight (1 - MAC).
    """

    max_pole_distance: float = 0.10
    max_pole_distance_alone: float = 0.01
    min_mac: float = 0.5
    mac_weight: float = 0.1

    def __post_init__(self) -> None:
        if not (self.max_pole_distance > 0 and 0 <= self.min_mac <= 1 and self.mac_weight >= 0):
            raise ValueError(f"a pairing rule needs a positive distance, a MAC in 0..1 and a weight >= 0, got {self}")


@dataclass(frozen=True, slots=True, eq=False)
class Pairing:
    """The outcome: index pairs (first, second) and the matrices (M, N) that led to them."""

    pairs: tuple[tuple[int, int], ...]
    pole_distance: NDArray[np.float64]
    mac: NDArray[np.float64]
    admissible: NDArray[np.bool_]


def pole_distance(first: ModalModel, second: ModalModel) -> NDArray[np.float64]:
    """Distance |p - q| of every pair of poles over the mean of |p| and |q|, shape (M, N).

    Where either side states no damping (NaN) the distance is that of the natural frequencies alone.
    """
    p, q = first.poles[:, None], second.poles[None, :]
    omega_p = 2 * np.pi * first.natural_frequency_hz[:, None]
    omega_q = 2 * np.pi * second.natural_frequency_hz[None, :]
    damped = np.isfinite(p) & np.isfinite(q)
    gap = np.where(damped, np.abs(p - q), np.abs(omega_p - omega_q))
    scale = (omega_p + omega_q) / 2
    return np.asarray(np.divide(gap, scale, out=np.zeros_like(gap), where=scale > 0))


def pair_modes(
    first: ModalModel,
    second: ModalModel,
    rule: PairingRule | None = None,
    shapeless: NDArray[np.bool_] | None = None,
) -> Pairing:
    """The admissible pairing, each mode used at most once, of the largest total gain 1 + mac_weight - cost.

    Every admissible pair gains, so one more mode paired is never refused for being a poor match,
    but two poor pairs do not displace one good pair that gains more. ``shapeless`` (M,) marks modes of ``first`` whose
    shape nobody can know. ValueError when the models
    are not seen at the same DOFs.
    """
    rule = rule or PairingRule()
    if first.dofs != second.dofs:
        raise ValueError("both models must be seen at the same DOFs; use ModalModel.at first")
    distance = pole_distance(first, second)
    mac = modal_assurance(first.shapes, second.shapes) if first.dofs else np.zeros(distance.shape)
    mac = mac.reshape(distance.shape)
    admissible = (distance <= rule.max_pole_distance) & (mac >= rule.min_mac)
    if shapeless is not None:
        admissible |= shapeless[:, None] & (distance <= rule.max_pole_distance_alone)
    cost = distance / rule.max_pole_distance + rule.mac_weight * (1 - mac)
    gain = np.where(admissible, 1 + rule.mac_weight - cost, 0.0)
    rows, columns = linear_sum_assignment(gain, maximize=True)
    pairs = tuple((int(i), int(j)) for i, j in zip(rows, columns, strict=True) if admissible[i, j])
    return Pairing(pairs, distance, mac, admissible)
