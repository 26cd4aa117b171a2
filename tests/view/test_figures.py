"""Laws of the figures and of what lies under them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vgvt.data import Direction, Dof, Geometry, ModalModel
from vgvt.view import frf_figure, mac_figure, sigma_figure
from vgvt.view.decimation import break_wraps, peak_keeping_index, resonance_grid
from vgvt.view.labels import lane_labels
from vgvt.view.shape_geometry import aligned, displacement, main_axis, mesh_of


@given(st.integers(0, 2**32 - 1), st.integers(1, 4000), st.integers(4, 300))
@settings(max_examples=60, deadline=None)
def test_decimation_keeps_extremes_and_order(seed: int, size: int, points: int) -> None:
    values = np.random.default_rng(seed).normal(size=size)
    keep = peak_keeping_index(values, points)
    assert keep.size <= points + 2
    assert np.all(np.diff(keep) > 0)
    assert {0, size - 1} <= set(keep.tolist())
    assert values[keep].max() == values.max()
    assert values[keep].min() == values.min()


def test_decimation_keeps_every_needle() -> None:
    values = np.ones(10_000)
    needles = [17, 5003, 9700]
    values[needles] = [5.0, 0.1, 9.0]
    assert set(needles) <= set(peak_keeping_index(values, 100).tolist())


def test_decimation_to_almost_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="at least 4"):
        peak_keeping_index(np.ones(10), 3)


def test_resonance_grid_resolves_a_sharp_peak() -> None:
    dofs = (Dof(1, Direction.PLUS_Z),)
    model = ModalModel(np.array([20.0]), np.array([0.001]), np.ones((1, 1), complex), dofs)
    grid = resonance_grid(model, (1.0, 40.0))
    half_width = 20.0 * 0.001
    assert np.count_nonzero(np.abs(grid - 20.0) <= half_width) >= 7
    assert grid.min() >= 1.0
    assert grid.max() <= 40.0
    assert np.all(np.diff(grid) > 0)


def test_wraps_are_gaps_and_nothing_else_changes() -> None:
    x, y = break_wraps(np.arange(5.0), np.array([170.0, 179.0, -179.0, -170.0, 20.0]))
    assert np.count_nonzero(np.isnan(y)) == 2
    assert y[~np.isnan(y)].tolist() == [170.0, 179.0, -179.0, -170.0, 20.0]
    assert x.size == y.size


@given(st.lists(st.floats(3.0, 35.0), max_size=12))
@settings(max_examples=60, deadline=None)
def test_labels_of_one_row_never_come_closer_than_their_width(frequencies: list[float]) -> None:
    hertz = np.sort(np.array(frequencies, dtype=float))
    texts, positions = lane_labels(hertz, (3.0, 35.0))
    for row in ("top center", "bottom center"):
        shown = [f for f, t, p in zip(hertz, texts, positions, strict=True) if t and p == row]
        assert np.all(np.diff(shown) >= 0.12 * 32.0 - 1e-9)


def test_sigma_figure_marks_truth_and_claims(example) -> None:
    truth_hz = tuple(row.true_hz for row in example.scorecards["plscf"].modes)
    figure = sigma_figure(example.frf, example.claims, truth_hz, (3.0, 35.0), example.scorecards)
    assert sorted(shape.x0 for shape in figure.layout.shapes) == sorted(truth_hz)
    lanes = {trace.name: trace for trace in figure.data if trace.meta == "lane"}
    assert list(lanes) == ["truth", "quadrature", "plscf"]
    lane = lanes["quadrature"]
    wrong = [x for x, symbol in zip(lane.x, lane.marker.symbol, strict=True) if symbol == "x-thin-open"]
    assert wrong == [23.82]
    measured = next(trace for trace in figure.data if trace.name == "measured")
    inside = (example.frf.frequency_hz >= 3) & (example.frf.frequency_hz <= 35)
    assert np.max(measured.y) == pytest.approx(example.frf.sigma()[inside].max(), rel=1e-6)


def test_sigma_figure_without_frfs_needs_a_band(example) -> None:
    assert sigma_figure(None, example.claims, band_hz=(3.0, 35.0)).data
    with pytest.raises(ValueError, match="band"):
        sigma_figure(None, example.claims)


def test_frf_figure_overlays_claims_that_have_residues(example) -> None:
    figure = frf_figure(example.frf, example.claims, example.frf.responses[3], band_hz=(3.0, 35.0))
    assert {trace.name for trace in figure.data} == {"measured", "plscf"}
    silent = {"plscf": replace(example.claims["plscf"], residues=None, references=())}
    figure = frf_figure(example.frf, silent, example.frf.responses[3], band_hz=(3.0, 35.0))
    assert {trace.name for trace in figure.data} == {"measured"}


def test_mac_figure_writes_the_numbers_into_the_cells(example) -> None:
    claim, truth = example.claims["plscf"], example.truth.as_tested[0]
    heat = mac_figure(claim, truth).data[0]
    assert np.shape(heat.z) == (5, 5)
    assert [[float(t) for t in row] for row in heat.text] == pytest.approx(np.round(heat.z, 2), abs=0.0051)
    assert np.diag(mac_figure(claim).data[0].z) == pytest.approx(1.0)
    elsewhere = replace(claim, dofs=tuple(Dof(500 + k, Direction.PLUS_Z) for k in range(len(claim.dofs))))
    with pytest.raises(ValueError, match="share no DOF"):
        mac_figure(elsewhere, truth)


def test_displacement_is_real_for_a_real_shape_whatever_its_phase_and_respects_directions() -> None:
    dofs = (
        Dof(1, Direction.PLUS_Z),
        Dof(2, Direction.MINUS_Z),
        Dof(2, Direction.PLUS_X),
        Dof(1, Direction.PLUS_ROTATION_X),
    )
    shape = np.array([[1.0, 2.0, 0.5, 9.0]]) * np.exp(0.8j)
    vectors = displacement(ModalModel(np.array([5.0]), np.array([0.01]), shape, dofs), 0, (1, 2))
    scale = np.hypot(2.0, 0.5) * np.sign(vectors[0, 2].real)
    assert vectors == pytest.approx(np.array([[0, 0, 1.0], [0.5, 0, -2.0]]) / scale)
    assert main_axis(vectors) == 2


def test_alignment_is_the_best_complex_factor() -> None:
    generator = np.random.default_rng(3)
    shape = generator.normal(size=(6, 3)) + 1j * generator.normal(size=(6, 3))
    assert aligned((2 - 3j) * shape, shape) == pytest.approx(shape)
    other = generator.normal(size=(6, 3)).astype(complex)
    best = np.linalg.norm(aligned(other, shape) - shape)
    for factor in np.exp(1j * np.linspace(0, 6, 40)):
        assert best <= np.linalg.norm(factor * other - shape) + 1e-12


def test_mesh_of_a_ladder_has_its_rungs_and_one_face_a_bay() -> None:
    place = np.array([[x, y, 0.0] for y in range(4) for x in range(2)], dtype=float)
    rails, rungs = ((1, 3, 5, 7), (2, 4, 6, 8)), ((1, 2), (3, 4), (5, 6), (7, 8))
    geometry = Geometry(tuple(range(1, 9)), place, (*rails, *rungs))
    mesh = mesh_of(geometry, geometry.nodes)
    assert len(mesh.edges) == 10
    assert {frozenset(face) for face in mesh.faces} == {frozenset(range(k, k + 4)) for k in (0, 2, 4)}
    braced = replace(geometry, lines=(*geometry.lines, (1, 4)))
    faces = {frozenset(face) for face in mesh_of(braced, geometry.nodes).faces}
    assert frozenset({0, 1, 2, 3}) not in faces
    assert {frozenset({0, 1, 3}), frozenset({0, 2, 3})} <= faces
    part = mesh_of(geometry, (1, 3, 4))
    assert part.edges == ((0, 1), (1, 2))


def test_rows_of_sensors_are_joined_by_ribs_where_they_face_each_other() -> None:
    place = np.array([[x, y, 0.0] for y in (0.0, 2.0, 4.0) for x in (0.0, 1.0)])
    rows = ((1, 3, 5), (2, 4, 6))
    mesh = mesh_of(Geometry(tuple(range(1, 7)), place, rows), tuple(range(1, 7)))
    assert {(0, 1), (2, 3), (4, 5)} <= set(mesh.edges)
    assert len(mesh.edges) == 7
    assert len(mesh.faces) == 2
    apart = mesh_of(Geometry(tuple(range(1, 7)), place * [9.0, 1.0, 1.0], rows), tuple(range(1, 7)))
    assert len(apart.edges) == 4


def test_mesh_without_lines_joins_near_neighbours() -> None:
    place = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [50, 0, 0]], dtype=float)
    edges = mesh_of(Geometry((1, 2, 3, 4, 5), place), (1, 2, 3, 4, 5)).edges
    assert {(0, 1), (0, 2), (1, 3), (2, 3)} <= set(edges)
    assert mesh_of(Geometry((1,), place[:1]), (1,)).edges == ()
