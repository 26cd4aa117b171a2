"""From poles at many model orders to the few that persist: stability marks, clusters, and a reason for each pole.

Poles of a structure come back at every order that is high enough, poles that a
model spends on noise wander: Van der Auweraer and Peeters, Discriminating physical
poles from mathematical poles in high order systems, IEEE IMTC, 2004.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vgvt.data import PoleCandidate, modal_assurance

_NEVER = 1e6  # distance between two poles of one order, which cannot be the same mode


@dataclass(frozen=True, slots=True, eq=False)
class PolesAtOrder:
    """Poles (n,) rad/s of one model order with positive imaginary part, and a vector (n, D) for each.

    ``vectors`` are shapes or participation factors, the same D at every order.
    ``std_rad_s`` (n, 2) are standard deviations of the real and the imaginary part, where known.
    """

    order: int
    poles_rad_s: NDArray[np.complex128]
    vectors: NDArray[np.complex128]
    std_rad_s: NDArray[np.float64] | None = None


@dataclass(frozen=True, slots=True)
class Criteria:
    """When a pole counts as stable and a cluster as a mode.

    The first three compare a pole with the nearest one of the order below:
    relative change of frequency and of damping ratio, and MAC. ``cut`` is the
    largest mean distance inside a cluster, in half-power half widths |Re p| of its
    poles plus ``resolution_rad_s``, below which records cannot tell frequencies
    apart. A cluster is a mode when it holds poles of ``least_share`` of all
    orders, of ``least_presence`` of the orders since its first, and when
    ``least_stable`` of them are stable. ``largest_damping_ratio`` is judged without ``added_decay_rad_per_s``, the
    damping of an exponential window.
    """

    frequency_change: float = 0.01
    damping_change: float = 0.05
    least_mac: float = 0.98
    largest_damping_ratio: float = 0.3
    cut: float = 0.5
    resolution_rad_s: float = 0.0
    least_share: float = 0.35
    least_presence: float = 0.7
    least_stable: float = 0.4
    added_decay_rad_per_s: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Cluster:
    """Poles of different orders that are one: ``members`` index the poles of the stabilisation.

    ``representative`` is the member nearest to the median of those in the upper
    half of the orders, where bias is least, and the spreads are standard
    deviations over those. ``share`` is the part of all orders that has a member,
    ``stable`` the part of the members that is stable.
    """

    members: tuple[int, ...]
    representative: int
    pole_rad_s: complex
    vector: NDArray[np.complex128]
    frequency_spread_hz: float
    damping_spread: float
    share: float
    stable: float
    kept: bool
    reason: str

    @property
    def frequency_hz(self) -> float:
        """Natural frequency of the representative pole."""
        return float(abs(self.pole_rad_s) / (2 * np.pi))

    @property
    def damping_ratio(self) -> float:
        """Damping ratio of the representative pole."""
        return float(-self.pole_rad_s.real / abs(self.pole_rad_s))


@dataclass(frozen=True, slots=True, eq=False)
class Stabilisation:
    """All poles (n,) with their orders, stability marks (n, 3) of frequency, damping and vector, and clusters.

    ``clusters`` are in order of frequency; ``reasons`` (n,) are those of the
    poles that belong to none, and empty texts for the others.
    """

    poles_rad_s: NDArray[np.complex128]
    orders: NDArray[np.intp]
    marks: NDArray[np.bool_]
    clusters: tuple[Cluster, ...]
    reasons: tuple[str, ...]

    @property
    def modes(self) -> tuple[Cluster, ...]:
        """The clusters that count as modes."""
        return tuple(c for c in self.clusters if c.kept)

    def without(self, cluster: Cluster, reason: str) -> Stabilisation:
        """The same with one cluster dropped for a ``reason`` that came up later."""
        changed = tuple(replace(c, kept=False, reason=reason) if c is cluster else c for c in self.clusters)
        return replace(self, clusters=changed)

    def candidates(self) -> tuple[PoleCandidate, ...]:
        """Every pole with its fate, by order and frequency."""
        kept, reasons = np.zeros(self.orders.size, dtype=bool), list(self.reasons)
        for cluster in self.clusters:
            for i in cluster.members:
                kept[i], reasons[i] = cluster.kept, cluster.reason
        frequency = np.abs(self.poles_rad_s) / (2 * np.pi)
        damping = -self.poles_rad_s.real / np.abs(self.poles_rad_s)
        return tuple(
            PoleCandidate(float(frequency[i]), float(damping[i]), int(self.orders[i]), bool(kept[i]), reasons[i])
            for i in np.lexsort((frequency, self.orders))
        )


def stabilise(table: Sequence[PolesAtOrder], criteria: Criteria | None = None) -> Stabilisation:
    """Marks, clusters and fates of the poles of several model orders; no mode for an empty table.

    Clusters come from average linkage on the distance of poles in units of
    their own width, so that light damping and narrow pairs stay apart; two poles of one
    order never share a cluster. ValueError when an order comes twice.
    """
    limits = criteria if criteria is not None else Criteria()
    rows = sorted(table, key=lambda t: t.order)
    if len({t.order for t in rows}) != len(rows):
        raise ValueError("an order comes twice in the table")
    if not any(t.poles_rad_s.size for t in rows):
        return Stabilisation(np.empty(0, complex), np.empty(0, int), np.empty((0, 3), bool), (), ())
    poles = np.concatenate([t.poles_rad_s for t in rows])
    vectors = np.concatenate([t.vectors for t in rows])
    orders = np.repeat([t.order for t in rows], [t.poles_rad_s.size for t in rows])
    floors = np.concatenate([_floor(t, limits.resolution_rad_s) for t in rows])
    marks = _marks(poles, vectors, orders, [t.order for t in rows], floors, limits)
    reasons = _refused(poles, limits)
    sound = np.flatnonzero([not r for r in reasons])
    groups = _groups(poles[sound], vectors[sound], orders[sound], floors[sound], limits.cut)
    judge = _Judge(poles, vectors, orders, marks, np.array([t.order for t in rows]), limits)
    clusters = [judge.cluster(sound[g]) for g in groups]
    for i in [i for c in clusters if len(c.members) == 1 for i in c.members]:
        reasons[i] = "comes up at one order only"
    several = sorted((c for c in clusters if len(c.members) > 1), key=lambda c: c.frequency_hz)
    return Stabilisation(poles, orders, marks, tuple(several), tuple(reasons))


def _floor(row: PolesAtOrder, resolution: float) -> NDArray[np.float64]:
    """Least distance (n,) that means anything: the resolution, and two standard deviations where known."""
    if row.std_rad_s is None:
        return np.full(row.poles_rad_s.size, resolution)
    known = np.where(np.isfinite(row.std_rad_s), row.std_rad_s, 0.0)
    # Doubtful poles shall not buy themselves a place in every cluster: no more than their own width.
    return np.asarray(resolution + np.minimum(2 * np.hypot(*known.T), np.abs(row.poles_rad_s.real)))


def _refused(poles: NDArray[np.complex128], limits: Criteria) -> list[str]:
    """Reasons that need no other order."""
    texts = np.full(poles.size, "", dtype=object)
    own = poles + limits.added_decay_rad_per_s
    heavy = -own.real > limits.largest_damping_ratio * np.abs(own)
    texts[heavy] = f"damping ratio above {limits.largest_damping_ratio:g}"
    texts[poles.real >= 0] = "unstable: negative damping"
    return [str(t) for t in texts]


def _marks(
    poles: NDArray[np.complex128],
    vectors: NDArray[np.complex128],
    orders: NDArray[np.intp],
    ladder: list[int],
    floors: NDArray[np.float64],
    limits: Criteria,
) -> NDArray[np.bool_]:
    """Stability (n, 3) in frequency, damping and vector against the nearest pole of the order below."""
    marks, power = np.zeros((poles.size, 3), dtype=bool), (np.abs(vectors) ** 2).sum(axis=1)
    for below, order in pairwise(ladder):
        old, new = np.flatnonzero(orders == below), np.flatnonzero(orders == order)
        if not old.size or not new.size:
            continue
        near = old[np.argmin(np.abs(poles[new][:, None] - poles[old]), axis=1)]
        size = np.abs(poles[new])
        marks[new, 0] = np.abs(size - np.abs(poles[near])) < limits.frequency_change * size
        change = np.abs(poles[new].real - poles[near].real)
        marks[new, 1] = change < limits.damping_change * (np.abs(poles[new].real) + floors[new])
        cross = np.abs((vectors[new].conj() * vectors[near]).sum(axis=1)) ** 2
        marks[new, 2] = cross > limits.least_mac * power[new] * power[near]
    return marks


def _groups(
    poles: NDArray[np.complex128],
    vectors: NDArray[np.complex128],
    orders: NDArray[np.intp],
    floors: NDArray[np.float64],
    cut: float,
) -> list[NDArray[np.intp]]:
    """Indices of the poles of each cluster, single ones too."""
    from scipy.cluster.hierarchy import fcluster, linkage

    if poles.size < 2:
        return [np.arange(poles.size)] if poles.size else []
    width = np.abs(poles.real) + floors
    mean_width = np.maximum((width[:, None] + width) / 2, 1e-12 * np.abs(poles).max())
    distance = np.abs(poles[:, None] - poles) / mean_width + np.maximum(1 - modal_assurance(vectors, vectors), 0)
    distance = np.minimum(distance, _NEVER)
    distance[orders[:, None] == orders] = _NEVER
    upper = np.triu_indices(poles.size, 1)
    labels = fcluster(linkage(distance[upper], method="average"), cut, criterion="distance")
    return [np.flatnonzero(labels == label) for label in np.unique(labels)]


@dataclass(frozen=True, slots=True, eq=False)
class _Judge:
    """Turns groups of poles into clusters with a verdict."""

    poles: NDArray[np.complex128]
    vectors: NDArray[np.complex128]
    orders: NDArray[np.intp]
    marks: NDArray[np.bool_]
    ladder: NDArray[np.intp]
    limits: Criteria

    def cluster(self, members: NDArray[np.intp]) -> Cluster:
        """The cluster of some poles, kept or dropped with a reason."""
        orders = self.orders[members]
        upper = members[orders >= np.median(self.ladder)]
        upper = upper if upper.size else members
        poles = self.poles[upper]
        median = np.median(poles.real) + 1j * np.median(poles.imag)
        representative = int(upper[np.argmin(np.abs(poles - median))])
        frequency, damping = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
        share = members.size / self.ladder.size
        presence = members.size / int((self.ladder >= orders.min()).sum())
        stable = float(self.marks[members].all(axis=1).mean())
        kept, why = self._verdict(members.size, presence, stable)
        name = f"{abs(self.poles[representative]) / (2 * np.pi):.4g} Hz"
        return Cluster(
            members=tuple(int(i) for i in members),
            representative=representative,
            pole_rad_s=complex(self.poles[representative]),
            vector=self.vectors[representative],
            frequency_spread_hz=float(frequency.std()),
            damping_spread=float(damping.std()),
            share=share,
            stable=stable,
            kept=kept,
            reason=f"{name}: {why}",
        )

    def _verdict(self, count: int, presence: float, stable: float) -> tuple[bool, str]:
        orders = self.ladder.size
        seen = f"at {count} of {orders} orders, stable at {100 * stable:.0f} % of them"
        if count < max(2, self.limits.least_share * orders):
            return False, f"only {seen}; {100 * self.limits.least_share:.0f} % of the orders are needed"
        if presence < self.limits.least_presence:
            return False, f"{seen}, but gone again at {100 * (1 - presence):.0f} % of the orders after its first"
        if stable < self.limits.least_stable:
            return False, f"{seen}: it moves from order to order"
        return True, seen
