"""The station table of a beam as functions of arc length along its elastic axis."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.airframe import Beam
from vgvt.scenario.axis import Axis, beam_axis
from vgvt.simulation.inertia import MassMoments

# Linear mass density times a quadratic moment is a cubic: two points would do, three also serve the compliance.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(3)


@dataclass(frozen=True, slots=True, eq=False)
class StationTable:
    """A beam's axis with its columns, linear between the stations."""

    beam: Beam
    axis: Axis

    @classmethod
    def of(cls, beam: Beam) -> StationTable:
        """The table of a beam whose mirror image is already written out."""
        return cls(beam, beam_axis(beam))

    @property
    def length_m(self) -> float:
        """Arc length from root to tip."""
        return float(self.axis.arc_length_m[-1])

    def column(self, name: str, arc_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """A station column at some arc lengths; zero where the table leaves the column out."""
        values = getattr(self.beam.stations, name)
        if values is None:
            return np.zeros_like(arc_m)
        return np.asarray(np.interp(arc_m, self.axis.arc_length_m, values))

    def point_m(self, arc_m: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """Positions (…, 3) on the axis."""
        columns = [np.interp(arc_m, self.axis.arc_length_m, self.axis.position_m[:, k]) for k in range(3)]
        return np.stack(columns, axis=-1)

    def frames(self, arc_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rows tangent, normal and aft at arc lengths (K,), shape (K, 3, 3), orthonormal."""
        i = self._segment(arc_m)
        return np.stack([self.axis.tangent[i], self.axis.normal[i], self.axis.aft[i]], axis=1)

    def frame(self, arc_m: float) -> NDArray[np.float64]:
        """Rows tangent, normal and aft at one arc length, shape (3, 3), orthonormal."""
        return np.asarray(self.frames(np.array([arc_m]))[0])

    def nearest_arc_m(self, position_m: NDArray[np.float64]) -> float:
        """Arc length of the point of the axis nearest to a position (3,)."""
        axis, point = self.axis, np.asarray(position_m, dtype=float)
        i, along = _nearest(axis.position_m.tobytes(), point.tobytes())
        return float(axis.arc_length_m[i] + along * axis.segment_length_m[i])

    def compliances(self, name: str, edges_m: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Integral of 1/stiffness over the cells between edges (K + 1,), rad/(N m), and the arcs of its centroids."""
        arc, weight, first = self._gauss(edges_m)
        share = weight / self.column(name, arc)
        total = np.add.reduceat(share, first)
        return total, np.add.reduceat(share * arc, first) / total

    def mean_by_compliance(
        self, name: str, along: NDArray[np.float64], edges_m: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Means (K, 3), by compliance, over the cells between edges (K + 1,) of vectors of the segments (N - 1, 3)."""
        arc, weight, first = self._gauss(edges_m)
        share = weight / self.column(name, arc)
        total = np.add.reduceat(share, first)
        return np.asarray(np.add.reduceat(share[:, None] * along[self._segment(arc)], first) / total[:, None])

    def moments(self, edges_m: NDArray[np.float64]) -> tuple[MassMoments, ...]:
        """Mass moments of the K pieces between arc lengths (K + 1,).

        A section is thin: its mass lies along the chord, so the inertia about
        the normal equals the pitch inertia and that about the chord is zero.
        """
        return self._moments(edges_m, "mass_kg_per_m", "cg_offset_m", "pitch_inertia_kg_m")

    def air_moments(self, edges_m: NDArray[np.float64]) -> tuple[MassMoments, ...]:
        """The same of the air that the pieces move with them; none where the table has none."""
        if not any(self.beam.stations.air_kg_per_m or ()):
            return ()
        return self._moments(edges_m, "air_kg_per_m", "air_offset_m", "air_pitch_inertia_kg_m")

    def _moments(
        self, edges_m: NDArray[np.float64], mass_name: str, offset: str, pitch_name: str
    ) -> tuple[MassMoments, ...]:
        arc, weight, first = self._gauss(edges_m)
        mass, pitch = weight * self.column(mass_name, arc), weight * self.column(pitch_name, arc)
        aft = self.axis.aft[self._segment(arc)]
        centre = self.point_m(arc) + self.column(offset, arc)[:, None] * aft
        moment = mass[:, None] * centre
        second = moment[:, :, None] * centre[:, None, :] + (pitch[:, None] * aft)[:, :, None] * aft[:, None, :]
        pieces = (np.add.reduceat(values, first) for values in (mass, moment, second))
        return tuple(MassMoments(float(m), c, s) for m, c, s in zip(*pieces, strict=True))

    def _segment(self, arc_m: NDArray[np.float64]) -> NDArray[np.intp]:
        last = self.axis.arc_length_m.size - 2
        return np.clip(np.searchsorted(self.axis.arc_length_m, arc_m, side="right") - 1, 0, last)

    def _gauss(self, edges_m: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.intp]]:
        """Gauss points and weights (G,) between edges (K + 1,), split at the stations, and each piece's first (K,)."""
        return _gauss(self.axis.arc_length_m.tobytes(), np.asarray(edges_m, dtype=float).tobytes())


# Every variant of an aircraft asks for the same things, most of which stay where they are.
@lru_cache(maxsize=4096)
def _nearest(axis: bytes, position: bytes) -> tuple[int, float]:
    """The segment of an axis (K, 3) that is nearest to a position (3,), and the share of it that is passed there."""
    points, place = np.frombuffer(axis).reshape(-1, 3), np.frombuffer(position)
    leg, start = np.diff(points, axis=0), points[:-1]
    along = np.clip(((place - start) * leg).sum(axis=1) / (leg**2).sum(axis=1), 0.0, 1.0)
    i = int(np.argmin(np.linalg.norm(place - start - along[:, None] * leg, axis=1)))
    return i, float(along[i])


# The same for every variant of an aircraft whose stations stay where they are. To be read, not changed.
@lru_cache(maxsize=256)
def _gauss(stations: bytes, edges: bytes) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.intp]]:
    arcs, ends = np.frombuffer(stations), np.frombuffer(edges)
    inner = arcs[(arcs > ends[0]) & (arcs < ends[-1])]
    splits = np.union1d(ends, inner)
    half = np.diff(splits)[:, None] / 2
    middle = (splits[:-1, None] + splits[1:, None]) / 2
    first = np.searchsorted(splits, ends[:-1]) * _POINTS.size
    return (middle + half * _POINTS).ravel(), (half * _WEIGHTS).ravel(), first
