"""Scenario to TOML and back, and the schema for editors."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vgvt.scenario import Item, Scenario, bundled_scenarios, load_scenario, scenario_json_schema, to_toml

_QUICK = load_scenario("quick")
_TEXT = st.text(st.characters(blacklist_categories=["Cs"]), max_size=40)
_NUMBER = st.floats(-1e6, 1e6, allow_nan=False)


def _again(scenario: Scenario) -> Scenario:
    return Scenario.model_validate(tomllib.loads(to_toml(scenario)))


@pytest.mark.parametrize("name", bundled_scenarios())
def test_bundled_scenarios_come_back_equal(name: str, tmp_path: Path) -> None:
    scenario = load_scenario(name)
    assert _again(scenario) == scenario
    (tmp_path / "resolved.toml").write_text(to_toml(scenario), encoding="utf-8")
    assert load_scenario(tmp_path / "resolved.toml") == scenario


@given(_TEXT, st.tuples(_NUMBER, _NUMBER, _NUMBER), st.floats(5e-324, 1e300), st.lists(_TEXT, max_size=4))
@settings(max_examples=100, deadline=None)
def test_any_text_and_number_comes_back(
    text: str, point: tuple[float, float, float], mass_kg: float, sources: list[str]
) -> None:
    item = Item(name=f"item {text}", mass_kg=mass_kg, position_m=point)
    airframe = _QUICK.airframe.model_copy(
        update={"configuration": text, "item": (*_QUICK.airframe.item, item), "sources": tuple(sources)}
    )
    scenario = _QUICK.model_copy(update={"airframe": airframe, "summary": text})
    assert _again(scenario) == scenario


def test_the_text_is_complete() -> None:
    tables = tomllib.loads(to_toml(_QUICK))
    assert "extends" not in tables
    # A table that may be left out and is left out has no text: this test has a shaker, no hammer.
    assert set(Scenario.model_fields) - set(tables) == {"hammer"}
    assert set(tables) <= set(Scenario.model_fields)
    assert set(tables["suspension"]) == set(type(_QUICK.suspension).model_fields)


def _tables(schema: dict[str, Any]) -> list[dict[str, Any]]:
    return [schema, *schema["$defs"].values()]


def test_json_schema_refuses_unknown_keys_and_states_units() -> None:
    schema = scenario_json_schema()
    assert json.loads(json.dumps(schema)) == schema
    # An effect's table holds that effect's own parameters, checked by the effect.
    open_tables = [t["title"] for t in _tables(schema) if t["additionalProperties"] is not False]
    assert open_tables == ["EffectTable"]
    spring = schema["$defs"]["Suspension"]["properties"]["stiffness_n_per_m"]
    assert spring["description"] == "Stiffness of the spring along its length. Unit: N/m."
    assert spring["exclusiveMinimum"] == 0
    assert set(schema["properties"]) == set(Scenario.model_fields)
    assert {"airframe", "shaker", "name"} <= set(schema["required"])


def test_json_schema_knows_one_shaker_and_several() -> None:
    for schema in (scenario_json_schema(), scenario_json_schema(extending=True)):
        shaker = schema["properties"]["shaker"]
        one = {"$ref": "#/$defs/Shaker"}
        assert shaker["anyOf"] == [one, {"type": "array", "items": one, "minItems": 1}]
        assert not {"$ref", "type"} & set(shaker), "beside anyOf they would refuse the array again"
        assert shaker["description"]


def test_what_only_effects_set_is_neither_in_the_schema_nor_in_the_text() -> None:
    assert "hinged" in type(_QUICK.airframe).model_fields
    assert "hinged" not in scenario_json_schema()["$defs"]["Airframe"]["properties"]
    assert "hinged" not in to_toml(_QUICK)


def test_json_schema_of_an_extending_file_asks_for_the_differences_only() -> None:
    schema = scenario_json_schema(extending=True)
    assert schema["required"] == ["extends", "name", "summary"]
    assert "extends" in schema["properties"]
    assert not any("required" in table for table in _tables(schema)[1:])
    assert "extends" not in scenario_json_schema()["properties"]
