"""The scenario that a command is given, with effects that its test can have: a mistake in one costs no time."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from vgvt.cli.console import log

if TYPE_CHECKING:
    from pathlib import Path

    from vgvt.data import InputError
    from vgvt.scenario.model import Scenario


def described_scenario(name: str, *, own_runs: bool = True) -> Scenario:
    """The scenario of a bundled name or a file; InputError names the file of a mistake, in its effects as well.

    Without ``own_runs`` a campaign's runs take the place of the scenario's, and its effects may begin in any of them.
    """
    from vgvt.data import InputError
    from vgvt.effects.places import require_in_the_runs, require_on_aircraft
    from vgvt.scenario import load_scenario
    from vgvt.scenario.load import scenario_path

    scenario = load_scenario(name)
    try:
        require_on_aircraft(scenario)
        if own_runs:
            require_in_the_runs(scenario)
    except InputError as error:
        raise _in_its_file(error, scenario, scenario_path(name)) from error
    return scenario


def say_what_is_not_as_described(scenario: Scenario) -> None:
    """A line on stderr where damping ratios reach no mode, and one for each beam whose cells hold a sharp bend."""
    from vgvt.scenario.cells import bent_within_a_cell
    from vgvt.simulation.once import damping_once
    from vgvt.simulation.pushed import pushed_beams

    airframe = scenario.airframe
    bent = (bent_within_a_cell(beam) for beam in airframe.beam)
    damping = damping_once(airframe, pushed_beams(scenario))
    for words in (damping.without_effect(airframe.damping), *bent):
        if words is not None:
            log(f"vgvt: warning: {words}")


def _in_its_file(error: InputError, scenario: Scenario, path: Path) -> InputError:
    """What an effect says of the scenario that it was handed, said of the file that wrote the effect's table."""
    from vgvt.data import InputError
    from vgvt.data.key_paths import with_entries
    from vgvt.scenario.inheritance import read_source

    handed = f"scenario {scenario.name}: "
    if not error.where.startswith(handed):
        return error
    place = error.where.removeprefix(handed)
    index = _table_of(place, scenario)
    key = ("effect",) if index is None else ("effect", index)
    advice, names = error.advice, [table.name for table in scenario.effect]
    # The problem names the effect: words are wanted where several tables have that name.
    if index is not None and place.startswith("effect[") and names.count(names[index]) > 1:
        advice = with_entries(advice, key, {"effect": [{"name": name} for name in names]})
    return InputError(f"{read_source(path).file_of(key)}: {place}", error.problem, advice)


def _table_of(place: str, scenario: Scenario) -> int | None:
    """Which ``[[effect]]`` a place means, by its index or by the effect's name; None where it is none of them."""
    found = re.match(r"effect(?:\[(\d+)\]| ([\w-]+))", place)
    if found is None:
        return None
    if found[1] is not None:
        return int(found[1])
    return next((i for i, table in enumerate(scenario.effect) if table.name == found[2]), None)
