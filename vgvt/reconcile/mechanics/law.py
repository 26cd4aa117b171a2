"""The force law of a joint that depends on level: a stiffening spring with play and friction, about where it rests."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.elements import JointLaw

Array = NDArray[np.float64]
# The step of the linear model's central differences.
_LINEARISED_RAD = 1e-5


@dataclass(frozen=True, slots=True)
class Law:
    """A force against a displacement x: k x + k3 x³ beyond a dead band of ± ``play``, and ± ``friction`` against v.

    ``rest`` is the displacement that the weight holds the joint at; what moves it is measured from there.
    ``modelled`` is the stiffness that a linear model has for the joint already.
    """

    stiffness: float
    cubic: float = 0.0
    friction: float = 0.0
    play: float = 0.0
    rest: float = 0.0
    modelled: float = 0.0

    @classmethod
    def of(cls, element: JointLaw, rest_rad: float) -> Law:
        """The law of a root joint, N m and rad, in a structure that was linearised at its rest."""
        law = cls(
            element.stiffness_n_m_per_rad, element.cubic_n_m_per_rad3, element.friction_n_m, element.play_rad, rest_rad
        )
        return law._linearised()

    def _linearised(self) -> Law:
        """The same in a structure that is linearised where it rests."""
        # As the linearisation takes it: a joint that rests near a stop has some of both its slopes in there.
        near = self.elastic(np.array([self.rest + _LINEARISED_RAD, self.rest - _LINEARISED_RAD]))
        return replace(self, modelled=float(near[0] - near[1]) / (2 * _LINEARISED_RAD))

    def resting(self, rest_rad: float) -> Law:
        """The same joint in a structure that holds it elsewhere, and is linearised there."""
        return replace(self, rest=rest_rad)._linearised()

    def loaded(self, force: float) -> Law:
        """The same joint with more weight on it: it rests elsewhere, maybe beyond its dead band's other side."""
        if force == 0:
            return self
        wanted = self.load + force
        if wanted == 0:
            # Anywhere in its band nothing holds it: where it comes to first.
            return replace(self, rest=min(max(self.rest, -self.play), self.play))
        pressed = wanted / self.stiffness
        if self.cubic > 0:
            # The one real root of a growing cubic (Cardano's, with hyperbolic sines).
            reach = 2 * np.sqrt(self.stiffness / (3 * self.cubic))
            pressed = float(reach * np.sinh(np.arcsinh(3 * pressed / reach) / 3))
        return replace(self, rest=pressed + float(np.copysign(self.play, wanted)))

    def elastic(self, x: Array) -> Array:
        """The spring's force at displacements x of any shape, from the unloaded state."""
        pressed = x - np.clip(x, -self.play, self.play)
        return self.stiffness * pressed + self.cubic * pressed**3

    @property
    def load(self) -> float:
        """What rests on the joint."""
        return float(self.elastic(np.array(self.rest)))
