"""Which part a point is on, and how far off the aircraft it is."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vgvt.scenario import Airframe, Beam, Body, load_scenario, outlines_m, part_at, surface_height_m
from vgvt.scenario.planform import distance_off_m, slid_m

_HATI = load_scenario("quick").airframe


def _surface(name: str, position_m: list[list[float]], half_chord_m: float | None, **more: object) -> Beam:
    rows = len(position_m)
    edges = {} if half_chord_m is None else {f"{s}_edge_m": [half_chord_m] * rows for s in ("forward", "aft")}
    stations = {"position_m": position_m, "mass_kg_per_m": [1.0] * rows, "pitch_inertia_kg_m": [0.001] * rows, **edges}
    stations |= {"bending_stiffness_n_m2": [1.0] * rows, "torsional_stiffness_n_m2": [1.0] * rows}
    return Beam.model_validate({"name": name, "stations": stations, **more})


def _airframe(*beams: Beam, outline_m: tuple[tuple[float, float], ...] = ()) -> Airframe:
    body = Body(mass_kg=1.0, centre_of_gravity_m=(0, 0, 0.1), inertia_kg_m2=(1, 1, 1), outline_m=outline_m)
    return Airframe(name="x", body=body, beam=beams)


def test_every_grid_point_of_hati_is_on_its_wing() -> None:
    grid = load_scenario("hati-unsymmetric").accelerometers.grid
    for node, x, y in zip(grid.node, grid.x_m, grid.y_m, strict=True):
        side = "right" if node <= 10 else "left"
        assert part_at(_HATI, (x, y)) == f"wing-{side}", node
        assert distance_off_m(_HATI, f"wing-{side}", (x, y)) == 0.0, node


@pytest.mark.parametrize(
    ("point", "part"),
    [((0.6, 0.0), "body"), ((0.1, 0.0, 0.02), "body"), ((0.5, 0.3), "wing-right"), ((1.1, -1.5), "wing-left")],
)
def test_points_of_the_published_planform(point: tuple[float, ...], part: str) -> None:
    assert part_at(_HATI, point) == part
    assert distance_off_m(_HATI, part, point) == 0.0


@given(st.floats(0.21, 1.45), st.floats(0.02, 0.98))
@settings(max_examples=60, deadline=None)
def test_points_between_the_published_edges_are_on_the_wing(y: float, share: float) -> None:
    front = np.interp(y, [0.194, 1.464], [0.331, 0.842])
    back = np.interp(y, [0.194, 0.372, 1.5275], [0.7727, 0.700, 1.164])
    x = front + share * (back - front)
    assert distance_off_m(_HATI, "wing-right", (x, y)) <= 0.003
    assert distance_off_m(_HATI, "wing-left", (x, -y)) == pytest.approx(distance_off_m(_HATI, "wing-right", (x, y)))


@given(st.floats(-1, 2), st.floats(-1, 2))
@settings(max_examples=60, deadline=None)
def test_distance_to_a_rectangle(x: float, y: float) -> None:
    airframe = _airframe(outline_m=((0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (0.0, 0.5)))
    expected = np.hypot(max(-x, 0.0, x - 1.0), max(-y, 0.0, y - 0.5))
    assert distance_off_m(airframe, "body", (x, y)) == pytest.approx(expected, abs=1e-12)


def test_stacked_surfaces_are_told_apart_by_height() -> None:
    low = _surface("wing", [[0, 0.1, 0], [0, 1, 0]], 0.1)
    high = _surface("tail", [[0, 0.1, 0.4], [0, 1, 0.4]], 0.1)
    airframe = _airframe(low, high)
    assert part_at(airframe, (0.05, 0.5, 0.38)) == "tail"
    assert part_at(airframe, (0.05, 0.5, 0.02)) == "wing"


def test_a_fin_is_a_surface_too() -> None:
    fin = _surface("fin", [[0.8, 0, 0.1], [0.9, 0, 0.5]], 0.05, normal=[0, 1, 0])
    airframe = _airframe(fin, outline_m=((0.0, -0.1), (1.0, -0.1), (1.0, 0.1), (0.0, 0.1)))
    assert distance_off_m(airframe, "fin", (0.85, 0.0, 0.3)) == 0.0
    assert distance_off_m(airframe, "fin", (0.85, 0.0, 0.9)) == pytest.approx(0.4, abs=0.02)
    assert 0.1 <= surface_height_m(airframe, "fin", 0.85, 0.0) <= 0.5


def test_a_point_slides_along_what_it_is_on() -> None:
    """Aft along a swept fin as high as it was, up the fin, out along a wing that rises, and level on the body."""
    fin = _surface("fin", [[0.8, 0, 0.1], [0.9, 0, 0.5]], 0.05, normal=[0, 1, 0])
    slope = np.tan(np.radians(5))
    risen = [0, -np.sin(np.radians(5)), np.cos(np.radians(5))]
    wing = _surface("wing", [[0, 0.1, 0.0], [0, 1.1, slope]], 0.1, mirror=True, normal=risen)
    airframe = _airframe(fin, wing)
    assert slid_m(airframe, "fin", (0.85, 0.01, 0.3), 0.02, 0.0) == pytest.approx((0.87, 0.01, 0.3))
    assert slid_m(airframe, "fin", (0.85, 0.01, 0.3), 0.02, -0.05) == pytest.approx((0.87, 0.01, 0.25))
    for part, y in (("wing-right", 0.6), ("wing-left", -0.6)):
        # On a bracket above the surface it stays as far above.
        end = slid_m(airframe, part, (0.05, y, 0.5 * slope + 0.01), 0.02, 0.03)
        assert end == pytest.approx((0.07, y + 0.03, (0.5 + np.copysign(0.03, y)) * slope + 0.01))
    assert slid_m(airframe, "body", (0.0, 0.0, 0.3), 0.02, 0.03) == pytest.approx((0.02, 0.03, 0.3))
    with pytest.raises(KeyError, match="wing-right"):
        slid_m(airframe, "wing", (0.0, 0.6, 0.0), 0.01, 0.0)


def test_parts_without_outline_take_what_no_outline_holds() -> None:
    bare = _surface("bare", [[0, 0.5, 0], [0, 1.5, 0]], None)
    outline = ((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2))
    assert part_at(_airframe(bare, outline_m=outline), (0.1, 1.0)) == "bare"
    assert part_at(_airframe(bare, outline_m=outline), (0.1, 0.1)) == "body"
    assert part_at(_airframe(bare), (0.1, 0.1)) == "body"
    assert distance_off_m(_airframe(bare), "bare", (5.0, 5.0)) is None


def test_height_follows_dihedral() -> None:
    slope = np.tan(np.radians(5))
    wing = _surface(
        "wing",
        [[0, 0.1, 0.0], [0, 1.1, slope]],
        0.1,
        mirror=True,
        normal=[0, -np.sin(np.radians(5)), np.cos(np.radians(5))],
    )
    airframe = _airframe(wing)
    for side, part in ((1, "wing-right"), (-1, "wing-left")):
        assert surface_height_m(airframe, part, 0.05, side * 0.6) == pytest.approx(0.5 * slope)
    assert surface_height_m(airframe, "body", 0.0, 0.0) == 0.1


def test_unknown_part_is_named_with_the_known_ones() -> None:
    with pytest.raises(KeyError, match="wing-right"):
        surface_height_m(_HATI, "wing", 0.0, 0.0)


def test_outlines_are_closed_and_mirrored() -> None:
    body, right, left = outlines_m(_HATI)
    for outline in (body, right, left):
        np.testing.assert_array_equal(outline[0], outline[-1])
    np.testing.assert_allclose(right * [1, -1, 1], left, atol=1e-15)
    assert 3.0 < np.ptp(np.vstack([right, left])[:, 1]) < 3.1
