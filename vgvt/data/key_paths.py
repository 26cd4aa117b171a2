"""Key paths as they are written, ``airframe.beam[0].name``, and in words which entry each of their numbers means."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

_ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")


def key_path(key: Iterable[str | int]) -> str:
    """``airframe.beam[0].name``: a key path as people write it, counting from 0 as the arrays do."""
    text = ""
    for step in key:
        text += f"[{step}]" if isinstance(step, int) else f".{step}" if text else step
    return text


def with_entries(advice: str, key: Sequence[str | int], tables: Any) -> str:
    """An advice, and behind it which entries a key path means: people count from 1, and what a file extends counts too.

    ``tables`` are those that the key path leads into. An entry that has a name is told by it.
    """
    said = [
        f"{_label(key[: end + 1])} is {_entry(key[: end + 1], tables)}"
        for end, step in enumerate(key)
        if isinstance(step, int)
    ]
    if not said:
        return advice
    words = f"ounted from 0, {' and '.join(said)}"
    if not advice or advice[-1] in ".?":
        return f"{advice} C{words}.".lstrip()
    return f"{advice}; c{words}"


def ordinal(number: int) -> str:
    """``second`` of 2."""
    if number <= len(_ORDINALS):
        return _ORDINALS[number - 1]
    ending = "th" if number % 100 in (11, 12, 13) else {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    return f"{number}{ending}"


def _label(key: Sequence[str | int]) -> str:
    """``beam[0]``: the end of a key path, from its last name on."""
    start = max((at for at, step in enumerate(key) if isinstance(step, str)), default=0)
    return key_path(key[start:])


def _entry(key: Sequence[str | int], tables: Any) -> str:
    *way, number = key
    assert isinstance(number, int)
    if way[-1:] == ["further_shaker"]:
        return f"the {ordinal(number + 2)} shaker"
    entries = _at(way, tables)
    names = [entry.get("name") if isinstance(entry, dict) else None for entry in entries or ()]
    name = names[number] if number < len(names) else None
    if isinstance(name, str) and name:
        before = names[:number].count(name)
        return f"the {ordinal(before + 1)} {name!r}" if names.count(name) > 1 else repr(name)
    return f"the {ordinal(number + 1)}" + (" in it" if way and isinstance(way[-1], int) else "")


def _at(key: Sequence[str | int], tables: Any) -> list[Any] | None:
    """The list that a key path leads to; None where it leads elsewhere."""
    value = tables
    for step in key:
        if isinstance(value, dict):
            value = value.get(step)
        elif isinstance(value, list) and isinstance(step, int) and step < len(value):
            value = value[step]
        else:
            return None
    return value if isinstance(value, list) else None
