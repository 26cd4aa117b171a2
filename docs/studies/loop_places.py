"""Where a truth sits, and whether a verdict says so: a point, a sensor, a wing, or the way of the force."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from vgvt.reconcile import Place, Verdict
from vgvt.reconcile.evidence.free_places import ON_BOTH_SIDES
from vgvt.scenario import Scenario

STATION_M = 0.30
AT_THE_DRIVE = ("mount-compliance", "stinger-moment", "transducer-mass")
"""What sits where the shaker pushes, and says so by no parameter of its own."""
_CHANNEL, _WING = re.compile(r"^(?:run \d+, )?(\d+)[+-]"), re.compile(r"wing-(left|right)")


@dataclass(frozen=True, slots=True)
class Where:
    """A place, by what is known of it: ``point_m`` (x, y), sensors' nodes, a wing, or ``force``: the way of it.

    What all responses share, a delay of theirs for instance, is the force's.
    """

    point_m: tuple[float, float] | None = None
    nodes: frozenset[int] = frozenset()
    side: str = ""
    force: bool = False

    @property
    def known(self) -> bool:
        """Whether anything is known of it."""
        return self != Where()

    def same(self, other: Where) -> bool:
        """Whether another place is this one: within 0.3 m, the same sensor, the same wing, or both the force's."""
        near = False
        if self.point_m is not None and other.point_m is not None:
            near = float(np.hypot(*np.subtract(self.point_m, other.point_m))) < STATION_M
        return (
            near or bool(self.nodes & other.nodes) or bool(self.side and self.side == other.side)
            or (self.force and other.force)
        )  # fmt: skip


NOWHERE = Where()
"""Of what is everywhere, or nothing is known of."""


def where(name: str, said: Mapping[str, Any], scenario: Scenario) -> Where:
    """Where an effect of the catalogue sits, by its settings and parameters; nothing known of what is everywhere."""
    if {"x_m", "y_m"} <= set(said):
        return Where((float(said["x_m"]), float(said["y_m"])))
    if name == "suspension-surge":
        return Where(scenario.suspension.hook_m[:2])
    if name in AT_THE_DRIVE:
        return Where(scenario.shaker.position_m[:2], force=True)
    nodes = frozenset(int(said[k]) for k in ("node", "other_node") if k in said)
    if nodes:
        return Where(nodes=nodes)
    channels = str(said.get("channels", ""))
    if channels in ("force", "response"):
        return Where(force=True)
    sensor = _CHANNEL.match(channels)
    return Where(nodes=frozenset((int(sensor[1]),))) if sensor else Where(side=str(said.get("side", "")))


def where_explained(place: Place) -> Where:
    """Where a free force, or factor on a channel, explains a residual."""
    if place.position_m is not None:
        wing = _WING.search(place.label)
        return Where(place.position_m[:2], side=wing[1] if wing else "")
    sensor = _CHANNEL.match(place.label)
    return Where(nodes=frozenset((int(sensor[1]),)) if sensor else frozenset(), force=place.label == "force channel")


def said_place(verdict: Verdict, scenario: Scenario) -> Where:
    """Where a verdict says that something is: what has no name, what it names first, or what explains most."""
    places = verdict.localisation.places if verdict.localisation else ()
    nameless = verdict.attribution.nameless
    # What stands beside a name, and instead of none, is told after it.
    if nameless is not None and nameless.instead_of:
        if nameless.where.point_m is not None:
            return Where(nameless.where.point_m)
        label = nameless.where.label.removesuffix(ON_BOTH_SIDES)
        return next((where_explained(p) for p in places if p.label == label), NOWHERE)
    for effect in verdict.effects[:1]:
        named = where(effect.name, {**effect.settings, **{k: v[0] for k, v in effect.parameters.items()}}, scenario)
        if named.known:
            return named
    return where_explained(places[0]) if places else NOWHERE
