"""Where a residual comes from, without a hypothesis: a free force at each place that could carry one.

Any single interface, linear or not, is a force g(ω) at a coordinate h: it leaves -a_h(ω) g(ω) in the responses.
That is projected out line by line, and what the unknowns can take of the rest is taken. The force over the
motion there, z(ω), says of which type the interface is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data.mode_numbers import number_text
from vgvt.data.shown import counted, headed
from vgvt.reconcile.evidence.free_places import (
    FreePlace,
    answered,
    free_places,
    moved,
    places_differ,
    with_article,
)
from vgvt.reconcile.evidence.smooth_law import by_first_of_law
from vgvt.reconcile.evidence.whole_airframe import whole_airframe
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.fitting.misfit import standardised
from vgvt.reconcile.prediction.surrogate import Anchor, anchor
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.work.one_thread import one_thread

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
# The type is read at this many of the best places.
_TYPED = 8
HARDLY = 0.05
"""A place that explains less of the residual is not worth the telling."""
_POLES, _RATIOS = 240, (0.003, 0.01, 0.03, 0.08)
# Of the force's power: with so little left by the simple laws nothing swings there, however well data show the rest.
_TRACE = 0.02
_UNITS = {False: ("N/m", "kg", "N s/m"), True: ("N m/rad", "kg m^2", "N m s/rad")}


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """A place and how much of the residual a free force there explains, at most 1.

    What chance explains is taken off: a place that does no better is a little below 0.

    ``kind`` is 'structure', 'drive', 'sensor', or 'airframe' for all of its stiffness; ``type`` what z(ω) (L,) looks
    like and ``size`` with its unit for a place on the structure. Where something ``turns`` z is a moment over an angle,
    in N m/rad, and else in N/m.
    """

    label: str
    kind: str
    position_m: tuple[float, float, float] | None
    explained: float
    type: str
    size: float
    unit: str
    dynamic_stiffness: ComplexArray | None
    turns: bool = False

    def __repr__(self) -> str:
        return headed(f"Place {_ranked(self)}")


def words_of_place(best: Place) -> str:
    """One sentence about the place that explains most."""
    if best.explained < HARDLY:
        return f"No free force or factor at one place would explain {100 * HARDLY:.0f} % of the residual"
    freed = best.label
    if best.kind != "structure":
        freed = f"factor on {with_article(best.label, best.kind)}"
    return f"A free {freed} would explain {100 * best.explained:.0f} % of the residual" + _looks_like(best)


def _looks_like(place: Place) -> str:
    """What the dynamic stiffness at a place looks like, in words."""
    if place.type in ("", "unclear"):
        return ""
    if place.type == "resonant":
        return f"; it looks like something that swings at {place.size:.1f} Hz"
    return f"; it looks like a {place.type} of {place.size:.3g} {place.unit}"


def _ranked(place: Place) -> str:
    """A place after the share of the residual that it explains."""
    return f"{number_text(100 * place.explained, '{:.1f}')} %: {place.label}{_looks_like(place)}"


@dataclass(frozen=True, slots=True, eq=False)
class Localisation:
    """Places by what they explain, best first, and the χ² that they share out."""

    places: tuple[Place, ...]
    frequency_hz: Array
    chi2_per_dof: float

    def __repr__(self) -> str:
        of = f"{counted(len(self.places), 'place')} for χ² per degree of freedom {self.chi2_per_dof:.3g}"
        return headed(f"Localisation: {of}", map(_ranked, self.places), most=5)


@one_thread
def localise(
    null: Fit, progress: Callable[[float, str], None] | None = None, *, everywhere: bool = True
) -> Localisation:
    """Rank every place by the residual that a force, a gain or a single sensor there would explain.

    ``everywhere`` asks for a factor on the whole airframe's stiffness, too, but beside joints that depend on level.
    No place where one point alone was fitted, in however many runs: a free force anywhere explains all that it has.
    """
    problem = null.problem
    if not places_differ(problem):
        return Localisation((), problem.measured.frequency_hz, null.chi2_per_dof)
    here = anchor(problem, null.u, null.hypotheses, null.e)
    keep = problem.split.train
    measured = problem.measured
    rho = standardised(problem, (null.predicted - measured.values)[keep], null.sigma)
    count, lines = rho.shape
    # The real tangent holds sqrt(2) times real parts, then imaginary ones.
    half = null.tangent.reshape(2, count, lines, -1) / np.sqrt(2)
    tangent = half[0] + 1j * half[1]
    all_of_it = _Rest.of(rho, tangent, null.scores)
    left = all_of_it.least(None)
    found: list[tuple[float, FreePlace, ComplexArray]] = []
    trials = free_places(problem, here, keep)
    if everywhere and all(group.levels is None for group in here.groups):
        trials += whole_airframe(here)
    chain = here.chain(null.u, null.e)
    for k, c in enumerate(trials):
        if progress is not None:
            progress(k / len(trials), f"localise {c.label}")
        whole = c.kind == "airframe"
        answer = by_first_of_law(here, c, null.u, null.e) if whole else answered(here, c, null.predicted, chain)
        scaled = standardised(problem, answer[keep], null.sigma)
        remaining = all_of_it.least(scaled)
        chance = lines * (scaled.any(axis=1).any())
        explained = float((left - remaining - chance) / left)
        found.append((explained, c, scaled))
    ranked = []
    for k, (explained, c, scaled) in enumerate(sorted(found, key=lambda f: -f[0])):
        kind, size, unit, ratio = "", 0.0, "", None
        if c.kind == "structure" and c.rows is not None:
            z = _stiffness(problem, here, c.rows[0], rho, scaled)
            ratio = -z[0] / z[1]
            if k < _TYPED:
                kind, size, unit = interface_type(2 * np.pi * measured.frequency_hz, *z, turns=c.turns)
        ranked.append(Place(c.label, c.kind, c.position_m, explained, kind, size, unit, ratio, c.turns))
    return Localisation(tuple(ranked), measured.frequency_hz, null.chi2_per_dof)


@dataclass(frozen=True, slots=True, eq=False)
class _Rest:
    """Misfit ``rho`` (C, L), its ``tangent`` (C, L, p) and ``scores`` (p,), with the products of all three.

    ``normal`` (p, p) and ``gradient`` (p,) are half of the curvature and of the slope of the square ``total``.
    """

    rho: ComplexArray
    tangent: ComplexArray
    normal: Array
    gradient: Array
    total: float

    @classmethod
    def of(cls, rho: ComplexArray, tangent: ComplexArray, scores: Array) -> _Rest:
        flat, vector = tangent.reshape(-1, tangent.shape[2]), rho.ravel()
        return cls(
            rho, tangent, (flat.conj().T @ flat).real + 0.5 * np.eye(scores.size),
            (flat.conj().T @ vector).real + 0.5 * scores,
            float(np.sum(np.abs(vector) ** 2)) + 0.5 * float(scores @ scores),
        )  # fmt: skip

    def least(self, direction: ComplexArray | None) -> float:
        """Least |P (ρ + J δ)|² + |u + δ|² over δ, with P taking a free amount of ``direction`` (C, L) off every line.

        What is taken off is one value a line: its products are taken off those of all.
        """
        normal, gradient, total = self.normal, self.gradient, self.total
        if direction is not None:
            power = np.sum(np.abs(direction) ** 2, axis=0)
            unit = (direction / np.sqrt(np.where(power > 0, power, 1.0))).conj()
            along = np.sum(unit * self.rho, axis=0)
            moved = np.matmul(unit.T[:, None, :], self.tangent.transpose(1, 0, 2))[:, 0]
            normal = normal - (moved.conj().T @ moved).real
            gradient = gradient - (moved.conj().T @ along).real
            total -= float(np.sum(np.abs(along) ** 2))
        return total - float(gradient @ np.linalg.solve(normal, gradient))


def _stiffness(
    problem: Problem, here: Anchor, row: Array, rho: ComplexArray, scaled: ComplexArray
) -> tuple[ComplexArray, ComplexArray, Array]:
    """Free force g (L,), motion there (L,), both per unit of shaker force, and the weight of each line (L,)."""
    omega = 2 * np.pi * problem.measured.frequency_hz
    power = np.sum(np.abs(scaled) ** 2, axis=0)
    force = -np.sum(scaled.conj() * rho, axis=0) / np.where(power > 0, power, 1.0)
    by_drive, by_itself = moved(here.groups[0], row, omega)
    return force, by_drive + by_itself * force, power


def interface_type(
    omega: Array, force: ComplexArray, motion: ComplexArray, weight: Array, *, turns: bool = False
) -> tuple[str, float, str]:
    """The simplest law force = -z motion that fits best: its name, its size and its unit.

    N/m, kg or N s/m; for a moment over an angle, where something ``turns``, N m/rad, kg m^2 or N m s/rad.

    ``omega`` (L,) rad/s, ``force``, ``motion``, ``weight`` (L,). 'resonant' where a pole in z with what the
    calibration may have put beside it, a stiffness, mass and damper, does much better than these three alone, and
    these leave more than a trace; then the size is the pole's frequency in Hz. 'unclear' where half of the force is
    left by each law.
    """
    names = zip(("stiffness", "mass", "damper"), _UNITS[turns], strict=True)
    laws = np.stack([np.ones_like(omega), -(omega**2), 1j * omega], axis=1)
    scale = np.sqrt(weight)
    target = _parts(scale * force)
    total = float(target @ target)
    best, least = ("unclear", 0.0, ""), 0.5 * total
    for k, (name, unit) in enumerate(names):
        size, left = _least(_parts((-laws[:, k] * motion * scale)[:, None]), target)
        if (left < least and size[0] > 0) or left < 0.9 * least:
            best, least = (name, float(size[0]), unit), float(left)
    plain = _parts(-laws * motion[:, None] * scale[:, None])
    without = float(_least(plain, target)[1])
    if without < _TRACE * total:
        return best
    enough = 0.4 * min(without, total)
    frequencies = np.repeat(np.exp(np.linspace(np.log(omega[0]), np.log(omega[-1]), _POLES)), len(_RATIOS))
    ratios = np.tile(_RATIOS, _POLES)
    pole = frequencies[:, None] ** 2 + 2j * (ratios * frequencies)[:, None] * omega
    columns = _parts((omega**2 * pole / (pole - omega**2) * motion * scale).T).T[:, :, None]
    beside = np.broadcast_to(plain, (frequencies.size, *plain.shape))
    sizes, lefts = _least(np.concatenate([columns, beside], axis=2), target)
    lefts = np.where(sizes[:, 0] > 0, lefts, np.inf)
    least_left = int(lefts.argmin())
    if lefts[least_left] < enough:
        return "resonant", float(frequencies[least_left] / (2 * np.pi)), "Hz"
    return best


def _parts(values: ComplexArray) -> Array:
    """Real parts, then imaginary ones, along the first axis."""
    return np.concatenate([values.real, values.imag])


def _least(columns: Array, target: Array) -> tuple[Array, Array]:
    """Least-squares amounts (…, k) of columns (…, 2 L, k), and the square sums (…) that they leave of (2 L,)."""
    length = np.maximum(np.linalg.norm(columns, axis=-2), 1e-300)
    unit = columns / length[..., None, :]
    turned = unit.swapaxes(-1, -2)
    normal = turned @ unit + 1e-10 * np.eye(length.shape[-1])
    amounts = np.linalg.solve(normal, (turned @ target)[..., None])
    left = target - (unit @ amounts)[..., 0]
    return amounts[..., 0] / length, np.sum(left**2, axis=-1)
