"""Where a beam is cut: evenly, and where its axis bends."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vgvt.scenario.airframe import Beam
from vgvt.scenario.axis import beam_axis
from vgvt.scenario.cells import bent_within_a_cell, cells_of


def beam(points_m: list[tuple[float, float, float]], cells: int) -> Beam:
    """A uniform beam along some points."""
    uniform = dict.fromkeys(
        ("bending_stiffness_n_m2", "torsional_stiffness_n_m2", "mass_kg_per_m", "pitch_inertia_kg_m"),
        (1.0,) * len(points_m),
    )
    return Beam.model_validate({"name": "wing", "cells": cells, "stations": {"position_m": points_m, **uniform}})


@pytest.mark.parametrize("cells", [1, 7, 12])
def test_a_straight_beam_is_cut_evenly_to_the_bit(cells: int) -> None:
    """Stations along it, and the rounding of their coordinates, change nothing."""
    straight = beam([(0.0, 0.0, 0.0), (0.1234567, 0.3333333, 0.0), (0.3703701, 1.0, 0.0)], cells)
    length = beam_axis(straight).arc_length_m[-1]
    assert np.array_equal(cells_of(straight).edges_m, np.linspace(0.0, length, cells + 1))
    assert cells_of(straight).bent_rad.max() < 1e-4


def test_cells_end_where_the_axis_bends() -> None:
    """As even as the pieces between bends let them be."""
    cranked = beam([(0.0, 0.0, 0.0), (0.0, 0.5, 0.0), (0.36, 0.98, 0.0)], 5)
    np.testing.assert_allclose(cells_of(cranked).edges_m, [0.0, 0.25, 0.5, 0.7, 0.9, 1.1])
    assert cells_of(cranked).bent_rad.max() == 0


def test_of_bends_that_are_close_the_sharpest_lies_between_two_cells() -> None:
    close = beam([(0.0, 0.0, 0.0), (0.0, 0.5, 0.0), (0.01, 0.6, 0.0), (0.41, 1.0, 0.0)], 4)
    arcs, cells = beam_axis(close).arc_length_m, cells_of(close)
    assert arcs[2] in cells.edges_m
    assert arcs[1] not in cells.edges_m
    assert np.degrees(cells.bent_rad.sum()) == pytest.approx(np.degrees(np.arctan(0.1)))
    assert bent_within_a_cell(close) is None


def test_a_bend_that_is_one_cell_from_the_tip_lies_between_two() -> None:
    """Rounding makes the last piece a little shorter than a cell."""
    for cells in range(2, 30):
        bent = beam([(0.0, 0.0, 0.0), (0.0, 0.1 * (cells - 1), 0.0), (0.1, 0.1 * (cells - 1), 0.0)], cells)
        assert cells_of(bent).bent_rad.max() == 0


def test_cells_end_where_a_shaker_pushes() -> None:
    straight = beam([(0.0, 0.0, 0.0), (0.0, 1.0, 0.0)], 5)
    np.testing.assert_allclose(cells_of(straight, (0.5,)).edges_m, [0.0, 1 / 6, 1 / 3, 0.5, 0.75, 1.0])
    assert cells_of(straight, (0.4,)).edges_m == pytest.approx(np.linspace(0.0, 1.0, 6))
    assert 0.1 in cells_of(straight, (0.1,)).edges_m
    for near_an_end in (0.0, 0.09, 0.95, 1.0):
        assert np.array_equal(cells_of(straight, (near_an_end,)).edges_m, cells_of(straight).edges_m)


def test_shakers_between_bends_leave_no_cell_too_long_and_no_cell_too_many() -> None:
    """Of two that are half a cell from bends one has its edge; where bends are at all edges, none."""
    steps = [(0.0, 0.0), (0.2, 0.0), (0.2, 0.2), (0.8, 0.2)]
    bent = beam([(x, y, 0.0) for x, y in steps], 5)
    edges = cells_of(bent, (0.1, 0.3)).edges_m
    assert edges.size == 6
    assert 0.1 in edges and 0.3 not in edges
    assert np.diff(edges).max() <= 0.4 * (1 + 1e-9)
    full = beam([(0.0, 0.0, 0.0), (0.2, 0.0, 0.0), (0.2, 0.2, 0.0), (0.4, 0.2, 0.0)], 3)
    assert np.array_equal(cells_of(full, (0.1,)).edges_m, cells_of(full).edges_m)


def test_of_a_bend_and_a_shaker_that_are_close_the_bend_lies_between_two_cells() -> None:
    cranked = beam([(0.0, 0.0, 0.0), (0.0, 0.5, 0.0), (0.36, 0.98, 0.0)], 5)
    assert np.array_equal(cells_of(cranked, (0.55,)).edges_m, cells_of(cranked).edges_m)
    assert {0.5, 0.7} <= set(cells_of(cranked, (0.7,)).edges_m)


def test_a_bend_in_the_only_cell_is_told() -> None:
    only = beam([(0.0, 0.0, 0.0), (0.0, 0.5, 0.0), (0.5, 0.5, 0.0)], 1)
    assert bent_within_a_cell(only) == (
        "the axis of beam 'wing' bends by 90° within one of its cells, which gives way about its mean direction; "
        "write cells = 2, not 1"
    )


@settings(deadline=None, max_examples=200)
@given(
    st.lists(st.tuples(*[st.integers(-9, 9)] * 2, st.integers(1, 9)), min_size=1, max_size=30),
    st.integers(1, 60),
    st.lists(st.floats(0.0, 1.0), max_size=4),
)
def test_there_are_as_many_cells_as_stated_and_none_is_far_from_even(
    steps: list[tuple[int, int, int]], cells: int, pushed: list[float]
) -> None:
    """However many bends and shakers there are: between half and twice the even length."""
    points = np.cumsum([(0, 0, 0), *((x, y, z) for x, z, y in steps)], axis=0) / 10
    zigzag = beam([(float(x), float(y), float(z)) for x, y, z in points], cells)
    cut = cells_of(zigzag, tuple(share * float(beam_axis(zigzag).arc_length_m[-1]) for share in pushed))
    edges = cut.edges_m
    even = edges[-1] / cells
    assert edges.size == cells + 1
    assert np.diff(edges).min() > 0.5 * even * (1 - 1e-6)
    assert np.diff(edges).max() < 2 * even * (1 + 1e-6)
    # Every bend lies on an edge or counts in its cell.
    within = ~np.isin(beam_axis(zigzag).arc_length_m, edges)
    assert (cut.bent_rad > 0).any() <= within.any()
