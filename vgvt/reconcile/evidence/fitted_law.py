"""The law of a thing that no catalogue has, with how well it is known, and read as what engineers know.

Whoever looks for the thing wants to know what it acts like: a spring, a mass, a damper and mixtures of them on the
structure; a gain and a delay on a channel; a change of stiffness and a loss factor of a whole airframe.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data.shown import headed
from vgvt.reconcile.evidence.smooth_law import TERMS, law_terms

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# Of a law's square size, each line by how well it is known there, what a reading may leave and still says what it is.
_TOLD_APART = 0.1
# Standard deviations beyond which a part of a reading is told.
_THERE = 2.0
# Of the best known direction of a law's values, the precision of one that nothing tells.
_HARDLY = 1e-12
_POINTS = 33
# Of a factor: a channel that reads less is dead, and has no gain.
_DEAD = 1e-6
# Laws (L, parts) by angular frequency (L,) that add up to one of a kind of place.
_SUMS: dict[str, Callable[[Array], ComplexArray]] = {
    "structure": lambda omega: np.stack([np.ones_like(omega), 1j * omega, -(omega**2)], axis=1),
    "airframe": lambda omega: np.stack([np.ones_like(omega), 1j * np.ones_like(omega)], axis=1),
}


@dataclass(frozen=True, slots=True)
class Part:
    """One part of a reading: ``name``, ``value`` ± ``std`` (one standard deviation) and ``unit``."""

    name: str
    value: float
    std: float
    unit: str

    @property
    def in_words(self) -> str:
        """``a stiffness of -300 ± 10 N/m``."""
        article = "an" if self.name[0] in "aeiou" else "a"
        # To the first digit of the deviation, and no further.
        digits = -math.floor(math.log10(self.std)) if 0 < self.std < math.inf else 6
        value, std = (f"{round(v, digits):.{max(0, digits)}f}" for v in (self.value, self.std))
        return f"{article} {self.name} of {value} ± {std} {self.unit}".rstrip()


@dataclass(frozen=True, slots=True)
class Reading:
    """A law as the simplest parts, and the share ``left`` of it that they are not; ``kind`` is as a free place's.

    Those of the force channel are the force's, where the law is of acceleration over force.
    """

    parts: tuple[Part, ...]
    left: float
    kind: str

    def at(self, frequency_hz: Array) -> ComplexArray:
        """What it makes of the law at some frequencies (L,)."""
        omega, values = 2 * np.pi * frequency_hz, np.array([p.value for p in self.parts])
        if self.kind in _SUMS:
            return np.asarray(_SUMS[self.kind](omega) @ values)
        gain, delay = values
        factor = (1 + gain) * np.exp(-1j * omega * delay)
        return np.asarray((1 / factor if self.kind == "drive" else factor) - 1)

    @property
    def tells(self) -> bool:
        """Whether the parts say what the law is."""
        return self.left <= _TOLD_APART

    @property
    def in_words(self) -> str:
        """What it reads as, as the rest of a sentence."""
        seen = [p for p in self.parts if abs(p.value) > _THERE * p.std]
        if not self.tells:
            where = "" if self.kind == "airframe" else " at one place"
            return f"reads as no {', '.join(p.name for p in self.parts[:-1])} or {self.parts[-1].name}{where}"
        if not seen:
            return "is too little known to be read"
        *most, last = (p.in_words for p in seen)
        return f"reads as {', '.join(most)} and {last}" if most else f"reads as {last}"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FittedLaw:
    """What was fitted over a band (L,) Hz: ``sizes`` (TERMS,) complex, and the ``precision`` (2 TERMS, 2 TERMS).

    The precision is of the real parts, then the imaginary ones, whatever else is unknown left open, and of values that
    are independent. ``kind`` is as a free place's; what acts where something ``turns`` is a moment.
    """

    frequency_hz: Array
    sizes: ComplexArray
    precision: Array
    kind: str
    turns: bool

    def __repr__(self) -> str:
        return headed(f"FittedLaw on {self.kind}, {self.unit or 'a factor'}: {self.reading.in_words}")

    @property
    def unit(self) -> str:
        """Unit of the values; none of what adds to a factor of one."""
        return ("N m/rad" if self.turns else "N/m") if self.kind == "structure" else ""

    @property
    def values(self) -> ComplexArray:
        """Dynamic stiffness, or what it adds to a factor of one, (L,)."""
        return law_terms(self.frequency_hz) @ self.sizes

    @property
    def std(self) -> ComplexArray:
        """One standard deviation (L,) of the real part, and of the imaginary part."""
        covariance, terms = self._covariance, law_terms(self.frequency_hz)
        parts = (covariance[:TERMS, :TERMS], covariance[TERMS:, TERMS:])
        real, imaginary = (np.sqrt(np.maximum(np.einsum("lj,jk,lk->l", terms, c, terms), 0.0)) for c in parts)
        return np.asarray(real + 1j * imaginary)

    @property
    def _covariance(self) -> Array:
        """Of real and imaginary values (2 TERMS, 2 TERMS); what nothing tells is hardly known, and not sharp."""
        sizes, sides = np.linalg.eigh(self.precision)
        least = max(_HARDLY * float(sizes[-1]), np.finfo(float).tiny)
        return np.asarray((sides / np.maximum(sizes, least)) @ sides.T)

    @property
    def reading(self) -> Reading:
        """The law as stiffness, damping and mass, or as gain and delay: each line by how well it is known there.

        Lines are weighed as if errors of neighbours had nothing to do with each other, so that what is none of the
        parts leads none of them astray; deviations know that they do, and of what the parts leave. Gain and delay of
        the force channel are the force's, as the catalogue has them: A/F has their inverse.
        """
        omega, terms = 2 * np.pi * self.frequency_hz, law_terms(self.frequency_hz)
        values, std = self.values, self.std
        if self.kind in _SUMS:
            sought, slope, laws = values, np.ones_like(values), _SUMS[self.kind](omega)
            units = ("N m/rad", "N m s/rad", "kg m^2") if self.turns else ("N/m", "N s/m", "kg")
            names = list(zip(("stiffness", "damping", "inertia" if self.turns else "mass"), units, strict=True))
            if self.kind == "airframe":
                names = [("relative change of stiffness", ""), ("loss factor", "")]
        else:
            # A factor (1 + gain error) exp(-i ω delay) has a logarithm in which both are straight.
            sign = 1.0 if float(np.sum(1 + values.real)) > 0 else -1.0
            way = -1.0 if self.kind == "drive" else 1.0
            factor: ComplexArray = np.where(np.abs(1 + values) > _DEAD, 1 + values, complex(_DEAD))
            sought, slope = way * _logarithm(sign * factor), way / factor
            laws = np.stack([np.ones_like(omega), -1j * omega], axis=1)
            names = [("gain error", ""), ("delay", "s")]
        weight = 1 / np.maximum(np.concatenate([std.real, std.imag]) * np.tile(np.abs(slope), 2), np.finfo(float).tiny)
        inverse = np.linalg.pinv(weight[:, None] * _parts(laws))
        found = inverse @ (weight * _parts(sought))
        by_size = _parts(np.concatenate([slope[:, None] * terms, 1j * slope[:, None] * terms], axis=1))
        carried = inverse @ (weight[:, None] * by_size)
        left = float(np.sum((weight * _parts(sought - laws @ found)) ** 2))
        total = float(np.sum((weight * _parts(sought)) ** 2))
        # What the parts leave of the law might as well be of any one of them.
        as_much = left / np.maximum(np.sum((weight[:, None] * _parts(laws)) ** 2, axis=0), np.finfo(float).tiny)
        deviations = np.sqrt(np.diag(carried @ self._covariance @ carried.T) + as_much)
        if self.kind not in _SUMS:
            gain = sign * float(np.exp(found[0]))
            found, deviations = np.array([gain - 1, found[1]]), deviations * np.array([abs(gain), 1.0])
        parts = tuple(Part(n, float(v), float(s), u) for (n, u), v, s in zip(names, found, deviations, strict=True))
        return Reading(parts, left / total if total > 0 else 0.0, self.kind)

    def document(self) -> dict[str, object]:
        """Plain values by the keys of the JSON contract."""
        at = np.unique(np.linspace(0, self.frequency_hz.size - 1, _POINTS).round().astype(int))
        values, std, reading = self.values[at], self.std[at], self.reading
        return {
            "unit": self.unit,
            "frequency_hz": self.frequency_hz[at].tolist(),
            "real": values.real.tolist(),
            "imaginary": values.imag.tolist(),
            "real_std": std.real.tolist(),
            "imaginary_std": std.imag.tolist(),
            "reads_as": {p.name: {"value": p.value, "std": p.std, "unit": p.unit} for p in reading.parts},
            "left_by_reading": reading.left,
        }


def _parts(values: ComplexArray) -> Array:
    """Real parts (L, …), then imaginary ones."""
    return np.concatenate([values.real, values.imag])


def _logarithm(factor: ComplexArray) -> ComplexArray:
    """Natural logarithm (L,), the phase followed from line to line."""
    return np.asarray(np.log(np.abs(factor)) + 1j * np.unwrap(np.angle(factor)))
