"""Airframes whose wings bend in plan and out of it, and their frequencies by the simulator and by finite elements."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from finite_element import build, natural_modes
from numpy.typing import NDArray
from scipy.linalg import eigh

from vgvt.scenario.airframe import Airframe
from vgvt.simulation.airframe import airframe_spec, cut_airframe
from vgvt.simulation.linear import linearise

Array = NDArray[np.float64]
MODES = 10
_ELEMENTS = 60


def bent_wings(points_m: Array, cells: int, *, tip: float = 1.0, in_plane: bool = True, items: Any = ()) -> Airframe:
    """A small body with wings along ``points_m`` (N, 3), whose columns fall to the share ``tip`` at the tip."""
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points_m, axis=0), axis=1))])
    taper = 1 + (tip - 1) * arc / arc[-1]
    nominal = {
        "bending_stiffness_n_m2": 40.0,
        "torsional_stiffness_n_m2": 20.0,
        "mass_kg_per_m": 1.0,
        "pitch_inertia_kg_m": 0.01,
        "cg_offset_m": 0.02,
    } | ({"in_plane_stiffness_n_m2": 300.0} if in_plane else {})
    stations = {"position_m": points_m.tolist()} | {name: (value * taper).tolist() for name, value in nominal.items()}
    body = {"mass_kg": 0.5, "centre_of_gravity_m": (0.03, 0.0, 0.02), "inertia_kg_m2": (0.004, 0.006, 0.008)}
    wing = {"name": "wing", "mirror": True, "cells": cells, "stations": stations}
    return Airframe.model_validate({"name": "bent", "body": body, "beam": [wing], "item": items})


def with_cells(airframe: Airframe, cells: int) -> Airframe:
    """The same cut into other cells."""
    return airframe.model_copy(
        update={"beam": tuple(beam.model_copy(update={"cells": cells}) for beam in airframe.beam)}
    )


def chain_hz(airframe: Airframe) -> Array:
    """The first elastic frequencies of the bare airframe as the simulator cuts it, without weight."""
    model = airframe_spec(cut_airframe(airframe)).compile()
    assert isinstance(model, mujoco.MjModel)
    bare = linearise(model, np.zeros(model.nq))
    squares = eigh((bare.stiffness + bare.stiffness.T) / 2, bare.mass, eigvals_only=True)
    return np.asarray(np.sqrt(squares[6 : 6 + MODES]) / (2 * np.pi))


def exact_hz(airframe: Airframe) -> Array:
    """The same of the finite elements, whose error of second order, that of torsion, is taken off."""
    coarse, fine = (
        natural_modes(model.mass, model.stiffness)[0][6 : 6 + MODES]
        for model in (build(airframe, elements) for elements in (_ELEMENTS // 2, _ELEMENTS))
    )
    return np.asarray((4 * fine - coarse) / 3)
