"""A key path counts from 0; what it means is said in words that nobody counts wrongly."""

from __future__ import annotations

import pytest

from vgvt.data.key_paths import key_path, ordinal, with_entries

TABLES = {
    "effect": [{"name": "hum"}, {"name": "mass"}, {"name": "mass"}, {}],
    "run": [{}, {"nodes": {"a": 1}}],
    "runs": [[1], [2, 3]],
}


@pytest.mark.parametrize(
    ("key", "path", "words"),
    [
        (("effect", 0, "x_m"), "effect[0].x_m", "effect[0] is 'hum'"),
        (("effect", 2), "effect[2]", "effect[2] is the second 'mass'"),
        (("effect", 3), "effect[3]", "effect[3] is the fourth"),
        (("run", 1, "nodes", "a"), "run[1].nodes.a", "run[1] is the second"),
        (("runs", 1, 0), "runs[1][0]", "runs[1] is the second and runs[1][0] is the first in it"),
        (("further_shaker", 0, "node"), "further_shaker[0].node", "further_shaker[0] is the second shaker"),
        (("airframe", "beam", 20), "airframe.beam[20]", "beam[20] is the 21st"),
    ],
)
def test_the_entry_is_told_behind_the_advice(key: tuple[str | int, ...], path: str, words: str) -> None:
    assert key_path(key) == path
    assert with_entries("write 1", key, TABLES) == f"write 1; counted from 0, {words}"
    assert with_entries("Write 1.", key, TABLES) == f"Write 1. Counted from 0, {words}."
    assert with_entries("", key, TABLES) == f"Counted from 0, {words}."


def test_a_path_without_entries_needs_no_words() -> None:
    assert with_entries("write 1", ("shaker", "node"), TABLES) == "write 1"
    assert with_entries("", (), TABLES) == ""


def test_ordinals() -> None:
    assert [ordinal(n) for n in (1, 10, 11, 12, 13, 21, 22, 23, 24, 111)] == [
        "first", "tenth", "11th", "12th", "13th", "21st", "22nd", "23rd", "24th", "111th",
    ]  # fmt: skip
