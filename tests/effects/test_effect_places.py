"""A payload that is stated beside the aircraft is refused, with the distance; one on a bracket is not."""

from __future__ import annotations

import pytest

from vgvt.data import InputError
from vgvt.effects import make_effect
from vgvt.effects.conformance import with_effect
from vgvt.effects.places import require_on_aircraft
from vgvt.scenario import bundled_scenarios, load_scenario, spoiled_scenarios


@pytest.mark.parametrize("name", (*bundled_scenarios(), *spoiled_scenarios()))
def test_all_that_is_bundled_is_on_its_aircraft(name: str) -> None:
    require_on_aircraft(load_scenario(name))


@pytest.mark.parametrize(
    ("effect", "place"),
    [
        ("added-mass", {"x_m": 0.9, "y_m": 2.2}),
        ("local-absorber", {"x_m": 0.9, "y_m": 2.2}),
        ("rattling-mass", {"x_m": 900.0, "y_m": 1200.0}),
        ("cable-bundle", {"other_x_m": -0.8}),
    ],
)
def test_a_place_off_the_aircraft_is_told_with_its_distance(effect: str, place: dict[str, float]) -> None:
    with pytest.raises(InputError, match=r"effect\[0\].*m off the aircraft; nearest is"):
        require_on_aircraft(with_effect(load_scenario("quick"), make_effect(effect, "test", **place)))


def test_a_chord_beside_the_wing_is_a_bracket() -> None:
    """The wing ends at 1.53 m and is at most 0.3 m deep."""
    scenario = load_scenario("quick")
    require_on_aircraft(with_effect(scenario, make_effect("added-mass", "test", mass_kg=0.01, x_m=1.0, y_m=1.65)))
