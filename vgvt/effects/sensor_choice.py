"""Which accelerometers or channels an effect means: all, one, every other one, or one of the roving set."""

from __future__ import annotations

import re

from vgvt.data import Dof, InputError
from vgvt.scenario.model import Scenario
from vgvt.scenario.points import SensorPoint, sensor_points

CHOICES = "'response' (all), 'odd' or 'even' nodes, 'sensor-2' (the second one of every run), or a DOF like 12+Z"
CHANNELS = f"'force', or {CHOICES}"
DRIVE = "drive"
"""The commands' channels, which a hammer test does not have."""
_ROLES = ("force", DRIVE, "response", "all")


def chosen_sensors(
    scenario: Scenario, run: int, choice: str, effect: str, choices: str = CHOICES
) -> tuple[SensorPoint, ...]:
    """The accelerometers of a run (counted from 0) that a choice means, in the order of the channels.

    ``choice`` is one of ``CHOICES``. InputError, naming the effect and ``choices``, for anything
    else, for a DOF that the grid does not have, and for a place among the sensors that no run has.
    """
    by_node = {p.dof.node: p for p in sensor_points(scenario)}
    there = tuple(by_node[node] for node in scenario.acquisition.run_nodes[run])
    if choice == "response":
        return there
    if choice in ("odd", "even"):
        return tuple(p for p in there if p.dof.node % 2 == (choice == "odd"))
    instrument = re.fullmatch(r"sensor-([1-9]\d*)", choice)
    if instrument is not None:
        place, most = int(instrument[1]), max(map(len, scenario.acquisition.run_nodes))
        # Runs may have different numbers of sensors: what one lacks another may have.
        if place > most:
            raise InputError(
                f"scenario {scenario.name}: effect {effect}",
                f"{choice}: no run has {place} sensors",
                f"There {'is sensor-1 alone' if most == 1 else f'are sensor-1 to sensor-{most}'}.",
            )
        return there[place - 1 : place]
    wanted = _dof(scenario, choice, effect, choices)
    if wanted not in {p.dof for p in by_node.values()}:
        known = ", ".join(str(p.dof) for p in list(by_node.values())[:30])
        raise InputError(
            f"scenario {scenario.name}: effect {effect}", f"nothing measures {choice}", f"There is {known}."
        )
    return tuple(p for p in there if p.dof == wanted)


def chosen_channels(scenario: Scenario, run: int, choice: str, effect: str) -> tuple[str, ...]:
    """What changes of channels call those of a run (counted from 0) that a choice means: a role, or labels of DOFs.

    ``choice`` is 'force', 'drive', 'all' or one of ``CHOICES``. InputError as in :func:`chosen_sensors`.
    """
    if choice in _ROLES:
        return (choice,)
    return tuple(str(p.dof) for p in chosen_sensors(scenario, run, choice, effect, CHANNELS))


def chosen_node(scenario: Scenario, node: int, effect: str) -> SensorPoint:
    """The accelerometer point of a node, or for 0 that of the first channel; InputError for an unknown node."""
    by_node = {p.dof.node: p for p in sensor_points(scenario)}
    chosen = node or scenario.acquisition.run_nodes[0][0]
    if chosen not in by_node:
        known = ", ".join(map(str, list(by_node)[:30]))
        raise InputError(f"scenario {scenario.name}: effect {effect}", f"there is no node {node}", f"There is {known}.")
    return by_node[chosen]


def _dof(scenario: Scenario, text: str, effect: str, choices: str) -> Dof:
    try:
        return Dof.from_label(text)
    except ValueError as error:
        where = f"scenario {scenario.name}: effect {effect}"
        raise InputError(where, f"{text!r} chooses no sensor", f"Write {choices}.") from error
