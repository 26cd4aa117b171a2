"""Derivatives of accelerances by partial fractions: of each pole a simple and a double one, whatever is varied.

A structure answers to a push h with q = V f L h, f the functions 1/(iω - λ) of its poles λ. With a change δZ of its
dynamic stiffness, a reading b q of that changes by

    δb V f L h + b V f L (δh - δM M⁻¹ h) - b V f E f L h,    E = L (δK V + δC V Λ + δM V Λ²),

which is exact: what powers of iω leave of a pole is the structure's answer to a jolt, nothing, and its slope, M⁻¹ h.
A product of two poles is the difference of both over their distance, so that lines are summed over once, at the end.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.mechanics.response import Matrices, Poles, Slopes, loaded_by, poles_of

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
# Poles no further apart than this share of their own size are one, which is then a double one.
_ONE = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Fractions:
    """Functions (k, R) of iω: ``simple`` and ``double`` (k, R, U) of poles, and ``powers`` (n, k, R) of iω.

    Meant with each pole is its mirror image; one that is real is half of itself twice, as ``poles`` (U,) and their
    ``weights`` (U,) have it.
    """

    poles: ComplexArray
    weights: Array
    simple: ComplexArray
    double: ComplexArray
    powers: Array

    def plus(self, other: Fractions) -> Fractions:
        """The sum with another function of the same poles."""
        longest = max(self.powers.shape[0], other.powers.shape[0])
        powers = np.zeros((longest, *self.simple.shape[:2]))
        for part in (self.powers, other.powers):
            powers[: part.shape[0]] += part
        return replace(self, simple=self.simple + other.simple, double=self.double + other.double, powers=powers)

    def accelerated(self) -> Fractions:
        """The function times (iω)²: what is an amplitude becomes its acceleration."""
        pole = self.poles
        powers = np.zeros((self.powers.shape[0] + 2, *self.simple.shape[:2]))
        powers[2:] = self.powers
        powers[0] += 2 * ((pole * self.simple + self.double) @ self.weights).real
        powers[1] += 2 * (self.simple @ self.weights).real
        simple = pole**2 * self.simple + 2 * pole * self.double
        return replace(self, simple=simple, double=pole**2 * self.double, powers=powers)

    def residues(self, poles: ComplexArray, at: NDArray[np.intp]) -> tuple[ComplexArray, ComplexArray]:
        """Shares (k, R, P), simple and double, of those at places ``at`` (P,) among all ``poles`` of the structure.

        By place, and not by value: of poles that are equal each has a share of its own.
        """
        mirrored = poles[at].imag < 0
        # A mirror image follows its pole.
        index = (np.cumsum(poles.imag >= 0) - 1)[at]
        simple, double = self.simple[:, :, index], self.double[:, :, index]
        return np.where(mirrored, simple.conj(), simple), np.where(mirrored, double.conj(), double)

    def at(self, omega: Array) -> ComplexArray:
        """Values (k, R, L) at lines (L,), rad/s."""
        f, mirrored = (np.asarray(1 / (1j * omega - p[:, None])) for p in (self.poles, self.poles.conj()))
        known: list[ComplexArray] = []
        for one, other in ((f, mirrored), (f**2, mirrored**2)):
            known += [self.weights[:, None] * (one + other), 1j * self.weights[:, None] * (one - other)]
        known += [np.asarray((1j * omega[None]) ** n, dtype=np.complex128) for n in range(self.powers.shape[0])]
        shares = [part for c in (self.simple, self.double) for part in (c.real, c.imag)]
        shares.append(self.powers.transpose(1, 2, 0))
        # Real numbers times pairs of them: half of a complex product.
        basis = np.concatenate(known).view(np.float64)
        return np.asarray((np.concatenate(shares, axis=2) @ basis).view(np.complex128))


@dataclass(frozen=True, slots=True, eq=False)
class RunSlopes:
    """Of a run that reads ``rows``: its ``poles``, and changes (k, R) of amplitudes along ``axis`` and of ``tilt``.

    ``late`` are those of what answers as (iω)² h, or None: inertia forces of sensors on what the modes have left out.
    """

    rows: NDArray[np.intp]
    poles: Poles
    axis: Fractions
    tilt: Fractions
    late: tuple[Fractions, Fractions] | None

    def accelerances(self, omega: Array) -> ComplexArray:
        """Derivatives (k, R, L) of the run's accelerances at lines (L,), rad/s."""
        found = self.axis.accelerated().plus(self.tilt)
        if self.late is not None:
            axis, tilt = self.late
            found = found.plus(axis.accelerated().plus(tilt).accelerated())
        return found.at(omega)


def run_slopes(
    matrices: Matrices,
    omega: Array,
    runs: tuple[NDArray[np.intp], ...],
    masses_kg: tuple[Array, ...],
    slopes: Slopes,
    wanted: NDArray[np.bool_] | None = None,
) -> Iterator[RunSlopes | None]:
    """What the readings of each run that are ``wanted`` (C,), by default all, change by; None where none of it is."""
    # (m, k, m), so that one real product serves all parameters.
    stacked = [np.ascontiguousarray(s.transpose(1, 0, 2)) for s in (slopes.stiffness, slopes.damping, slopes.mass)]
    for rows, mass in zip(runs, masses_kg, strict=True):
        asked = rows if wanted is None else rows[wanted[rows]]
        yield _of_run(matrices, omega, rows, mass, slopes, stacked, asked) if asked.size else None


def _of_run(
    matrices: Matrices, omega: Array, rows: NDArray[np.intp], mass: Array, slopes: Slopes, stacked: list[Array],
    asked: NDArray[np.intp],
) -> RunSlopes:  # fmt: skip
    """Of the run with sensors at ``rows`` what those ``asked`` of them read."""
    there = loaded_by(matrices, rows, mass)
    poles = poles_of(there, omega)
    upper = np.flatnonzero(poles.poles.imag >= 0)
    pole, vectors, left = poles.poles[upper], poles.vectors[:, upper], poles.left[upper]
    weights = np.where(pole.imag == 0, 0.5, 1.0)
    sensors = _Sensors(matrices.axis[rows], slopes.axis[:, rows], mass, slopes.masses_kg[:, rows])
    sides = ((vectors, pole), (vectors.conj(), pole.conj()))
    elements = _elements(stacked, pole, vectors, left)
    apart, one = [], []
    for found, (v, p) in zip(elements, sides, strict=True):
        whole, distance = found + sensors.between(left, v * p**2), pole[:, None] - p
        same = np.abs(distance) <= _ONE * np.abs(pole[:, None])
        apart.append(np.where(same, 0.0, whole / np.where(same, 1.0, distance)))
        one.append(np.where(same, whole, 0.0))
    parts = _Parts(pole, weights, (apart[0], apart[1]), (one[0], one[1]))
    readings = (
        (matrices.axis[asked] @ vectors, slopes.axis[:, asked] @ vectors),
        (matrices.tilt[asked] @ vectors, slopes.tilt[:, asked] @ vectors),
    )
    given = np.asarray(np.linalg.solve(there.mass, matrices.drive), dtype=np.float64)
    pushes = slopes.drive - slopes.mass @ given - sensors.pulled(given)
    axis, tilt = (parts.of(*reading, left @ matrices.drive, pushes @ left.T) for reading in readings)
    spare, looser = matrices.spare[rows], np.zeros((slopes.mass.shape[0], rows.size))
    if slopes.spare is not None:
        looser = slopes.spare[:, rows]
        axis = replace(axis, powers=slopes.spare[None][:, :, asked])
    if not (mass * spare).any() and not (mass * looser).any():
        return RunSlopes(asked, poles, axis, tilt, None)
    late = -sensors.axis.T @ (mass * spare)
    given = np.asarray(np.linalg.solve(there.mass, late), dtype=np.float64)
    pushes = -sensors.carried(spare) - (mass * looser) @ sensors.axis - slopes.mass @ given - sensors.pulled(given)
    of_late = [parts.of(*reading, left @ late, pushes @ left.T) for reading in readings]
    return RunSlopes(asked, poles, axis, tilt, (of_late[0], of_late[1]))


@dataclass(frozen=True, slots=True, eq=False)
class _Sensors:
    """Rows (R, m) of a run's sensors and their changes (k, R, m); their masses (R,) and changes (k, R)."""

    axis: Array
    slopes: Array
    mass: Array
    mass_slopes: Array

    def between(self, left: ComplexArray, right: ComplexArray) -> ComplexArray:
        """Changes (k, a, b) of what they weigh, between vectors left (a, m) and right (m, b)."""
        seen, moved = self.axis @ right, self.slopes @ right
        pulled, turned = left @ self.axis.T, left @ (self.mass[:, None] * self.slopes).transpose(0, 2, 1)
        return np.asarray(turned @ seen + pulled @ (self.mass[:, None] * moved + self.mass_slopes[:, :, None] * seen))

    def pulled(self, q: Array) -> Array:
        """Changes (k, m) of what they weigh, times q (m,)."""
        return self.carried(self.axis @ q) + (self.slopes @ q * self.mass) @ self.axis

    def carried(self, moved: Array) -> Array:
        """Changes (k, m) of what their masses do when they are moved by (R,), rows and masses changing."""
        return np.asarray(
            np.einsum("kam,a->km", self.slopes, self.mass * moved) + (self.mass_slopes * moved) @ self.axis
        )


def _elements(
    stacked: list[Array], pole: ComplexArray, vectors: ComplexArray, left: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """Elements E (k, U, U) from poles to poles, and to poles from their mirror images."""
    m, k = stacked[0].shape[:2]
    count = pole.size
    turned = np.zeros((m * k, 2 * count))
    for n, change in enumerate(stacked):
        if change.any():
            v = vectors * pole**n
            turned += change.reshape(m * k, m) @ np.hstack([v.real, v.imag])
    # (2 U, m) times (m, k 2 U): real and imaginary parts of both sides by one product.
    both = np.vstack([left.real, left.imag]) @ turned.reshape(m, -1)
    parts = both.reshape(2, count, k, 2, count).transpose(0, 3, 2, 1, 4)
    of_real, of_imaginary = (parts[0, n] + 1j * parts[1, n] for n in (0, 1))
    return of_real + 1j * of_imaginary, of_real - 1j * of_imaginary


@dataclass(frozen=True, slots=True, eq=False)
class _Parts:
    """Elements (k, U, U) of E over the distances of what is ``apart``, and as they are of what is ``one``.

    Of each first those from poles to poles, then those from their mirror images.
    """

    poles: ComplexArray
    weights: Array
    apart: tuple[ComplexArray, ComplexArray]
    one: tuple[ComplexArray, ComplexArray]

    def of(self, seen: ComplexArray, changed: ComplexArray, pushed: ComplexArray, pushes: ComplexArray) -> Fractions:
        """Changes of readings ``seen`` (R, U), which change by (k, R, U), of a push (U,), which changes by (k, U)."""
        weighted, looked = self.weights * pushed, self.weights * seen
        (own, mirrored), (same, mirror) = self.apart, self.one
        answers = pushes - own @ weighted - mirrored @ weighted.conj()
        simple = changed * pushed + seen * answers[:, None]
        simple += pushed * (looked @ own + (looked @ mirrored).conj())
        double = -seen * (same @ weighted + mirror @ weighted.conj())[:, None]
        return Fractions(self.poles, self.weights, simple, double, np.zeros((0, *simple.shape[:2])))
