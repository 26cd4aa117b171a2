"""What accelerometers feel of a rig that moves a little: rows of displacement and of the gravity that tilts into them.

A sensor that sits between two links of a beam has several seats; its row is their sum, each counted by its weight.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.simulation.assembly import Rig
from vgvt.simulation.linear import LinearModel, linearise, site_row
from vgvt.simulation.rig import GRAVITY_M_PER_S2
from vgvt.simulation.seats import MeasurementPoint

_UP = np.array([0.0, 0.0, 1.0])


def linearised_at(rig: Rig, points: Sequence[MeasurementPoint]) -> LinearModel:
    """The linear model of a rig, ``displacement`` (points, n) along the axes of ``points``."""
    seats = [(site, p.axis) for p in points for site, _ in p.weighted_sites]
    linear = linearise(rig.model, rig.qpos, tuple(seats))
    return replace(linear, displacement=_summed(points, linear.displacement))


def displacement_rows(rig: Rig, points: Sequence[MeasurementPoint]) -> NDArray[np.float64]:
    """Displacement of points along their axes, rows (points, nv)."""
    data = at_rest(rig)
    rows = [site_row(rig.model, data, site, p.axis) for p in points for site, _ in p.weighted_sites]
    return _summed(points, np.array(rows))


def tilt_rows(rig: Rig, points: Sequence[MeasurementPoint]) -> NDArray[np.float64]:
    """What a small rotation of each sensor lets it feel of gravity, rows (points, nv)."""
    data = at_rest(rig)
    seats = [(site, p.axis) for p in points for site, _ in p.weighted_sites]
    rows = np.zeros((len(seats), rig.model.nv))
    for k, (name, axis) in enumerate(seats):
        site = rig.model.site(name).id
        rotation = np.zeros((3, rig.model.nv))
        mujoco.mj_jacSite(rig.model, data, None, rotation, site)
        direction = data.site_xmat[site].reshape(3, 3) @ axis
        rows[k] = GRAVITY_M_PER_S2 * np.cross(direction, _UP) @ rotation
    return _summed(points, rows)


def at_rest(rig: Rig) -> mujoco.MjData:
    """The state of a rig at its equilibrium."""
    data = mujoco.MjData(rig.model)
    data.qpos[:] = rig.qpos
    mujoco.mj_forward(rig.model, data)
    return data


def _summed(points: Sequence[MeasurementPoint], rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rows (points, n) of rows (seats, n), the points' seats one after another."""
    out, k = np.zeros((len(points), rows.shape[1])), 0
    for p, point in enumerate(points):
        for _, weight in point.weighted_sites:
            out[p] += weight * rows[k]
            k += 1
    return out
