"""From a text file to a scenario, with the mistakes in it told together."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from vgvt.data.errors import InputError
from vgvt.data.key_paths import key_path, with_entries
from vgvt.scenario.airframe import Airframe
from vgvt.scenario.base import Table
from vgvt.scenario.explain import Problem, problems_of
from vgvt.scenario.inheritance import Source, read_source
from vgvt.scenario.instruments import Grid
from vgvt.scenario.library import bundled_path
from vgvt.scenario.model import Scenario
from vgvt.scenario.placement import placement_problems, scenario_placement_problems
from vgvt.scenario.rig import Shaker, Suspension

_SHOWN_AT_ONCE = 10

_AnyTable = TypeVar("_AnyTable", bound=Table)


def load_scenario(name_or_path: str | Path) -> Scenario:
    """The scenario of a bundled name like ``quick`` or of a TOML file.

    Text that ends in ``.toml`` or holds a path separator is a file; other text
    is a bundled name, or else a file of that name. InputError names the file,
    the key and what to write, for up to ten mistakes at once. Tables that are right in
    themselves are also checked against each other where others are still wrong.
    """
    source = read_source(scenario_path(name_or_path))
    try:
        scenario = Scenario.model_validate(source.tables)
    except ValidationError as error:
        raise _refusal(source, _with_placement(problems_of(error), source.tables)) from None
    problems = scenario_placement_problems(scenario)
    if problems:
        raise _refusal(source, problems)
    return scenario


def _with_placement(problems: Sequence[Problem], tables: Mapping[str, Any]) -> tuple[Problem, ...]:
    """The mistakes, and what is off the aircraft as far as the tables that say so are right in themselves."""
    airframe = _valid(Airframe, tables.get("airframe"))
    if airframe is None:
        return tuple(problems)
    accelerometers, further = tables.get("accelerometers"), tables.get("further_shaker")
    placed = placement_problems(
        airframe,
        _valid(Grid, accelerometers.get("grid") if isinstance(accelerometers, dict) else None),
        _valid(Shaker, tables.get("shaker")),
        _valid(Suspension, tables.get("suspension")),
        [_valid(Shaker, table) for table in further] if isinstance(further, list) else (),
    )
    known = {problem.key for problem in problems}
    return (*problems, *(problem for problem in placed if problem.key not in known))


def _valid(kind: type[_AnyTable], value: Any) -> _AnyTable | None:
    try:
        return kind.model_validate(value)
    except ValidationError:
        return None


def scenario_path(name_or_path: str | Path) -> Path:
    """The file that a bundled name or a path means; InputError for an unknown name."""
    if isinstance(name_or_path, Path):
        return name_or_path
    separators = [os.sep, os.altsep] if os.altsep else [os.sep]
    if name_or_path.endswith(".toml") or any(s in name_or_path for s in separators):
        return Path(name_or_path)
    try:
        return bundled_path(name_or_path)
    except InputError:
        if Path(name_or_path).exists():
            return Path(name_or_path)
        raise


def _refusal(source: Source, problems: Sequence[Problem]) -> InputError:
    problems = [problem.at_own(lambda key: source.written_in.get(key) == source.path) for problem in problems]
    first = problems[0]
    if len(problems) == 1:
        place = key_path(first.key)
        advice = with_entries(first.advice, first.key, source.tables)
        return InputError(f"{source.file_of(first.key)}" + (f": {place}" if place else ""), first.text, advice)
    lines = [_line(source, problem) for problem in problems[:_SHOWN_AT_ONCE]]
    if len(problems) > _SHOWN_AT_ONCE:
        lines.append(f"… and {len(problems) - _SHOWN_AT_ONCE} more.")
    return InputError(str(source.path), f"{len(problems)} mistakes", "\n  ".join(lines))


def _line(source: Source, problem: Problem) -> str:
    file = source.file_of(problem.key)
    where = f" (written in {file})" if file != source.path else ""
    advice = with_entries(problem.advice, problem.key, source.tables)
    return f"{key_path(problem.key) or 'scenario'}{where}: {problem.text}. {advice}".rstrip()
