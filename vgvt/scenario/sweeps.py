"""Sweeps: one scenario with some of its fields changed, many times over."""

from __future__ import annotations

import difflib
import itertools
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

from pydantic import ValidationError

from vgvt.data.errors import InputError
from vgvt.data.key_paths import key_path, with_entries
from vgvt.data.shown import headed
from vgvt.scenario.base import Table, written_fields
from vgvt.scenario.effect import EffectTable
from vgvt.scenario.explain import Problem, problems_of
from vgvt.scenario.model import Scenario
from vgvt.scenario.placement import scenario_placement_problems
from vgvt.scenario.rig import KIND_KEYS
from vgvt.scenario.streams import named_stream
from vgvt.scenario.swept_axis import Axis
from vgvt.scenario.used import comparable, is_there, is_wording, used_tables, why_unused
from vgvt.scenario.vocabulary import inner_table, table_at

Design = Literal["grid", "list", "latin"]
DESIGNS: tuple[Design, ...] = ("grid", "list", "latin")

_STEP = re.compile(r"([A-Za-z0-9_-]+)|\[([^\]]+)\]")


@dataclass(frozen=True, slots=True, eq=False)
class Variant:
    """One scenario of a sweep and the values that make it."""

    scenario: Scenario
    values: dict[str, Any]

    def __repr__(self) -> str:
        values = ", ".join(f"{key} = {value}" for key, value in self.values.items())
        return headed(f"Variant {self.scenario.name}: {values}")


def sweep(
    scenario: Scenario,
    axes: Sequence[Axis],
    design: Design = "grid",
    samples: int = 20,
    seed: int = 0,
    whole_of_effects: Mapping[str, Collection[str]] | None = None,
) -> tuple[Variant, ...]:
    """The scenarios of a sweep, named NAME-001 and so on.

    ``grid`` takes every combination, ``list`` the first values of all axes, then the second, and so on;
    ``latin`` draws ``samples`` points of a latin hypercube (McKay, Beckman and Conover,
    Technometrics 21(2), 1979) from the ranges, each once where whole numbers or lists make some alike: there are
    fewer variants than ``samples`` then. ``whole_of_effects`` says which parameters of which effect take whole
    numbers only (``whole_parameters`` of ``vgvt.effects.whole_numbers``); where it is silent a range has what lies
    between, too.
    InputError names the nearest key for one that does not exist, and refuses one that no simulation of a variant
    depends on, and two variants that are the same test.
    """
    keys = [axis.key for axis in axes]
    places = [_place(scenario, key) for key in keys]
    for key, place in zip(keys, places, strict=True):
        if places.count(place) > 1:
            raise InputError(f"--set {key}", "is there twice", "give each key once, all of its values together")
        if is_wording(scenario, place):
            raise _idle(key, why_unused(scenario, place))
    whole = [_is_whole(scenario, place, whole_of_effects or {}) for place in places]
    axes = [axis.in_whole_numbers() if is_whole else axis for axis, is_whole in zip(axes, whole, strict=True)]
    table = {"grid": _grid, "list": _list}[design](axes) if design != "latin" else _latin(axes, samples, seed)
    rows = [dict(zip(keys, row, strict=True)) for row in table]
    digits = max(3, len(str(len(rows))))
    variants = tuple(
        Variant(changed(scenario, values).model_copy(update={"name": f"{scenario.name}-{k:0{digits}d}"}), values)
        for k, values in enumerate(rows, start=1)
    )
    _require_different_tests(variants, dict(zip(keys, places, strict=True)))
    return variants


def _require_different_tests(variants: Sequence[Variant], places: Mapping[str, tuple[str | int, ...]]) -> None:
    """InputError for a key that no variant uses, and for two variants whose simulations read the same."""
    tables = [used_tables(variant.scenario) for variant in variants]
    for key, place in places.items():
        if not any(is_there(used, place) for used in tables):
            why = why_unused(variants[0].scenario, place) or "it belongs to no excitation.kind that is tried"
            raise _idle(key, why)
    known: dict[Any, Variant] = {}
    for variant, used in zip(variants, tables, strict=True):
        same = known.setdefault(comparable(used), variant)
        if same is variant:
            continue
        idle = [key for key, value in variant.values.items() if value != same.values[key]]
        if not idle:
            raise InputError(_setting(variant.values), "is there twice", "give each value once")
        raise InputError(
            f"--set {' '.join(idle)}",
            f"changes nothing for {variant.scenario.name} ({_written(variant.values)}): that is the same test as "
            f"{same.scenario.name} ({_written(same.values)})",
            "leave out what changes nothing, or write row by row with --design list what is to be tried",
        )


def _idle(key: str, why: str) -> InputError:
    return InputError(
        f"--set {key}",
        f"{why}: all variants would be alike",
        "sweep what the test is made of, as excitation.duration_s=30,60",
    )


def changed(scenario: Scenario, values: Mapping[str, Any]) -> Scenario:
    """The scenario with other values at dotted keys like ``airframe.beam[wing].cells``, checked as a file would be.

    InputError for a key that does not exist, with the nearest one, and for a value that does not fit.
    """
    tables = scenario.model_dump(mode="json", exclude_none=True)
    for key, value in values.items():
        _put(tables, scenario, key, value)
    excitation = tables["excitation"]
    if "excitation.kind" in values:
        foreign = {k for keys in KIND_KEYS.values() for k in keys} - set(KIND_KEYS.get(excitation["kind"], ()))
        tables["excitation"] = {k: v for k, v in excitation.items() if k not in foreign}
    try:
        made = Scenario.model_validate(tables)
    except ValidationError as error:
        own = {_place(scenario, key) for key in values}
        told = [problem.at_own(own.__contains__) for problem in problems_of(error)]
        raise _refusal(values, told, tables) from None
    problems = scenario_placement_problems(made)
    if problems:
        raise _refusal(values, problems, tables)
    return made


def known_keys(scenario: Scenario) -> tuple[str, ...]:
    """Every key that can be swept, as it is written: of the schema, entries by their name, and of its effects."""
    tables = scenario.model_dump(mode="json")
    return tuple(k for k in _keys(scenario, Scenario, "") if not why_unused(scenario, _found(tables, k) or ()))


def _keys(value: Any, table: type[Table], path: str) -> Iterator[str]:
    for name, field in written_fields(table).items():
        here, inner, own = f"{path}{name}", inner_table(field.annotation), getattr(value, name, None)
        if inner is None:
            yield here
        elif isinstance(own, tuple):
            for i, entry in enumerate(own):
                yield from _keys(entry, type(entry), f"{here}[{getattr(entry, 'name', i)}].")
        elif own is not None:
            yield from _keys(own, inner, f"{here}.")
    if isinstance(value, EffectTable):
        yield from (f"{path}{name}" for name in value.parameters)


def _place(scenario: Scenario, key: str) -> tuple[str | int, ...]:
    """The path of a key in the tables; InputError with the nearest key for an unknown one."""
    place = _found(scenario.model_dump(mode="json"), key)
    if place is None:
        raise _no_such_key(scenario, key)
    return place


def _found(tables: dict[str, Any], key: str) -> tuple[str | int, ...] | None:
    """The path of a key in a scenario's tables, None where it leads nowhere or to a table."""
    plain: list[str | int] = []
    value: Any = tables
    for step in key_steps(key):
        if isinstance(value, list) and isinstance(step, str):
            names = [entry.get("name") if isinstance(entry, dict) else None for entry in value]
            step = names.index(step) if step in names else -1
        inside = (isinstance(value, dict) and step in value) or (
            isinstance(value, list) and isinstance(step, int) and 0 <= step < len(value)
        )
        if not inside and not (isinstance(value, dict) and plain and plain[0] == "effect"):
            return None
        plain.append(step)
        value = value[step] if inside else None
    return None if not plain or isinstance(value, dict) else tuple(plain)


def _is_whole(
    scenario: Scenario, place: tuple[str | int, ...], whole_of_effects: Mapping[str, Collection[str]]
) -> bool:
    """Whether there are whole numbers only at a place: the schema says so, of an effect's parameters the effect."""
    match place:
        case ("effect", int(index), str(parameter)):
            return parameter in whole_of_effects.get(scenario.effect[index].name, ())
    *way, name = (step for step in place if isinstance(step, str))
    table = table_at(tuple(way))
    field = table.model_fields.get(name) if table else None
    return field is not None and _holds_whole_numbers(field.annotation)


def _holds_whole_numbers(annotation: Any) -> bool:
    return annotation is int or any(_holds_whole_numbers(inner) for inner in get_args(annotation))


def key_steps(key: str) -> list[str | int]:
    """The steps of a key as it is written, names and numbers of entries, dots and brackets apart."""
    return [name or (int(entry) if entry.isdigit() else entry) for name, entry in _STEP.findall(key)]


def _no_such_key(scenario: Scenario, key: str) -> InputError:
    keys = known_keys(scenario)
    same_end = [k for k in keys if k.rsplit(".", 1)[-1] == key.rsplit(".", 1)[-1]]
    # A likely whole key beats one that merely ends alike.
    near = difflib.get_close_matches(key, keys, n=3, cutoff=0.75) or same_end[:3]
    near = near or difflib.get_close_matches(key, keys, n=1, cutoff=0.0)
    return InputError(f"--set {key}", "the scenario has no such key", f"Did you mean {' or '.join(near)}?")


def _put(tables: dict[str, Any], scenario: Scenario, key: str, value: Any) -> None:
    *way, last = _place(scenario, key)
    table: Any = tables
    for step in way:
        table = table.setdefault(step, {}) if isinstance(table, dict) else table[step]
    table[last] = value


def _refusal(values: Mapping[str, Any], problems: Sequence[Problem], tables: dict[str, Any]) -> InputError:
    first = problems[0]
    return InputError(
        _setting(values),
        f"{key_path(first.key) or 'scenario'} {first.text}",
        with_entries(first.advice, first.key, tables),
    )


def _setting(values: Mapping[str, Any]) -> str:
    return f"--set {_written(values)}"


def _written(values: Mapping[str, Any]) -> str:
    return " ".join(f"{key}={value}" for key, value in values.items())


def _grid(axes: Sequence[Axis]) -> list[tuple[Any, ...]]:
    return list(itertools.product(*(_values(axis) for axis in axes)))


def _list(axes: Sequence[Axis]) -> list[tuple[Any, ...]]:
    lengths = {len(_values(axis)) for axis in axes}
    if len(lengths) > 1:
        raise InputError("--design list", "the keys have different numbers of values", "give each key as many")
    return list(zip(*(_values(axis) for axis in axes), strict=True))


def _values(axis: Axis) -> tuple[Any, ...]:
    if not axis.values:
        raise InputError(f"--set {axis.key}", "a range has no values of its own", "write low..high:count")
    return axis.values


def _latin(axes: Sequence[Axis], samples: int, seed: int) -> list[tuple[Any, ...]]:
    """One point in each of ``samples`` equal strata of every axis, paired at random; equal points once."""
    columns: list[list[Any]] = []
    for axis in axes:
        stream = named_stream(seed, "latin hypercube", axis.key)
        fractions = (stream.permutation(samples) + stream.random(samples)) / samples
        if axis.values:
            columns.append([axis.values[int(f * len(axis.values))] for f in fractions])
        else:
            columns.append([axis.at(float(f)) for f in fractions])
    rows = list(zip(*columns, strict=True))
    return [row for k, row in enumerate(rows) if row not in rows[:k]]
