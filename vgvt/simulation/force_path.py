"""What the inputs of a driven rig become at its force transducers, over frequency."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.simulation.state_space import StateSpace

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, eq=False)
class ForcePath:
    """Force r per unit of input i, volts or a hammer's newtons: Σ gains / (s - pole) + through.

    ``poles`` (n,), ``gains`` (R, I, n) and ``through`` (R, I).
    """

    poles: Complex
    gains: Complex
    through: Array

    @classmethod
    def of(cls, driven: StateSpace) -> ForcePath:
        """The path of a driven rig, whose last outputs are its forces."""
        poles, right = np.linalg.eig(driven.state_matrix)
        entering = np.linalg.solve(right, driven.inputs.astype(complex))
        forces = driven.inputs.shape[1]
        leaving = driven.output_matrix[-forces:] @ right
        return cls(poles, leaving[:, None, :] * entering.T, driven.feedthrough_rows[-forces:])

    def per_input(self, frequency_hz: Array) -> Complex:
        """Measured forces for a unit of each input, (K, R, I), at frequencies (K,)."""
        s = 2j * np.pi * frequency_hz[:, None]
        return np.asarray(np.tensordot(1 / (s - self.poles), self.gains, axes=(1, 2)) + self.through)
