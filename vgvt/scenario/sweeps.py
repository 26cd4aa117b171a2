"""Sweeps: one scenario with some of its fields changed, many times over."""

from __future__ import annotations

import difflib
import itertools
import math
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from pydantic import ValidationError

from vgvt.data.errors import InputError
from vgvt.scenario.base import Table
from vgvt.scenario.effect import EffectTable
from vgvt.scenario.explain import Problem, key_path, problems_of
from vgvt.scenario.model import Scenario
from vgvt.scenario.placement import placement_problems
from vgvt.scenario.rig import KIND_KEYS
from vgvt.scenario.streams import named_stream
from vgvt.scenario.vocabulary import inner_table

Design = Literal["grid", "list", "latin"]
DESIGNS: tuple[Design, ...] = ("grid", "list", "latin")

_UNUSED = ("schema_version", "name", "summary", "lesson", "tolerances")  # by a simulation

_RANGE = re.compile(r"^(?P<low>[^,\[\]]+?)\.\.(?P<high>[^,\[\]:]+)(?::(?P<count>\d+))?(?P<log>:log)?$")
_STEP = re.compile(r"([A-Za-z0-9_-]+)|\[([^\]]+)\]")


@dataclass(frozen=True, slots=True)
class Axis:
    """One swept key: its values, or the range that a latin hypercube draws from, even in the logarithm if ``log``."""

    key: str
    values: tuple[Any, ...] = ()
    low: float = 0.0
    high: float = 0.0
    log: bool = False

    @classmethod
    def parse(cls, text: str) -> Axis:
        """The axis written as KEY=a,b,c or KEY=low..high[:count][:log]; InputError says what is wrong."""
        key, equals, values = (part.strip() for part in text.partition("="))
        if not equals or not key or not values:
            raise InputError(f"--set {text}", "is not KEY=values", "write excitation.duration_s=30,60 or KEY=1..5:9")
        span = _RANGE.match(values)
        if span is None:
            return cls(key, tuple(_typed(text, v) for v in _listed(values)))
        low, high = (_typed(text, span[end]) for end in ("low", "high"))
        if isinstance(low, str) or isinstance(high, str) or not low < high:
            raise InputError(f"--set {text}", f"{values!r} is no range", "write two rising numbers, like 1..5")
        if span["log"] and low <= 0:
            raise InputError(f"--set {text}", "a logarithmic range starts above 0", "drop :log or start higher")
        axis = cls(key, (), float(low), float(high), bool(span["log"]))
        if span["count"] is None:
            return axis
        if int(span["count"]) < 2:
            raise InputError(f"--set {text}", "a range has two values at least", "write a count of 2 or more")
        at = np.linspace(0, 1, int(span["count"]))
        return cls(key, tuple(axis.at(float(fraction)) for fraction in at), axis.low, axis.high, axis.log)

    def at(self, fraction: float) -> float:
        """The value at a fraction of the way from ``low`` to ``high``, rounded to ten digits."""
        if self.log:
            value = math.exp(math.log(self.low) + fraction * math.log(self.high / self.low))
        else:
            value = self.low + fraction * (self.high - self.low)
        return float(f"{value:.10g}")


@dataclass(frozen=True, slots=True, eq=False)
class Variant:
    """One scenario of a sweep and the values that make it."""

    scenario: Scenario
    values: dict[str, Any]


def sweep(
    scenario: Scenario, axes: Sequence[Axis], design: Design = "grid", samples: int = 20, seed: int = 0
) -> tuple[Variant, ...]:
    """The scenarios of a sweep, named NAME-001 and so on.

    ``grid`` takes every combination, ``list`` the first values of all axes, then the second, and so on;
    ``latin`` draws ``samples`` points of a latin hypercube (McKay, Beckman and Conover,
    Technometrics 21(2), 1979) from the ranges. InputError names the nearest key for one that does not exist,
    and refuses one that no simulation depends on.
    """
    keys = [axis.key for axis in axes]
    places = [_place(scenario, key) for key in keys]
    for key, place in zip(keys, places, strict=True):
        if places.count(place) > 1:
            raise InputError(f"--set {key}", "is there twice", "give each key once, all of its values together")
        if place[0] in _UNUSED:
            raise InputError(
                f"--set {key}",
                "no simulation depends on it: all variants would be alike",
                "sweep what the test is made of, as excitation.duration_s=30,60",
            )
    table = {"grid": _grid, "list": _list}[design](axes) if design != "latin" else _latin(axes, samples, seed)
    rows = [dict(zip(keys, row, strict=True)) for row in table]
    digits = max(3, len(str(len(rows))))
    return tuple(
        Variant(changed(scenario, values).model_copy(update={"name": f"{scenario.name}-{k:0{digits}d}"}), values)
        for k, values in enumerate(rows, start=1)
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
        raise _refusal(values, problems_of(error)) from None
    problems = placement_problems(made.airframe, made.accelerometers.grid, made.shaker, made.suspension)
    if problems:
        raise _refusal(values, problems)
    return made


def known_keys(scenario: Scenario) -> tuple[str, ...]:
    """Every key that can be swept, as it is written: of the schema, entries by their name, and of its effects."""
    return tuple(key for key in _keys(scenario, Scenario, "") if key.partition(".")[0] not in _UNUSED)


def _keys(value: Any, table: type[Table], path: str) -> Iterator[str]:
    for name, field in table.model_fields.items():
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
    plain: list[str | int] = []
    value: Any = scenario.model_dump(mode="json")
    for step in key_steps(key):
        if isinstance(value, list) and isinstance(step, str):
            names = [entry.get("name") if isinstance(entry, dict) else None for entry in value]
            step = names.index(step) if step in names else -1
        inside = (isinstance(value, dict) and step in value) or (
            isinstance(value, list) and isinstance(step, int) and 0 <= step < len(value)
        )
        if not inside and not (isinstance(value, dict) and plain and plain[0] == "effect"):
            raise _no_such_key(scenario, key)
        plain.append(step)
        value = value[step] if inside else None
    if not plain or isinstance(value, dict):
        raise _no_such_key(scenario, key)
    return tuple(plain)


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


def _refusal(values: Mapping[str, Any], problems: Sequence[Problem]) -> InputError:
    where = "--set " + " ".join(f"{key}={value}" for key, value in values.items())
    first = problems[0]
    return InputError(where, f"{key_path(first.key) or 'scenario'} {first.text}", first.advice)


def _listed(values: str) -> list[str]:
    """Values between the commas that are outside brackets."""
    return [part.strip() for part in re.findall(r"(?:\[[^\]]*\]|[^,\[])+", values) if part.strip()]


def _typed(text: str, value: str) -> Any:
    """A value as TOML reads it; what TOML cannot read is text."""
    try:
        return tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        if re.fullmatch(r"[\w .-]+", value.strip()):
            return value.strip()
        raise InputError(f"--set {text}", f"{value!r} is no value", "write numbers, words, or lists in [ ]") from None


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
    """One point in each of ``samples`` equal strata of every axis, paired at random."""
    columns: list[list[Any]] = []
    for axis in axes:
        stream = named_stream(seed, "latin hypercube", axis.key)
        fractions = (stream.permutation(samples) + stream.random(samples)) / samples
        if axis.values:
            columns.append([axis.values[int(f * len(axis.values))] for f in fractions])
        else:
            columns.append([axis.at(float(f)) for f in fractions])
    return list(zip(*columns, strict=True))
