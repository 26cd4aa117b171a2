"""An aircraft with every feature of the schema, simulator against finite elements: a T-tail on a flexible fuselage."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest
from finite_element import build, natural_modes
from numpy.typing import NDArray
from uniform_beams import virtual_test

from vgvt.data import Truth
from vgvt.scenario import rigid_body_properties
from vgvt.scenario.airframe import Airframe
from vgvt.simulation import truth_of

MODES = 10
CELLS = {"coarse": 6, "middle": 12, "fine": 24}


def stations(points: list[tuple[float, float, float]], first: float, last: float, **more: Any) -> dict[str, Any]:
    """A table that tapers from ``first`` to ``last`` of its nominal stiffness and mass."""
    taper = np.linspace(first, last, len(points))
    nominal = {
        "bending_stiffness_n_m2": 600.0,
        "in_plane_stiffness_n_m2": 4000.0,
        "torsional_stiffness_n_m2": 350.0,
        "mass_kg_per_m": 1.2,
        "pitch_inertia_kg_m": 0.004,
    } | more
    columns = {name: [float(v * t) for t in taper] for name, v in nominal.items() if v is not None}
    return {"position_m": points} | columns


def t_tail(cells: int, fin_root_x_m: float = 1.6) -> Airframe:
    """Cranked wing with dihedral and root springs, flexible fuselage, a fin on it, a tailplane on the fin.

    The fin stands at 5/6 of the fuselage, the centre of a link for 6, 12 and 24 cells.
    """
    wing = {
        "name": "wing",
        "mirror": True,
        "cells": cells,
        "root_bending_stiffness_n_m_per_rad": 4000.0,
        "root_torsional_stiffness_n_m_per_rad": 900.0,
        "stations": stations(
            [(0.5, 0.1, 0.0), (0.55, 0.6, 0.02), (0.75, 1.4, 0.12)], 1.0, 0.5, cg_offset_m=0.02, mass_kg_per_m=1.0
        ),
    }
    fuselage = {
        "name": "fuselage",
        "cells": cells,
        "stations": stations(
            [(0.6, 0.0, 0.0), (1.8, 0.0, 0.0)], 1.0, 0.8, bending_stiffness_n_m2=900.0, in_plane_stiffness_n_m2=700.0
        ),
    }
    fin = {
        "name": "fin",
        "parent": "fuselage",
        "normal": (0.0, 1.0, 0.0),
        "cells": cells,
        "stations": stations([(fin_root_x_m, 0.0, 0.08), (1.7, 0.0, 0.45)], 1.0, 1.0, bending_stiffness_n_m2=200.0),
    }
    tailplane = {
        "name": "tailplane",
        "parent": "fin",
        "mirror": True,
        "cells": cells,
        "stations": stations(
            [(1.7, 0.0, 0.45), (1.75, 0.4, 0.47)], 1.0, 0.7, in_plane_stiffness_n_m2=None, bending_stiffness_n_m2=80.0
        ),
    }
    items = [
        {"name": "engine", "mass_kg": 0.6, "position_m": (0.4, 0.5, -0.08), "attached_to": "wing", "mirror": True},
        {"name": "nose", "mass_kg": 0.8, "position_m": (0.0, 0.0, 0.0), "inertia_kg_m2": (1e-3, 2e-3, 3e-3)},
        {"name": "camera", "mass_kg": 0.1, "position_m": (1.8, 0.3, 0.5), "attached_to": "tailplane-right"},
    ]
    body = {"mass_kg": 4.0, "centre_of_gravity_m": (0.5, 0.0, 0.01), "inertia_kg_m2": (0.02, 0.15, 0.16)}
    # The order of the tables is not that of the parents.
    beams = [tailplane, fin, wing, fuselage]
    return Airframe.model_validate({"name": "t-tail", "body": body, "beam": beams, "item": items})


@functools.cache
def simulated(cells: int, fin_root_x_m: float = 1.6) -> Truth:
    """The simulator's truth for the aircraft."""
    return truth_of(virtual_test(t_tail(cells, fin_root_x_m), 1.4, mirror=True))


def deviations(cells: int, fin_root_x_m: float = 1.6) -> NDArray[np.float64]:
    """Relative deviations of the first elastic frequencies from the judge's."""
    model = build(t_tail(12, fin_root_x_m), 40)
    exact, _ = natural_modes(model.mass, model.stiffness)
    return simulated(cells, fin_root_x_m).bare.natural_frequency_hz[:MODES] / exact[6 : 6 + MODES] - 1


def test_frequencies_agree_with_the_finite_element_model() -> None:
    assert np.abs(deviations(CELLS["middle"])).max() < 0.01


@pytest.mark.slow
def test_frequencies_approach_the_finite_element_model_at_second_order() -> None:
    cells = list(CELLS.values())
    spread = [np.sqrt((deviations(n) ** 2).mean()) for n in cells]
    order = -np.polyfit(np.log(cells), np.log(spread), 1)[0]
    assert 1.6 < order < 2.4, f"order {order}, deviations {spread}"


@pytest.mark.slow
def test_a_branch_between_the_centres_of_links_stays_within_three_per_cent() -> None:
    """It rides on the nearest link, here a quarter of a link away: first order in the length of a link, not second."""
    assert np.abs(deviations(CELLS["middle"], 1.575)).max() < 0.03


@pytest.mark.parametrize("cells", [CELLS["coarse"], CELLS["middle"]])
def test_rigid_body_properties_do_not_depend_on_the_cells(cells: int) -> None:
    stated, assembled = rigid_body_properties(t_tail(12)), simulated(cells).rigid_body
    assert assembled.mass_kg == pytest.approx(stated.mass_kg, rel=1e-12)
    np.testing.assert_allclose(assembled.centre_of_gravity_m, stated.centre_of_gravity_m, atol=1e-12)
    np.testing.assert_allclose(assembled.inertia_kg_m2, stated.inertia_kg_m2, atol=1e-11)
