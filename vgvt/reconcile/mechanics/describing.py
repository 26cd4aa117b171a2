"""Describing functions: the complex stiffness that a nonlinear force law offers to a sinusoidal motion.

A law T(x, v) under x = b + A sin ωt answers with a first harmonic κ x; the mean b is where the mean force holds the
load that rests on it (Gelb and Vander Velde, Multiple-Input Describing Functions, 1968).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.elements import JointLaw

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_PHASES = 256
_BIAS_STEPS = 45
_NEWTON = 8
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
        # As the linearisation takes it: a joint that rests near a stop has some of both its slopes in there.
        near = law.elastic(np.array([rest_rad + _LINEARISED_RAD, rest_rad - _LINEARISED_RAD]))
        return replace(law, modelled=float(near[0] - near[1]) / (2 * _LINEARISED_RAD))

    def loaded(self, force: float) -> Law:
        """The same joint with more weight on it: it rests elsewhere, on a spring that is convex on either side."""
        wanted, x = self.load + force, self.rest
        for _ in range(_NEWTON):
            slope = float(self.slope(np.array(x)))
            x -= (float(self.elastic(np.array(x))) - wanted) / (slope if slope > 0 else self.stiffness)
        return replace(self, rest=x)

    def elastic(self, x: Array) -> Array:
        """The spring's force at displacements x of any shape, from the unloaded state."""
        pressed = x - np.clip(x, -self.play, self.play)
        return self.stiffness * pressed + self.cubic * pressed**3

    def slope(self, x: Array) -> Array:
        """Derivative of :meth:`elastic`; its value beyond the band on the band's edge."""
        pressed = x - np.clip(x, -self.play, self.play)
        return np.where(np.abs(x) < self.play, 0.0, self.stiffness + 3 * self.cubic * pressed**2)

    @property
    def load(self) -> float:
        """What rests on the joint."""
        return float(self.elastic(np.array(self.rest)))

    @property
    def tangent(self) -> float:
        """Stiffness for small motions about rest, friction left out."""
        return float(self.slope(np.array(self.rest)))


def describing(law: Law, amplitude: Array) -> ComplexArray:
    """Equivalent complex stiffness κ (A,) of a law at amplitudes (A,) > 0 about its rest, by Fourier's integral.

    Friction adds 4 i M / (π A): its loss over a cycle does not depend on frequency.
    """
    amplitude = np.asarray(amplitude, dtype=np.float64)
    sine = np.sin(2 * np.pi * (np.arange(_PHASES) + 0.5) / _PHASES)
    bias = mean_displacement(law, amplitude)
    force = law.elastic(bias[:, None] + amplitude[:, None] * sine)
    return np.asarray(2 * (force @ sine) / (_PHASES * amplitude) + 1j * friction_stiffness(law.friction, amplitude))


def mean_displacement(law: Law, amplitude: Array) -> Array:
    """Where the joint swings about (A,), so that its mean force holds what rests on it, by bisection."""
    sine = np.sin(2 * np.pi * (np.arange(_PHASES) + 0.5) / _PHASES)

    def lacking(bias: Array) -> Array:
        return np.asarray(law.elastic(bias[:, None] + amplitude[:, None] * sine).mean(axis=1) - law.load)

    # The law grows with x, so that its mean does; a play's corner is never further than band and motion together.
    reach = np.abs(law.rest) + law.play + amplitude
    low, high = -reach, reach
    for _ in range(_BIAS_STEPS):
        middle = (low + high) / 2
        above = lacking(middle) > 0
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return np.asarray((low + high) / 2)


def cubic_stiffness(stiffness: float, cubic: float, amplitude: Array) -> Array:
    """k + 3/4 k3 A² of a spring without load (Nayfeh and Mook, Nonlinear Oscillations, 1979), (A,)."""
    return np.asarray(stiffness + 0.75 * cubic * np.asarray(amplitude) ** 2)


def play_stiffness(stiffness: float, play: float, amplitude: Array) -> Array:
    """k (1 - (2/π)(asin s + s sqrt(1 - s²))), s = play/A, of a dead band without load; 0 within it, (A,)."""
    share = np.minimum(1.0, play / np.asarray(amplitude, dtype=np.float64))
    return np.asarray(stiffness * (1 - 2 / np.pi * (np.arcsin(share) + share * np.sqrt(1 - share**2))))


def friction_stiffness(friction: float, amplitude: Array) -> Array:
    """4 M / (π A): imaginary stiffness of dry friction, from its loss of 4 M A a cycle, (A,)."""
    return np.asarray(4 * friction / (np.pi * np.asarray(amplitude, dtype=np.float64)))


def drag_stiffness(drag: float, amplitude: Array, omega: Array) -> Array:
    """8 d ω² A / (3π): imaginary stiffness of a force d |v| v, in the shape of amplitude and rad/s together."""
    return np.asarray(8 * drag / (3 * np.pi) * np.asarray(omega) ** 2 * np.asarray(amplitude))


def first_harmonic(displacement: Array, force: Array) -> complex:
    """Ratio of the first harmonics of force and displacement (N,) over one whole period, from their samples."""
    return complex(np.fft.rfft(force)[1] / np.fft.rfft(displacement)[1])
