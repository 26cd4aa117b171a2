"""Points off the aircraft are refused, also where a part has no outline to say where it ends."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vgvt.data import InputError
from vgvt.scenario import Airframe, Beam, Body, Item, Scenario, Suspension, bundled_scenarios, load_scenario
from vgvt.scenario.placement import BOX_MARGIN, LEAST_BOX_MARGIN_M, aircraft_box_m, placement_problems
from vgvt.scenario.points import sensor_points

_LENGTH_M = 1.2
_HEAD = 'extends = "quick"\nname = "mine"\nsummary = "A trial."\n'


def _plank(*, edges: bool = False, outline: bool = False) -> Airframe:
    """A plank along y from -0.6 to 0.6 m at x = 0.05 m."""
    columns = ("bending_stiffness_n_m2", "torsional_stiffness_n_m2", "mass_kg_per_m", "pitch_inertia_kg_m")
    stations: dict[str, object] = {name: [1.0, 1.0] for name in columns}
    stations["position_m"] = [[0.05, 0.0, 0.0], [0.05, _LENGTH_M / 2, 0.0]]
    if edges:
        stations |= {"forward_edge_m": [0.05, 0.05], "aft_edge_m": [0.05, 0.05]}
    corners = ((0.0, -0.01), (0.1, -0.01), (0.1, 0.01), (0.0, 0.01)) if outline else ()
    body = Body(mass_kg=0.1, centre_of_gravity_m=(0.05, 0, 0), inertia_kg_m2=(1e-5, 1e-5, 1e-5), outline_m=corners)
    return Airframe(
        name="plank", body=body, beam=(Beam.model_validate({"name": "plank", "mirror": True, "stations": stations}),)
    )


def _hook_problem(airframe: Airframe, hook_m: tuple[float, float, float]) -> str:
    problems = placement_problems(airframe, None, None, Suspension(hook_m=hook_m))
    return " ".join(f"{p.text}. {p.advice}" for p in problems)


@pytest.mark.parametrize("edges", [False, True])
def test_nine_metres_are_off_a_plank_without_outline(edges: bool) -> None:
    airframe = _plank(edges=edges)
    said = _hook_problem(airframe, (9.0, 0.0, 0.0))
    assert "off the aircraft" in said
    assert "has no outline; if it reaches further, give it" in said
    assert ("outline_m in [airframe.body]" in said) == edges, "the part that the point would be on"
    assert "300 mm beyond are allowed" in said
    assert not _hook_problem(airframe, (0.05, 0.0, 0.0))


@given(st.sampled_from([0, 1]), st.sampled_from([-1, 1]), st.floats(0.0, 3.0))
@settings(max_examples=60, deadline=None)
def test_the_margin_is_a_quarter_of_the_longest_side(axis: int, side: int, beyond: float) -> None:
    airframe = _plank()
    box = aircraft_box_m(airframe)
    margin = max(BOX_MARGIN * _LENGTH_M, LEAST_BOX_MARGIN_M)
    point = [0.05, 0.0, 0.0]
    point[axis] = float(box[0 if side < 0 else 1, axis]) + side * beyond
    if abs(beyond - margin) > 1e-9:
        assert bool(_hook_problem(airframe, (point[0], point[1], point[2]))) == (beyond > margin)


def test_a_small_body_alone_has_a_margin_too() -> None:
    lone = Airframe(name="x", body=_plank().body)
    assert not _hook_problem(lone, (0.05, 0.19, 0.0))
    assert _hook_problem(lone, (0.05, 0.21, 0.0))


def test_the_box_holds_all_that_is_described() -> None:
    airframe = _plank(edges=True, outline=True)
    np.testing.assert_allclose(aircraft_box_m(airframe), [[0.0, -0.6, 0.0], [0.1, 0.6, 0.0]], atol=1e-12)
    nose = Item(name="boom", mass_kg=0.1, position_m=(-0.4, 0.2, 0.3), mirror=False)
    longer = airframe.model_copy(update={"item": (nose,)})
    np.testing.assert_allclose(aircraft_box_m(longer), [[-0.4, -0.6, 0.0], [0.1, 0.6, 0.3]], atol=1e-12)


def test_a_point_off_a_beam_without_edges_is_told_to_give_it_edges() -> None:
    said = _hook_problem(_plank(), (9.0, 0.3, 0.0))
    assert "'plank-right'" in said
    assert "forward_edge_m and aft_edge_m" in said


def test_millimetres_are_recognised_without_an_outline() -> None:
    assert "Were these millimetres? Then write (0.05, 0.2, 0)." in _hook_problem(_plank(), (50.0, 200.0, 0.0))


@pytest.mark.parametrize("point", [(0.05, 0.9, 0.0), (0.05, 0.75, 0.0)])
def test_a_point_a_little_off_is_no_foreign_unit(point: tuple[float, float, float]) -> None:
    said = _hook_problem(_plank(edges=True, outline=True), point)
    assert "off the aircraft" in said
    assert "Were these" not in said


@pytest.mark.parametrize("name", bundled_scenarios())
def test_bundled_scenarios_keep_their_points_inside_their_box(name: str) -> None:
    """The box holds what the outlines hold: a law between the two ways of checking."""
    scenario = load_scenario(name)
    low, high = aircraft_box_m(scenario.airframe)
    grid = scenario.accelerometers.grid
    for x, y in zip(grid.x_m, grid.y_m, strict=True):
        assert low[0] - 0.03 <= x <= high[0] + 0.03
        assert low[1] - 0.03 <= y <= high[1] + 0.03


def test_a_drive_point_off_the_aircraft_is_told_beside_other_mistakes(tmp_path: Path) -> None:
    """Placement is checked as far as the tables are right in themselves, whatever is wrong elsewhere."""
    file = tmp_path / "mine.toml"
    lines = (
        "[shaker]\nposition_m = [9.0, 0.5, 0.0]\n"
        '[accelerometers]\nmass_kg = "1 g"\n'
        '[accelerometers.grid]\nnode = [1]\nx_m = [0.5]\ny_m = [9.9]\nattached_to = ["tail"]\n'
        "[suspension]\nlength = 1.0\nhook_m = [9.0, 0.0, 0.0]"
    )
    file.write_text(_HEAD + lines, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_scenario(file)
    for words in (
        "shaker.position_m: the drive point at (9, 0.5, 0) m",
        "accelerometers.mass_kg:",
        "grid.attached_to[0]: is 'tail', which is not a part",
        "suspension.length:",
    ):
        assert words in caught.value.advice
    assert "hook_m" not in caught.value.advice, "a table that is wrong in itself is not placed"


def test_nothing_is_placed_on_an_airframe_that_is_wrong_itself(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(f"{_HEAD}[airframe.body]\nmass_kg = -1.0\n[shaker]\nposition_m = [9.0, 0.5, 0.0]", encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_scenario(file)
    assert caught.value.where.endswith("airframe.body.mass_kg")


def test_points_stay_where_they_are_however_a_wing_is_held() -> None:
    """Thousands of candidates free a root: none of them has the planform searched again."""
    rigid = load_scenario("quick")
    wing = rigid.airframe.beam[0].model_copy(update={"root_bending_stiffness_n_m_per_rad": 2000.0})
    airframe = rigid.airframe.model_copy(update={"beam": (wing, *rigid.airframe.beam[1:])})
    loose = rigid.model_copy(update={"airframe": airframe})
    assert sensor_points(loose) is sensor_points(rigid)


def test_points_stay_where_they_are_however_stiff_and_heavy_a_wing_is() -> None:
    """Nor do thousands of steps of a fit; a shape that is another one has other points."""
    stated = load_scenario("quick")
    wing, body = stated.airframe.beam[0], stated.airframe.body

    def with_wing(**columns: object) -> Scenario:
        changed = wing.model_copy(update={"stations": wing.stations.model_copy(update=columns)})
        parts = {"beam": (changed, *stated.airframe.beam[1:]), "body": body.model_copy(update={"mass_kg": 3.0})}
        return stated.model_copy(update={"airframe": stated.airframe.model_copy(update=parts)})

    rows = len(wing.stations.position_m)
    stiffer = with_wing(bending_stiffness_n_m2=(99.0,) * rows, mass_kg_per_m=(0.3,) * rows)
    assert sensor_points(stiffer) is sensor_points(stated)
    higher = with_wing(position_m=tuple((x, y, z + 0.1) for x, y, z in wing.stations.position_m))
    moved = [
        b.position_m[2] - a.position_m[2] for a, b in zip(sensor_points(stated), sensor_points(higher), strict=True)
    ]
    assert max(moved) == pytest.approx(0.1)
