"""Mass, first and second moments: add up anything, then read centre of gravity and inertia."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import RigidBodyProperties

_EYE = np.eye(3)


@dataclass(frozen=True, slots=True, eq=False)
class MassMoments:
    """Mass, first moment (3,) and second moment (3, 3), the integral of r rᵀ dm, about the aircraft's origin."""

    mass_kg: float
    first_kg_m: NDArray[np.float64]
    second_kg_m2: NDArray[np.float64]

    def __add__(self, other: MassMoments) -> MassMoments:
        return MassMoments(
            self.mass_kg + other.mass_kg,
            self.first_kg_m + other.first_kg_m,
            self.second_kg_m2 + other.second_kg_m2,
        )

    def scaled(self, share: float) -> MassMoments:
        """A fraction of it, at the same place."""
        return MassMoments(share * self.mass_kg, share * self.first_kg_m, share * self.second_kg_m2)

    def rigid_body(self) -> RigidBodyProperties:
        """Mass, centre of gravity and inertia about it; the centre of nothing is the origin."""
        if self.mass_kg <= 0:
            return RigidBodyProperties(0.0, np.zeros(3), np.zeros((3, 3)))
        centre = self.first_kg_m / self.mass_kg
        about_centre = self.second_kg_m2 - self.mass_kg * centre[:, None] * centre
        return RigidBodyProperties(self.mass_kg, centre, _trace(about_centre) * _EYE - about_centre)


NOTHING = MassMoments(0.0, np.zeros(3), np.zeros((3, 3)))


def lump(mass_kg: float, position_m: NDArray[np.float64], inertia_kg_m2: NDArray[np.float64]) -> MassMoments:
    """Moments of a body with inertia (3, 3) about its centre of gravity at ``position_m`` (3,)."""
    own = 0.5 * _trace(inertia_kg_m2) * _EYE - inertia_kg_m2
    return MassMoments(mass_kg, mass_kg * position_m, own + mass_kg * position_m[:, None] * position_m)


def _trace(matrix: NDArray[np.float64]) -> float:
    # Thousands of small ones: without numpy's general machinery.
    return float(matrix[0, 0] + matrix[1, 1] + matrix[2, 2])
