"""Torsion and the drive point: what a symmetric point hides, and what a lever in front of the axis buys."""

import pytest
import torsion_drive_point as study
from torsion_drive_point import DRIVE_POINTS, TORSION, DrivePoint, distance_from_axis_m, limits_hz, scenario_at

ANTISYMMETRIC, SYMMETRIC = TORSION
BY_NAME = {point.name: point for point in DRIVE_POINTS}
ON_THE_PLANE = BY_NAME["plane of symmetry, 28 in (hati-symmetric)"]
OFF_THE_PLANE = BY_NAME["4.5 in right, 25 in (hati-unsymmetric)"]
TWINS = BY_NAME["the same, left and right wing equal"]


def test_equal_wings_and_a_symmetric_point_hold_nothing_about_antisymmetric_torsion() -> None:
    limits = limits_hz(scenario_at(TWINS))
    assert limits[ANTISYMMETRIC] > 1e3 * limits[SYMMETRIC]


def test_a_few_grams_of_asymmetry_leave_little_and_an_unsymmetric_point_gives_much_more() -> None:
    on, off = limits_hz(scenario_at(ON_THE_PLANE)), limits_hz(scenario_at(OFF_THE_PLANE))
    assert on[ANTISYMMETRIC] > 4 * off[ANTISYMMETRIC]
    assert off[SYMMETRIC] == pytest.approx(on[SYMMETRIC], rel=0.3)


def test_on_the_plane_a_longer_lever_behind_the_node_line_helps_symmetric_torsion() -> None:
    limits = [limits_hz(scenario_at(DrivePoint("", x, 0.0)))[SYMMETRIC] for x in (0.5, 0.6, 0.7112)]
    assert limits == sorted(limits, reverse=True)
    assert limits[0] > 3 * limits[-1]


def test_the_node_line_of_symmetric_torsion_is_not_the_elastic_axis() -> None:
    places = [round(0.395 + 0.01 * k, 3) for k in range(13)]
    limits = [limits_hz(scenario_at(DrivePoint("", x, 0.0)))[SYMMETRIC] for x in places]
    worst = places[limits.index(max(limits))]
    assert 0.02 < worst - 0.395 < 0.12


def test_distance_from_the_axis() -> None:
    assert distance_from_axis_m(0.395, 0.0) == pytest.approx(0.0)
    assert distance_from_axis_m(0.7595, 0.9) == pytest.approx(0.0, abs=1e-3)
    assert distance_from_axis_m(0.7595, -0.9) == pytest.approx(0.0, abs=1e-3)
    assert distance_from_axis_m(0.6, 0.0) > 0 > distance_from_axis_m(0.3, 0.0)


@pytest.mark.slow
def test_the_symmetric_point_misses_antisymmetric_torsion_and_sees_the_symmetric() -> None:
    hits = study.found(scenario_at(ON_THE_PLANE), range(20))
    assert hits[ANTISYMMETRIC] == 0
    assert hits[SYMMETRIC] == 20
