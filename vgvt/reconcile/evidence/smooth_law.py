"""A thing that no catalogue has, at one place: what it does to A/F, whatever its law, as long as that is smooth.

On the structure it is a dynamic stiffness z(ω) from the ground to a point, or one more at a root; elsewhere a factor
1 + z(ω) on what a channel reads. Four complex values, cubic in the logarithm of frequency, which a stiffness, mass,
damper and mixtures of them are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from vgvt.reconcile.evidence.free_places import FreePlace, reduced_row
from vgvt.reconcile.mechanics.response import accelerances, poles_of
from vgvt.reconcile.prediction.surrogate import Anchor, Reduced

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

    def changed(
        self, here: Anchor, predicted: ComplexArray, chain: ComplexArray, law: ComplexArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """A/F (C, L) with a ``law`` (L,), and the derivatives (C, L) of each line in the law's value there.

        ``predicted`` (C, L) is A/F without it and ``chain`` (C, L) what the measuring chain makes of it. Exact in the
        law, however stiff: what it is pushed by is what moves there with it in place. A static flexibility that the
        reduced coordinates miss there is taken for the law's own, and a record ends as it does without the law.
        """
        acts = self.course[[c.run for c in here.problem.measured.channels]]
        first = self.places[0]
        if first.rows is None:
            assert first.mask is not None
            factor = predicted * (first.mask * acts)[:, None]
            return predicted + factor * law, factor
        found, slopes = predicted.copy(), np.zeros_like(predicted)
        for k, group in enumerate(here.groups):
            own = np.array([reduced_row(group, p.rows[k]) for p in self.places if p.rows is not None])
            shares = [float(acts[group.channels[rows[0]]]) for rows in group.runs]
            for channels, change, slope in _in_runs(here, group, own, [share * law for share in shares]):
                found[channels] += chain[channels] * change
                slopes[channels] = acts[channels, None] * chain[channels] * slope
        return found, slopes


def _in_runs(
    here: Anchor, group: Reduced, own: Array, laws: Sequence[ComplexArray]
) -> list[tuple[NDArray[np.intp], ComplexArray, ComplexArray]]:
    """Of every run of a group its channels, what its law (L,) at rows ``own`` (p, m) changes of A/F, and the slopes.

    With x what moves at the places, x = d - G z x for what the shaker moves there, d (p,), and a unit force at each,
    G (p, p); then A/F changes by -a z x, a (channels, p) being what a unit force at each does.
    """
    omega = 2 * np.pi * here.problem.measured.frequency_hz
    sensors, count = group.matrices.axis.shape[0], own.shape[0]
    loads = [group.masses_kg[rows] * group.roving for rows in group.runs]
    # What moves at the places differs from run to run by the masses that rove: they are rows of each run, without mass.
    spots = [sensors + k * count + np.arange(count) for k in range(len(group.runs))]
    runs = tuple(np.concatenate(pair) for pair in zip(group.runs, spots, strict=True))
    masses = tuple(np.concatenate([mass, np.zeros(count)]) for mass in loads)
    more = count * len(group.runs)
    seen = replace(
        group.matrices,
        axis=np.vstack([group.matrices.axis, *[own] * len(group.runs)]),
        tilt=np.vstack([group.matrices.tilt, np.zeros((more, own.shape[1]))]),
        spare=np.concatenate([group.matrices.spare, np.zeros(more)]),
    )
    poles = poles_of(seen, omega)
    by_drive = accelerances(seen, omega, runs, masses, poles)
    pushed = [replace(seen, drive=row, spare=np.zeros(sensors + more)) for row in own]
    by_place = np.stack([accelerances(one, omega, runs, masses, poles) for one in pushed], axis=-1)
    found = []
    for rows, at, law in zip(group.runs, spots, laws, strict=True):
        moved = (by_drive[at] / -(omega**2)).T[:, :, None]
        flexible = (by_place[at] / -(omega**2)[:, None]).transpose(1, 0, 2)
        system = np.eye(count) + law[:, None, None] * flexible
        motion = np.linalg.solve(system, moved)
        felt = by_place[rows].transpose(1, 0, 2)
        change = -(felt @ (law[:, None, None] * motion))[:, :, 0]
        slope = -(felt @ np.linalg.solve(system, motion))[:, :, 0]
        found.append((group.channels[rows], change.T, slope.T))
    return found
