"""Uniform beams with closed-form frequencies, as airframes and as complete virtual tests."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.airframe import Airframe
from vgvt.scenario.mass import rigid_body_properties
from vgvt.scenario.model import Scenario

CLAMPED_FREE = np.array([1.8751040687119611, 4.6940911329741746, 7.8547574382376126, 10.995540734875467])
"""beta L of cos(x) cosh(x) = -1 (Blevins, Formulas for Natural Frequency and Mode Shape, 1979, table 8-1)."""
FREE_FREE = np.array([4.7300407448627040, 7.8532046240958376, 10.995607838001671, 14.137165491257464])
"""beta L of cos(x) cosh(x) = 1 (same table)."""


@dataclass(frozen=True)
class UniformBeam:
    """A straight uniform beam along y."""

    length_m: float = 1.5
    bending_stiffness_n_m2: float = 40.0
    torsional_stiffness_n_m2: float = 60.0
    mass_kg_per_m: float = 0.6
    pitch_inertia_kg_m: float = 0.006
    cg_offset_m: float = 0.0

    def bending_hz(self, beta_length: NDArray[np.float64], length_m: float | None = None) -> NDArray[np.float64]:
        """Bending frequencies for roots beta L."""
        length = self.length_m if length_m is None else length_m
        speed = np.sqrt(self.bending_stiffness_n_m2 / self.mass_kg_per_m)
        return np.asarray((beta_length / length) ** 2 * speed / (2 * np.pi))

    def torsion_hz(self, quarter_waves: NDArray[np.float64], length_m: float | None = None) -> NDArray[np.float64]:
        """Torsion frequencies for a number of quarter waves over the length (1, 3, 5 clamped-free; 2, 4, 6 free)."""
        length = self.length_m if length_m is None else length_m
        speed = np.sqrt(self.torsional_stiffness_n_m2 / self.pitch_inertia_kg_m)
        return np.asarray(quarter_waves * speed / (4 * length))


def airframe_of(
    beam: UniformBeam, *, body_mass_kg: float, body_inertia_kg_m2: float, mirror: bool, cells: int = 12, **extra: object
) -> Airframe:
    """The beam from the origin to y = L on a body at the origin; with ``mirror`` also its reflection."""
    station = {
        "position_m": [(0.0, 0.0, 0.0), (0.0, beam.length_m, 0.0)],
        "bending_stiffness_n_m2": [beam.bending_stiffness_n_m2] * 2,
        "torsional_stiffness_n_m2": [beam.torsional_stiffness_n_m2] * 2,
        "mass_kg_per_m": [beam.mass_kg_per_m] * 2,
        "pitch_inertia_kg_m": [beam.pitch_inertia_kg_m] * 2,
        "cg_offset_m": [beam.cg_offset_m] * 2,
        "forward_edge_m": [0.15] * 2,
        "aft_edge_m": [0.15] * 2,
    }
    body = {
        "mass_kg": body_mass_kg,
        "centre_of_gravity_m": (0.0, 0.0, 0.0),
        "inertia_kg_m2": (body_inertia_kg_m2,) * 3,
        "outline_m": [(-0.01, -0.01), (0.01, -0.01), (0.01, 0.01), (-0.01, 0.01)],
    }
    table = {
        "name": "uniform",
        "body": body,
        "beam": [{"name": "wing", "mirror": mirror, "cells": cells, "stations": station}],
    }
    return Airframe.model_validate(table | extra)


def cantilever(beam: UniformBeam, cells: int = 12) -> Airframe:
    """The beam clamped: on a body a hundred thousand times heavier."""
    return airframe_of(beam, body_mass_kg=1e5, body_inertia_kg_m2=1e5, mirror=False, cells=cells)


def free_beam(beam: UniformBeam, cells: int = 12) -> Airframe:
    """A free-free beam of twice the length: two halves joined by a body of next to no mass."""
    return airframe_of(beam, body_mass_kg=1e-9, body_inertia_kg_m2=1e-12, mirror=True, cells=cells)


def virtual_test(airframe: Airframe, span_m: float, *, mirror: bool) -> Scenario:
    """A complete scenario around an airframe: accelerometers fore and aft of the axis along the span.

    The spring sags 0.1 m whatever the mass, and its hook stands 0.1 m above the centre of gravity.
    """
    weighed = rigid_body_properties(airframe)
    hook = tuple(float(v) for v in weighed.centre_of_gravity_m + np.array([0.0, 0.0, 0.1]))
    y = [round(span_m * k / 8, 9) for k in range(1, 9)]
    points = [(x, side * v) for side in ((1, -1) if mirror else (1,)) for v in y for x in (-0.1, 0.1)]
    nodes = list(range(1, len(points) + 1))
    part = {1: "wing-right", -1: "wing-left"} if mirror else {1: "wing"}
    return Scenario.model_validate(
        {
            "name": "uniform-beam",
            "summary": "A beam with a closed-form solution.",
            "airframe": airframe,
            "suspension": {"hook_m": hook, "stiffness_n_per_m": 9.81 * weighed.mass_kg / 0.1},
            "shaker": {
                "position_m": (0.0, 0.0, 0.0),
                "coil_resistance_ohm": 2.0,
                "force_factor_n_per_a": 5.0,
                "armature_mass_kg": 0.1,
                "flexure_stiffness_n_per_m": 1000.0,
                "flexure_damping_n_s_per_m": 1.0,
            },
            "stinger": {"axial_stiffness_n_per_m": 1e5},
            "transducer": {"sensitivity_v_per_n": 0.1, "mass_kg": 0.0, "end_mass_kg": 0.0},
            "accelerometers": {
                "sensitivity_v_per_g": 0.01,
                "mass_kg": 0.0,
                "grid": {
                    "node": nodes,
                    "x_m": [p[0] for p in points],
                    "y_m": [p[1] for p in points],
                    "attached_to": [part[1 if p[1] > 0 else -1] for p in points],
                },
            },
            "acquisition": {"sample_rate_hz": 1000.0, "runs": [nodes]},
            "excitation": {"start_hz": 1.0, "stop_hz": 35.0, "duration_s": 10.0},
        }
    )
