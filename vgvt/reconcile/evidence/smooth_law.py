"""A thing that no catalogue has, at one place: what it does to A/F, whatever its law, as long as that is smooth.

On the structure it is a dynamic stiffness z(ω) from the ground to a point, or one more at a root; elsewhere a factor
1 + z(ω) on what a channel reads, or on every stiffness of the airframe. Four complex values, cubic in the logarithm of
frequency, which a stiffness, mass, damper and mixtures of them are.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from vgvt.reconcile.evidence.free_places import FreePlace, reduced_row
from vgvt.reconcile.fitting.misfit import Linearised
from vgvt.reconcile.mechanics.joints import Joints
from vgvt.reconcile.mechanics.level_slopes import level_accelerance_slopes
from vgvt.reconcile.mechanics.response import Slopes
from vgvt.reconcile.prediction.levels import Levels
from vgvt.reconcile.prediction.surrogate import Anchor, Reduced
from vgvt.reconcile.question.problem import Problem

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
TERMS = 4
"""Complex values of a law."""


def law_terms(frequency_hz: Array) -> Array:
    """The terms (L, TERMS): Bernstein's cubics in the logarithm of frequency over the band."""
    x = np.log(frequency_hz)
    ends = np.repeat([x[0], x[-1]], TERMS)
    return np.asarray(BSpline.design_matrix(np.minimum(x, np.nextafter(x[-1], x[0])), ends, TERMS - 1).toarray())


@dataclass(frozen=True, slots=True, eq=False)
class SmoothLaw:
    """A law that acts at one place, or alike at two that are mirror images, by a ``course`` (R,) over the runs."""

    places: tuple[FreePlace, ...]
    course: Array

    def on(self, here: Anchor, law: ComplexArray) -> Linearised:
        """A model with a ``law`` (L,) in place, exact however stiff, and with it its slopes in all that is uncertain.

        A static flexibility that the reduced coordinates miss there is taken for the law's own, and a record ends as it
        does without the law. Not beside joints that depend on level.
        """
        first = self.places[0]
        if first.rows is None:
            assert first.mask is not None
            return _Multiplied(here, 1 + (first.mask * self._acts(here))[:, None] * law)
        groups = []
        for k, group in enumerate(here.groups):
            assert group.levels is None
            groups.append(replace(group, levels=self._levels(here, k, law)))
        return replace(here, groups=tuple(groups))

    def by_law(self, here: Anchor, law: ComplexArray, u: Array, e: Array) -> ComplexArray:
        """Derivatives (C, L) of each line of A/F in the law's value there, at a ``law`` (L,)."""
        first = self.places[0]
        if first.rows is None:
            assert first.mask is not None
            return np.asarray(here.predict(u, e) * (first.mask * self._acts(here))[:, None])
        slopes = np.zeros(here.problem.measured.values.shape, dtype=complex)
        omega = 2 * np.pi * here.problem.measured.frequency_hz
        for k, group in enumerate(here.groups):
            levels, masses = self._levels(here, k, law), tuple(group.masses_kg[r] * group.roving for r in group.runs)
            one = self._shown(here, group, levels.joints.rows, np.ones_like(law))[None]
            slopes[group.channels] = level_accelerance_slopes(
                group.matrices, levels.joints, levels.shown, one, omega, group.runs, masses, _nothing_else(group)
            )[0]
        return np.asarray(slopes * here.chain(u, e))

    def _acts(self, here: Anchor) -> Array:
        """By how much it acts on each channel (C,)."""
        return self.course[[c.run for c in here.problem.measured.channels]]

    def _shown(self, here: Anchor, group: Reduced, rows: Array, law: ComplexArray) -> ComplexArray:
        """The stiffness (R, J, L) along rows (J, m) in each run of a group."""
        acts = self._acts(here)
        share = np.array([acts[group.channels[of_run[0]]] for of_run in group.runs])
        return np.asarray(np.broadcast_to(share[:, None, None] * law, (share.size, rows.shape[0], law.size)))

    def _levels(self, here: Anchor, index: int, law: ComplexArray) -> Levels:
        """The law as what joints at its places show in each run of a group."""
        group = here.groups[index]
        rows = np.vstack([reduced_row(group, p.rows[index]) for p in self.places if p.rows is not None])
        channels, number, lines, effects = group.channels.size, rows.shape[0], law.size, here.e0.size
        missed = (np.zeros(number), np.zeros((channels, number)), np.zeros((number, number)))
        left_out = np.zeros((effects + 1, channels, lines), dtype=complex)
        shown = self._shown(here, group, rows, law)
        held = np.zeros((effects, *shown.shape), dtype=complex)
        return Levels(Joints((), rows, *missed), shown, left_out[0], held, left_out[1:])


def by_first_of_law(here: Anchor, place: FreePlace, u: Array, e: Array) -> ComplexArray:
    """Derivatives (C, L) of each line of A/F in a law's value at a place, in every run, where there is no law yet."""
    every, none = np.ones(len(here.problem.measured.runs)), np.zeros(here.problem.measured.frequency_hz.size)
    return SmoothLaw((place,), every).by_law(here, none.astype(complex), u, e)


@dataclass(frozen=True, slots=True, eq=False)
class _Multiplied:
    """A model whose channels read some ``factor`` (C, L) of what they are."""

    plain: Anchor
    factor: ComplexArray

    @property
    def problem(self) -> Problem:
        return self.plain.problem

    @property
    def filtered(self) -> bool:
        return self.plain.filtered

    def predict(self, u: Array, e: Array) -> ComplexArray:
        return self.plain.predict(u, e) * self.factor

    def chain(self, u: Array, e: Array) -> ComplexArray:
        return self.plain.chain(u, e) * self.factor

    def slopes(self, wanted: NDArray[np.bool_] | None = None) -> ComplexArray:
        return self.plain.slopes(wanted)


def _nothing_else(group: Reduced) -> Slopes:
    """Slopes of a structure in one parameter that changes nothing of it."""
    plain = group.matrices
    none = {
        n: np.zeros((1, *getattr(plain, n).shape)) for n in ("mass", "damping", "stiffness", "drive", "axis", "tilt")
    }
    return Slopes(**none, masses_kg=np.zeros((1, group.masses_kg.size)))
