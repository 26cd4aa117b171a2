"""'Did you mean': every key of the schema survives a slip of the finger."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from vgvt.scenario.base import Table, written_fields
from vgvt.scenario.model import Scenario
from vgvt.scenario.vocabulary import guess, inner_table, meaning_of, table_at, unit_of


def _all_tables() -> list[type[Table]]:
    tables: list[type[Table]] = [Scenario]
    for table in tables:
        inner = (inner_table(field.annotation) for field in table.model_fields.values())
        tables += [t for t in inner if t is not None and t not in tables]
    return tables


_KEYS = [(table, key) for table in _all_tables() for key in written_fields(table) if len(key) >= 6]


@given(st.sampled_from(_KEYS), st.sampled_from(["drop", "double", "swap", "replace"]), st.data())
@settings(max_examples=300, deadline=None)
def test_one_slip_of_the_finger_is_understood(place: tuple[type[Table], str], slip: str, data: st.DataObject) -> None:
    table, key = place
    at = data.draw(st.integers(0, len(key) - 2))
    wrong = {
        "drop": key[:at] + key[at + 1 :],
        "double": key[: at + 1] + key[at:],
        "swap": key[:at] + key[at + 1] + key[at] + key[at + 2 :],
        "replace": key[:at] + "q" + key[at + 1 :],
    }[slip]
    if wrong in {k for t in _all_tables() for k in t.model_fields}:
        return
    assert guess(table, "in [here]", wrong) == f"Did you mean {key}?"


@given(st.text("abcdefghijklmnopqrstuvwxyz_", min_size=1, max_size=30))
@settings(max_examples=200, deadline=None)
def test_every_unknown_key_gets_a_sentence(key: str) -> None:
    for table in _all_tables():
        assert guess(table, "in [here]", key).endswith((".", "?"))


def test_keys_of_other_tables_are_sent_there() -> None:
    shaker = table_at(("shaker",))
    assert shaker is not None
    assert guess(shaker, "in [shaker]", "torsional_stiffness_n_m2") == (
        "torsional_stiffness_n_m2 belongs in [airframe.beam.stations]."
    )
    assert guess(shaker, "in [shaker]", "cells") == "cells belongs in [[airframe.beam]]."
    assert guess(shaker, "in [shaker]", "seed") == "seed belongs at the top of the file, before any [table]."


def test_every_key_that_ends_in_a_unit_has_it() -> None:
    for table in _all_tables():
        for key in table.model_fields:
            ends_in_unit = key.rsplit("_", 1)[-1] in {
                "m",
                "m2",
                "kg",
                "hz",
                "s",
                "n",
                "v",
                "h",
                "a",
                "g",
                "rad",
                "ohm",
                "rthz",
            }
            assert bool(unit_of(key)) == (ends_in_unit or key.endswith("_ratio")), key
    assert unit_of("root_bending_stiffness_n_m_per_rad") == "N m/rad"
    assert unit_of("pitch_inertia_kg_m") == "kg m"
    assert unit_of("mass_kg_per_m") == "kg/m"


def test_meaning_has_words_and_unit() -> None:
    stations = table_at(("airframe", "beam", 0, "stations"))
    assert stations is not None
    assert meaning_of(stations, "mass_kg_per_m") == "mass per length of the axis, in kg/m"
