"""Poles of a matrix fraction over all orders, and those of the modes among them with their standard deviations."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.fraction_uncertainty import pole_deviations
from vgvt_identifiers.matrix_fraction import Fraction, FractionRows, ReducedEquations, fraction_at, reduced_equations
from vgvt_identifiers.stabilisation import Cluster, Criteria, PolesAtOrder, Stabilisation, stabilise

_SMALLEST_ORDER = 2
_LINES_PER_ORDER = 6
_EVERY_ORDER = 32  # up to that many poles; every other order is enough beyond
_MARGIN = 0.02  # of the band: a mode at its edge shall not lose poles that wander across it
_RESOLVED = 0.25  # of the distance of two lines
_MOVED = 0.35  # half widths: poles that near are one mode which moves between runs, and not two


@dataclass(frozen=True, slots=True, eq=False)
class FractionPoles:
    """The models of every order, and for each the poles in and next to the band: ``places`` index the model's."""

    rows: FractionRows
    equations: ReducedEquations
    fractions: tuple[Fraction, ...]
    places: tuple[NDArray[np.intp], ...]
    table: tuple[PolesAtOrder, ...]

    @property
    def resolution_rad_s(self) -> float:
        """Distance of poles below which the records cannot tell them apart."""
        step = self.rows.frequency_hz[1] - self.rows.frequency_hz[0]
        return float(_RESOLVED * 2 * np.pi * step)


@dataclass(frozen=True, slots=True, eq=False)
class ModePoles:
    """Poles (M,) rad/s of the modes and standard deviations (M, 2) of their real and imaginary parts."""

    poles_rad_s: NDArray[np.complex128]
    std_rad_s: NDArray[np.float64]

    def where(self, mask: NDArray[np.bool_], other: ModePoles) -> ModePoles:
        """These poles where ``mask`` (M,) is true, those of another elsewhere."""
        poles = np.where(mask, self.poles_rad_s, other.poles_rad_s)
        return ModePoles(poles, np.where(mask[:, None], self.std_rad_s, other.std_rad_s))

    @property
    def frequency_std_hz(self) -> NDArray[np.float64]:
        """Standard deviations (M,) of the natural frequencies."""
        p, size = self.poles_rad_s, np.abs(self.poles_rad_s)
        return np.asarray(np.hypot(p.real * self.std_rad_s[:, 0], p.imag * self.std_rad_s[:, 1]) / size / (2 * np.pi))

    @property
    def damping_ratio_std(self) -> NDArray[np.float64]:
        """Standard deviations (M,) of the damping ratios."""
        p, size = self.poles_rad_s, np.abs(self.poles_rad_s)
        cross = p.imag**2 * self.std_rad_s[:, 0], p.real * p.imag * self.std_rad_s[:, 1]
        return np.asarray(np.hypot(*cross) / size**3)


def fraction_poles(
    rows: FractionRows, band_hz: tuple[float, float], largest_order: int = 32, noise_removed: float = 0.95
) -> FractionPoles:
    """Poles of all orders up to ``largest_order``, or what the lines can hold, in and next to ``band_hz``.

    ValueError when there are not even lines for the smallest order.
    """
    order = min(largest_order, rows.frequency_hz.size // _LINES_PER_ORDER)
    if order < _SMALLEST_ORDER:
        raise ValueError(f"{rows.frequency_hz.size} lines cannot hold a model of order {_SMALLEST_ORDER}")
    equations = reduced_equations(rows, order, noise_removed)
    step = 1 if order <= _EVERY_ORDER else 2
    fractions = tuple(fraction_at(equations, n) for n in range(_SMALLEST_ORDER, order + 1, step))
    margin = _MARGIN * (band_hz[1] - band_hz[0])
    places = []
    for fraction in fractions:
        frequency = np.abs(fraction.poles_rad_s) / (2 * np.pi)
        inside = (frequency > band_hz[0] - margin) & (frequency < band_hz[1] + margin)
        places.append(np.flatnonzero(inside & (fraction.poles_rad_s.imag > 0)))
    table = tuple(
        PolesAtOrder(f.order, f.poles_rad_s[at], f.shapes[at]) for f, at in zip(fractions, places, strict=True)
    )
    return FractionPoles(rows, equations, fractions, tuple(places), table)


def stabilised(poles: FractionPoles, band_hz: tuple[float, float], criteria: Criteria, runs: int = 1) -> Stabilisation:
    """The clusters of the poles, with those outside ``band_hz`` dropped and the records' resolution in the criteria.

    A common denominator of several ``runs`` shows a mode that moves from run to
    run as two poles that all but coincide; the one that came later is dropped.
    """
    result = stabilise(poles.table, replace(criteria, resolution_rad_s=poles.resolution_rad_s))
    for cluster in result.modes:
        if not band_hz[0] <= cluster.frequency_hz <= band_hz[1]:
            result = result.without(cluster, f"{cluster.frequency_hz:.4g} Hz: outside the band")
    return _without_moved(result) if runs > 1 else result


def _without_moved(result: Stabilisation) -> Stabilisation:
    for cluster in sorted(result.modes, key=lambda c: (c.share, c.stable)):
        near = [c for c in result.modes if c is not cluster and abs(c.pole_rad_s - cluster.pole_rad_s) < _reach(c)]
        if near:
            what = f"{cluster.frequency_hz:.4g} Hz: one mode with {near[0].frequency_hz:.4g} Hz"
            result = result.without(cluster, f"{what}, which moves between runs")
    return result


def _reach(cluster: Cluster) -> float:
    return _MOVED * abs(cluster.pole_rad_s.real)


def mode_poles(poles: FractionPoles, stabilisation: Stabilisation) -> ModePoles:
    """The representative poles of the modes, in order of frequency.

    Their variance is that of the noise, to first order, and the spread over
    the orders, in which bias shows.
    """
    modes = stabilisation.modes
    starts = np.cumsum([0, *(at.size for at in poles.places)])
    std = np.empty((len(modes), 2))
    for row, cluster in enumerate(modes):
        which = int(np.searchsorted(starts, cluster.representative, side="right")) - 1
        inside = poles.places[which][[cluster.representative - starts[which]]]
        noise = pole_deviations(poles.rows, poles.equations, poles.fractions[which], inside)[0]
        size = abs(cluster.pole_rad_s)
        spread = np.array([size * cluster.damping_spread, 2 * np.pi * cluster.frequency_spread_hz])
        std[row] = np.hypot(noise, spread)
    return ModePoles(np.array([c.pole_rad_s for c in modes], dtype=complex), std)
