"""Edits of a scenario's beams: choose tables by name, write mirrored tables out, change some of their columns."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Literal

import numpy as np

from vgvt.data import InputError
from vgvt.data.suggestion import choose_one_of
from vgvt.effects.shakers import with_shakers
from vgvt.scenario.airframe import Airframe, Beam, mirrored_names
from vgvt.scenario.mirror import expanded_beams, expanded_items, part_name
from vgvt.scenario.model import Scenario
from vgvt.scenario.rig import Shaker

Side = Literal["both", "right", "left"]


def plain_name(beam: str) -> str:
    """The name of a beam as a mirrored table has it: 'wing' for 'wing-right'."""
    return beam.removesuffix("-right").removesuffix("-left")


def chosen_beams(airframe: Airframe, choice: str, effect: str) -> tuple[str, ...]:
    """Names of the tables that ``choice`` means: a table, both copies of a mirrored one, or '' for all on the body.

    InputError, naming the ``effect``, where there is no such beam.
    """
    if choice == "":
        return tuple(b.name for b in airframe.beam if b.parent == "body")
    names = tuple(b.name for b in airframe.beam if choice in (b.name, plain_name(b.name)))
    if not names:
        known = tuple(dict.fromkeys(plain_name(b.name) for b in airframe.beam))
        raise InputError(f"effect {effect}: beam", f"there is no beam {choice!r}", choose_one_of(choice, known))
    return names


def with_beams(scenario: Scenario, names: Iterable[str], change: Callable[[Beam], Beam]) -> Scenario:
    """The scenario with some of its tables changed; a mirrored table changes on both sides."""
    wanted = set(names)
    beams = tuple(change(b) if b.name in wanted else b for b in scenario.airframe.beam)
    return with_airframe(scenario, beam=beams)


def with_airframe(scenario: Scenario, **tables: object) -> Scenario:
    """The scenario with some tables of its airframe replaced."""
    return scenario.model_copy(update={"airframe": scenario.airframe.model_copy(update=tables)})


def with_columns(beam: Beam, **columns: Iterable[float]) -> Beam:
    """The beam with some columns of its station table replaced."""
    update = {name: tuple(float(v) for v in values) for name, values in columns.items()}
    return beam.model_copy(update={"stations": beam.stations.model_copy(update=update)})


def scaled(column: Iterable[float], factor: float) -> tuple[float, ...]:
    """A column times a factor."""
    return tuple(float(v) for v in factor * np.array(tuple(column)))


def written_out(scenario: Scenario) -> Scenario:
    """The same aircraft with every mirrored table as two, so that the sides can differ; references follow."""
    airframe, grid = scenario.airframe, scenario.accelerometers.grid
    if grid.attached_to is not None:
        parts = tuple(part_name(airframe, p, y) for p, y in zip(grid.attached_to, grid.y_m, strict=True))
        grid = grid.model_copy(update={"attached_to": parts})

    def on_its_side(shaker: Shaker) -> Shaker:
        part = part_name(airframe, shaker.attached_to, shaker.position_m[1])
        return shaker.model_copy(update={"attached_to": part})

    split = with_airframe(scenario, beam=expanded_beams(airframe), item=expanded_items(airframe))
    split = with_shakers(split, tuple(range(len(scenario.shakers))), on_its_side)
    return split.model_copy(update={"accelerometers": scenario.accelerometers.model_copy(update={"grid": grid})})


def on_side(scenario: Scenario, names: tuple[str, ...], side: Side, effect: str) -> tuple[Scenario, tuple[str, ...]]:
    """The scenario written out as far as one side needs it, and the names of the chosen tables on that side.

    InputError, naming the ``effect``, where there is none on that side.
    """
    if side == "both":
        return scenario, names
    chosen = tuple(copy for copy in copies_of(scenario.airframe, names) if copy.endswith(f"-{side}"))
    if not chosen:
        raise InputError(f"effect {effect}: side", f"there is no {side} copy of the beam", "Write side = 'both'.")
    return written_out(scenario), chosen


def copies_of(airframe: Airframe, names: Iterable[str]) -> tuple[str, ...]:
    """What the tables of these names are called as built: both copies of a mirrored one, right before left."""
    wanted = set(names)
    return tuple(copy for b in airframe.beam if b.name in wanted for copy in mirrored_names(b.name, b.mirror))
