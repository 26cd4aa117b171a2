"""Somebody else's effect, held to what an effect may give: what is wrong is said in its name, where it is given.

Handed on, a wrong word would act on nothing, a number that is none would fill a record with them, and a function that
fails would do so far away from whose it is.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator
from functools import cache, partial
from numbers import Real
from typing import Any, Literal, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from vgvt.data.plugin import PluginError, whose_fault
from vgvt.data.suggestion import choose_one_of
from vgvt.effects.action import Action, ChannelFilter, ChannelTransform, Stage
from vgvt.effects.elements import Element, MountCompliance, Relaxation
from vgvt.effects.point_error import PointError
from vgvt.scenario.mirror import expanded_beams
from vgvt.scenario.model import Scenario
from vgvt.scenario.points import sensor_points

_CHANGES = (ChannelFilter, ChannelTransform)
_ROLES = ("force", "drive", "response", "all")
_BODY = "body"
# Elements are told apart by these fields: where they are, and what cannot be less than nothing.
_PARTS, _MASSES = ("part", "other_part"), ("mass_kg", "frame_kg")
# What a mount divides by.
_OF_MOUNTS = ("stiffness_n_per_m", "tension_ratio")


def held_to_contract(effect: Any, action: Action, scenario: Scenario, run: int) -> Action:
    """The action with functions that say whose they are where they fail; ``scenario`` is what the effect was given.

    PluginError, which names the effect, the run (counted from 0) and what to write instead, for contents that no action
    may have.
    """
    title = f"effect {effect.name!r}"
    for problem in _problems(action, scenario):
        raise PluginError(f"{title} failed in act(run {run}): {problem}")

    def kept(function: Callable[..., Any], what: str, kind: type) -> Callable[..., Any]:
        return partial(_as_many, function, effect, title, f"{what} (run {run})", kind)

    channels: list[ChannelFilter | ChannelTransform] = []
    for change in action.channels:
        what = f"the {type(change).__name__} on {change.channels!r}"
        if isinstance(change, ChannelFilter):
            channels.append(dataclasses.replace(change, response=kept(change.response, what, complex)))
        else:
            channels.append(dataclasses.replace(change, change=kept(change.change, what, float)))
    command = None if action.command is None else kept(action.command, "the command", float)
    return dataclasses.replace(action, channels=tuple(channels), command=command)


def _as_many(
    function: Callable[..., Any], effect: Any, title: str, doing: str, kind: type, given: NDArray[Any], *others: Any
) -> NDArray[Any]:
    """What a function makes of an array (N,), which must be as many finite numbers."""
    with whose_fault(effect, title, doing):
        found = np.asarray(function(given, *others))
        if found.shape != given.shape or found.dtype.kind not in "biufc":
            what = f"an array of shape {found.shape}" if found.dtype.kind in "biufc" else f"{found.dtype}"
            raise TypeError(f"it gave {what} for {given.size} numbers: give one number for each")
        if kind is float and found.dtype.kind == "c":
            raise TypeError("it gave complex samples: give real ones")
        bad = ~np.isfinite(found)
        if bad.any():
            first = int(np.flatnonzero(bad)[0])
            at = f"at {given[first]:g} Hz" if kind is complex else f"at sample {first}"
            raise ValueError(f"{int(bad.sum())} of {found.size} values are not finite, the first {at}")
    return np.asarray(found, dtype=kind)


def _problems(action: Action, scenario: Scenario) -> Iterator[str]:
    """What is wrong with the contents of an action, in words, with what to write instead."""
    yield from _of_types(action)
    there = action.scenario or scenario
    for change in action.channels:
        yield from _of_channels(change, there)
    nodes = {p.dof.node for p in sensor_points(there)}
    for point in action.points:
        yield from _of_point(point, nodes, {s.node for s in there.shakers})
    built = {b.name for b in expanded_beams(there.airframe)}
    stated = {_BODY} | built | {b.name for b in there.airframe.beam}
    for element in action.elements:
        yield from _of_element(element, nodes, built, stated)
        yield from _of_what_moves(element, len(there.shakers))


def _of_types(action: Action) -> Iterator[str]:
    """Fields of an action that are of another kind than they must be: whatever else is asked rests on it."""
    for f, kind in (("elements", get_args(Element)), ("points", (PointError,)), ("channels", _CHANGES)):
        given = getattr(action, f)
        if not isinstance(given, tuple):
            yield f"Action.{f} is a {type(given).__name__}: give a tuple, (…,)"
        for one in given:
            if not isinstance(one, kind):
                yield f"Action.{f} holds a {type(one).__name__}: give {' or '.join(sorted(k.__name__ for k in kind))}"
    edited: object = action.scenario
    if not isinstance(edited, Scenario | None):
        yield f"Action.scenario is a {type(edited).__name__}: give scenario.model_copy(update=…), or None"
    command: object = action.command
    if not (command is None or callable(command)):
        yield f"Action.command is a {type(command).__name__}: give a function of (command_v, time_s), or None"
    if not _finite(action.warming_k):
        yield f"Action.warming_k is {action.warming_k!r}: give a finite number of kelvins"


def _of_point(point: PointError, nodes: set[int], shakers: set[int]) -> Iterator[str]:
    """What is wrong with where a sensor is said to be, among the sensors' ``nodes`` and the ``shakers``'."""
    if point.node not in nodes | shakers:
        yield f"PointError on node {point.node}: {choose_one_of(str(point.node), map(str, nodes))}"
    if point.at_node is not None and point.at_node not in nodes:
        yield f"PointError at node {point.at_node}: {choose_one_of(str(point.at_node), map(str, nodes))}"
    yield from _of_fields(point)


def _of_element(element: Element, nodes: set[int], built: set[str], stated: set[str]) -> Iterator[str]:
    """What is wrong with an element: its part among the ``stated``, its beam as ``built``, its node, its numbers."""
    what = type(element).__name__
    for f in (f for f in (*_PARTS, "beam") if hasattr(element, f)):
        known, own = built if f == "beam" else stated, getattr(element, f)
        if own not in known:
            yield f"{what}: there is no {f.replace('_', ' ')} {own!r}; {choose_one_of(str(own), known)}"
    node = getattr(element, "node", None)
    if node is not None and node not in nodes:
        yield f"{what} on node {node}: {choose_one_of(str(node), map(str, nodes))}"
    yield from _of_fields(element)
    for f in _MASSES:
        if getattr(element, f, 0.0) < 0:
            yield f"{what}.{f} is {getattr(element, f):g}: take mass from an item of the airframe"


def _of_what_moves(element: Element, shakers: int) -> Iterator[str]:
    """What is wrong with the exciter that an element is at, among the ``shakers``, and with the branches it has."""
    what = type(element).__name__
    exciter: object = getattr(element, "exciter", 0)
    known = isinstance(exciter, int | np.integer) and 0 <= exciter < shakers
    if hasattr(element, "exciter") and not known:
        there = "0" if shakers == 1 else f"0 to {shakers - 1}"
        yield f"{what}.exciter is {exciter!r}: give {there}, as the scenario has {shakers}, counted from 0"
    if isinstance(element, MountCompliance):
        for f in (f for f in _OF_MOUNTS if not getattr(element, f) > 0):
            yield f"{what}.{f} is {getattr(element, f):g}: give a positive number, or no mount"
    if isinstance(element, Relaxation):
        yield from _of_branches(element.branches)


def _of_branches(branches: object) -> Iterator[str]:
    """What is wrong with Maxwell branches: each is a spring by its share and a corner, and neither can be nothing."""
    if not isinstance(branches, tuple):
        yield f"Relaxation.branches is {branches!r}: give a tuple of pairs, ((share, corner), …)"
        return
    for branch in branches:
        if not (isinstance(branch, tuple) and len(branch) == 2 and all(_finite(v) and v > 0 for v in branch)):
            yield f"Relaxation.branches holds {branch!r}: give (share, corner), two positive numbers, or no such branch"


def _of_channels(change: ChannelFilter | ChannelTransform, scenario: Scenario) -> Iterator[str]:
    """What is wrong with where a change of channels acts: it would act on nothing."""
    what, stages = type(change).__name__, get_args(Stage)
    if change.stage not in stages:
        yield f"{what} at stage {change.stage!r}: {choose_one_of(str(change.stage), stages)}"
    if not callable(change.response if isinstance(change, ChannelFilter) else change.change):
        yield f"{what} holds no function"
    if isinstance(change, ChannelTransform) and not (_finite(change.pace) and change.pace > 0):
        yield f"{what}.pace is {change.pace!r}: give a positive number, 1.0 for samples that are as far apart as stated"
    if change.channels in _ROLES:
        return
    labels = [str(p.dof) for p in sensor_points(scenario)]
    if change.channels not in labels:
        yield f"{what} on {change.channels!r}: write {', '.join(map(repr, _ROLES))}, or a DOF that is measured like " \
              f"{labels[0]!r}"  # fmt: skip


def _of_fields(thing: object) -> Iterator[str]:
    """Fields of an element or a point error that are no finite number, no three of them, or no word that there is."""
    for name, kind, words in _kinds(type(thing)):  # type: ignore[arg-type]
        value = getattr(thing, name)
        what = f"{type(thing).__name__}.{name} is {value!r}"
        if kind is float and not _finite(value):
            yield f"{what}: give a finite number"
        is_vector = isinstance(value, tuple) and len(value) == 3 and all(map(_finite, value))
        if kind is tuple and not is_vector:
            yield f"{what}: give a tuple of three finite numbers"
        if words and value not in words:
            yield f"{what}: {choose_one_of(str(value), words)}"


@cache
def _kinds(cls: type) -> tuple[tuple[str, type, tuple[str, ...]], ...]:
    """Fields of a class: name, number or three of them, and the words that it may be."""
    found: list[tuple[str, type, tuple[str, ...]]] = []
    for name, hint in get_type_hints(cls).items():
        words = get_args(hint) if get_origin(hint) is Literal else ()
        kind = float if hint is float else tuple if hint == tuple[float, float, float] else object
        found.append((name, kind, words))
    return tuple(found)


def _finite(value: object) -> bool:
    return isinstance(value, Real) and math.isfinite(value)
