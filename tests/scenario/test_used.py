"""What is called idle in a test changes no sample of its records, and what is mere wording is told from names."""

from __future__ import annotations

from typing import Any, get_args

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt.scenario import Scenario, Shaker, Stinger, Transducer, load_scenario
from vgvt.scenario.base import Table
from vgvt.scenario.sweeps import Axis, changed, known_keys, sweep
from vgvt.scenario.used import is_wording, used_tables
from vgvt.scenario.vocabulary import inner_table
from vgvt.simulation import simulated_campaign

_OF_A_SHAKER = {
    "excitation.amplitude_v": 3.0,
    "excitation.taper_s": 0.5,
    "stinger.axial_stiffness_n_per_m": 5e4,
    "stinger.axial_damping_n_s_per_m": 1.0,
    "stinger.length_m": 0.3,
    "stinger.mass_kg": 0.3,
    "transducer.sensitivity_v_per_n": 0.5,
    "transducer.conditioner_gain": 2.0,
    "transducer.mass_kg": 0.5,
    "transducer.end_mass_kg": 0.2,
    "transducer.high_pass_hz": 3.0,
    "transducer.range_n": 0.1,
    "shaker.drive": "voltage",
    "shaker.amplifier_gain": 0.5,
    "shaker.coil_resistance_ohm": 2.6,
    "shaker.coil_inductance_h": 1e-4,
    "shaker.force_factor_n_per_a": 15.0,
    "shaker.armature_mass_kg": 0.7,
    "shaker.flexure_stiffness_n_per_m": 900.0,
    "shaker.flexure_damping_n_s_per_m": 9.0,
}


@pytest.fixture(scope="module")
def struck() -> Scenario:
    """The teaching beam under a hammer, one hit of two seconds."""
    return changed(load_scenario("teaching-beam-hammer"), {"excitation.duration_s": 2.0, "excitation.blocks": 1})


def _samples(scenario: Scenario) -> list[np.ndarray[Any, Any]]:
    return [run.samples for run in simulated_campaign(scenario, engine="linear").runs]


def test_what_a_hammer_leaves_idle_changes_no_sample(struck: Scenario) -> None:
    other = changed(struck, _OF_A_SHAKER)
    assert used_tables(other) == used_tables(struck)
    for ours, theirs in zip(_samples(struck), _samples(other), strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_every_number_of_the_rig_is_idle_under_a_hammer() -> None:
    rig = {"stinger": Stinger, "transducer": Transducer, "shaker": Shaker}
    keys = {f"{name}.{key}" for name, table in rig.items() for key in table.model_fields}
    place = {"shaker.node", "shaker.position_m", "shaker.attached_to"}
    words = {"shaker.model", "transducer.model"}
    assert keys - place - words - {"transducer.noise"} == {k for k in _OF_A_SHAKER if not k.startswith("excitation")}


@pytest.mark.parametrize("key", _OF_A_SHAKER)
def test_what_a_hammer_leaves_idle_is_not_swept(struck: Scenario, key: str) -> None:
    weighed = changed(struck, {"transducer.mass_kg": 0.4})
    with pytest.raises(InputError, match="no test with a hammer depends on it"):
        sweep(weighed, [Axis(key, (_OF_A_SHAKER[key],))])
    assert key not in known_keys(struck)
    assert {"hammer.peak_force_n", "shaker.position_m", "excitation.start_hz"} <= set(known_keys(struck))


def test_a_current_drive_sends_its_current_through_any_coil() -> None:
    driven = changed(load_scenario("quick"), {"excitation.duration_s": 4.0})
    assert driven.shaker.drive == "current"
    other = changed(driven, {"shaker.coil_resistance_ohm": 9.0, "shaker.coil_inductance_h": 1e-3})
    for ours, theirs in zip(_samples(driven), _samples(other), strict=True):
        np.testing.assert_array_equal(ours, theirs)
    for key, values in (("shaker.coil_resistance_ohm", (2.0, 4.0)), ("shaker.coil_inductance_h", (1e-4, 2e-4))):
        with pytest.raises(InputError, match="no current drive depends on it"):
            sweep(driven, [Axis(key, values)])
        assert len(sweep(changed(driven, {"shaker.drive": "voltage"}), [Axis(key, values)])) == 2


def test_every_text_is_wording_or_a_name_that_something_goes_by(struck: Scenario) -> None:
    """A new text of the schema must be put on one side or the other."""
    names = {"airframe.beam[0].name", "airframe.beam[0].parent", "airframe.item[0].attached_to", "shaker.attached_to"}
    names |= {"further_shaker[0].attached_to", "accelerometers.grid.direction", "accelerometers.grid.attached_to"}
    found = {}
    for scenario in (load_scenario("hati-two-shakers"), struck):
        found |= {_written(place): is_wording(scenario, place) for place in _texts(scenario, ())}
    assert len(found) > 15
    assert {key for key, wording in found.items() if not wording} == names
    (effect,) = load_scenario("spoiled-sign-flip").effect
    named = struck.model_copy(update={"effect": (effect,), "airframe": load_scenario("quick").airframe})
    assert not is_wording(named, ("airframe", "item", 0, "name")), "an effect may call the item by it"


def _texts(table: Table, path: tuple[str | int, ...]) -> list[tuple[str | int, ...]]:
    """Places of the texts below a table, of the first entry of an array."""
    places: list[tuple[str | int, ...]] = []
    for key, field in type(table).model_fields.items():
        value, here = getattr(table, key), (*path, key)
        if _holds_text(field.annotation):
            places.append(here)
        elif inner_table(field.annotation) is not None and value:
            places += _texts(value[0], (*here, 0)) if isinstance(value, tuple) else _texts(value, here)
    return places


def _holds_text(annotation: Any) -> bool:
    """Text of any kind: one of a few words, as of an engine, is a choice."""
    return annotation is str or any(_holds_text(inner) for inner in get_args(annotation))


def _written(place: tuple[str | int, ...]) -> str:
    return "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in place).lstrip(".")
