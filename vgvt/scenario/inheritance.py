"""Scenarios that extend another: only the differences are written down."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vgvt.data.errors import InputError
from vgvt.data.key_paths import key_path
from vgvt.scenario.library import bundled_path, bundled_scenarios
from vgvt.scenario.rig import KIND_KEYS, shakers_apart
from vgvt.scenario.toml_source import read_toml

KeyPath = tuple[str | int, ...]

OWN_WORDS = ("name", "summary", "lesson")
"""Every file speaks for itself: these are not inherited."""

_MAY_REPEAT: tuple[KeyPath, ...] = (("effect",),)
"""Arrays in which several entries may have one name; in any other a name means one entry."""


@dataclass(frozen=True, slots=True)
class Source:
    """The merged tables of a scenario file, and which file each key was written in."""

    path: Path
    tables: dict[str, Any]
    written_in: dict[KeyPath, Path]

    def file_of(self, key: KeyPath) -> Path:
        """The file that wrote a key; of one that is missing, the last to write in the nearest table around it."""
        for length in range(len(key), 0, -1):
            if key[:length] in self.written_in:
                # What a file changes in a table may ask for more there than its parent wrote.
                below = [f for k, f in self.written_in.items() if len(k) > length and k[:length] == key[:length]]
                return below[-1] if below and length < len(key) else self.written_in[key[:length]]
        return self.path


def read_source(path: Path, chain: tuple[Path, ...] = ()) -> Source:
    """Read a scenario file and what it extends.

    ``extends`` names a bundled scenario or a file relative to this one. Tables
    merge key by key; arrays of tables whose entries have a name merge entry by
    entry, new names last; anything else is replaced, all shakers together by an
    array of them. ``name``, ``summary`` and ``lesson`` are not inherited, nor are
    the keys of an excitation's old kind, nor ``excitation.shakers`` where this file
    leaves one shaker of several. Several [[shaker]] come back apart, as
    ``shaker`` and ``further_shaker``. InputError for a missing parent, a cycle, or
    a beam or item that one file names twice.
    """
    place = path.resolve()
    if place in chain:
        circle = " -> ".join(p.name for p in (*chain[chain.index(place) :], place))
        raise InputError(
            f"{chain[-1]}: extends", f"the scenarios extend each other: {circle}", "Remove one of these extends lines."
        )
    written = read_toml(path)
    tables = shakers_apart(written)
    if "extends" not in tables:
        return Source(path, tables, dict.fromkeys(_keys(tables), path))
    parent = read_source(_parent_path(path, tables.pop("extends")), (*chain, place))
    own = (*OWN_WORDS, "shaker", "further_shaker") if isinstance(written.get("shaker"), list) else OWN_WORDS
    inherited = {key: value for key, value in parent.tables.items() if key not in own}
    inherited = _without_keys_of_another_kind(inherited, tables.get("excitation"))
    if tables.get("further_shaker") == []:
        inherited = _without_keys_of_several_shakers(inherited)
    written_in = {key: file for key, file in parent.written_in.items() if key[0] not in own}
    return Source(path, _merged(inherited, tables, (), written_in, path), written_in)


def _without_keys_of_another_kind(inherited: dict[str, Any], changes: Any) -> dict[str, Any]:
    """The inherited tables less the keys of an excitation whose kind this file changes: it could not unset them."""
    old, kind = inherited.get("excitation"), changes.get("kind") if isinstance(changes, dict) else None
    if not isinstance(old, dict) or kind not in KIND_KEYS:
        return inherited
    foreign = {key for keys in KIND_KEYS.values() for key in keys} - set(KIND_KEYS[kind])
    return inherited | {"excitation": {key: value for key, value in old.items() if key not in foreign}}


def _without_keys_of_several_shakers(inherited: dict[str, Any]) -> dict[str, Any]:
    """The inherited tables less ``excitation.shakers``: a file that leaves one shaker could not unset it."""
    old = inherited.get("excitation")
    if not isinstance(old, dict):
        return inherited
    return inherited | {"excitation": {key: value for key, value in old.items() if key != "shakers"}}


def _parent_path(path: Path, name: Any) -> Path:
    where = f"{path}: extends"
    if not isinstance(name, str) or not name:
        raise InputError(
            where, f"is {name!r}, not a name", 'Write a bundled scenario or a file, like extends = "hati-unsymmetric".'
        )
    if name not in bundled_scenarios() and (name.endswith(".toml") or "/" in name):
        parent = path.parent / name
        if not parent.is_file():
            raise InputError(where, f"there is no file {parent}", "Write the path relative to this file.")
        return parent
    return bundled_path(name, where)


def _merged(
    base: dict[str, Any], changes: dict[str, Any], at: KeyPath, written_in: dict[KeyPath, Path], path: Path
) -> dict[str, Any]:
    result = dict(base)
    for key, value in changes.items():
        here = (*at, key)
        old = result.get(key)
        if isinstance(value, dict) and isinstance(old, dict):
            result[key] = _merged(old, value, here, written_in, path)
        elif isinstance(old, list) and _is_named_array(value) and _is_named_array(old):
            result[key] = _merged_array(old, value, here, written_in, path)
        else:
            result[key] = value
            _forget(written_in, here)
            written_in.update(dict.fromkeys((here, *((*here, *k) for k in _keys(value))), path))
    return result


def _merged_array(
    base: list[dict[str, Any]],
    changes: list[dict[str, Any]],
    at: KeyPath,
    written_in: dict[KeyPath, Path],
    path: Path,
) -> list[dict[str, Any]]:
    """Each entry changes the parent's first of its name that no entry before it changed, or is added."""
    result = list(base)
    changed: set[int] = set()
    for place, entry in enumerate(changes):
        name = entry["name"]
        if at not in _MAY_REPEAT and any(before["name"] == name for before in changes[:place]):
            where = f"{path}: {key_path((*at, place, 'name'))}"
            raise InputError(where, f"is {name!r}, which is taken", "Give it a name of its own.")
        free = (i for i, old in enumerate(base) if i not in changed and old["name"] == name)
        index = next(free, len(result))
        changed.add(index)
        if index == len(result):
            result.append({})
            written_in[(*at, index)] = path
        result[index] = _merged(result[index], entry, (*at, index), written_in, path)
    return result


def _is_named_array(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(v, dict) and "name" in v for v in value)


def _forget(written_in: dict[KeyPath, Path], at: KeyPath) -> None:
    for key in [k for k in written_in if k[: len(at)] == at]:
        del written_in[key]


def _keys(value: Any) -> list[KeyPath]:
    """Key paths of everything inside a value."""
    if isinstance(value, dict):
        inside = value.items()
    elif isinstance(value, list):
        inside = enumerate(value)  # type: ignore[assignment]
    else:
        return []
    return [path for key, v in inside for path in ((key,), *((key, *k) for k in _keys(v)))]
