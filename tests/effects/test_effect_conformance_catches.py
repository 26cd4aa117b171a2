"""The shipped suite catches effects that are not what they say: each of these breaks one promise."""

from __future__ import annotations

import dataclasses
from typing import Any, ClassVar

import pytest

from vgvt.effects import available_effects
from vgvt.effects.action import NOTHING, Action, ChannelFilter
from vgvt.effects.parameter import parameter
from vgvt.effects.point_error import PointError
from vgvt.effects.protocol import Family
from vgvt.scenario import Scenario
from vgvt.simulation.effect_conformance import changes_the_records, vanishes_at_its_neutral_values


@dataclasses.dataclass(frozen=True, slots=True)
class Broken:
    """What all of them say of themselves, and a gain that is as it should be."""

    name: ClassVar[str] = "broken"
    family: ClassVar[Family] = Family.SENSORS
    linear: ClassVar[bool] = True

    size: float = parameter("", 0.01, 0.1, "a gain", neutral=0.0)

    def act(self, scenario: Scenario, run: int) -> Action:
        del scenario, run
        return gain(self.size)


def gain(error: float) -> Action:
    """Every accelerometer reads too much by a share; nothing for none."""
    return NOTHING if error == 0 else Action(channels=(ChannelFilter("response", lambda f: 1 + error + 0j * f),))


class MovesASensor(Broken):
    """It moves one sensor, switched off as well as on."""

    def act(self, scenario: Scenario, run: int) -> Action:
        return Action(points=(PointError(1, shift_m=(0.1, 0.0, 0.0)),))


class WarmsUp(Broken):
    """It warms the hangar, switched off as well as on."""

    def act(self, scenario: Scenario, run: int) -> Action:
        return Action(warming_k=2.0)


@dataclasses.dataclass(frozen=True, slots=True)
class Idle(Broken):
    """Its second size does nothing."""

    other: float = parameter("", 0.01, 0.1, "a second gain that is forgotten", neutral=0.0)


@dataclasses.dataclass(frozen=True, slots=True)
class TwoGains(Idle):
    """Its second size is another gain."""

    def act(self, scenario: Scenario, run: int) -> Action:
        return gain((1 + self.size) * (1 + self.other) - 1)


@dataclasses.dataclass(frozen=True, slots=True)
class Together(Idle):
    """Its second size is nothing without the first: what that has, it multiplies."""

    def act(self, scenario: Scenario, run: int) -> Action:
        return gain(self.size * (1 + self.other))


def installed(monkeypatch: pytest.MonkeyPatch, effect: Any) -> type:
    """The effect, known to scenarios under its name."""
    known = available_effects() | {effect.name: effect}
    monkeypatch.setattr("vgvt.effects.registry.available_effects", lambda: known)
    return effect  # type: ignore[no-any-return]


def test_a_sensor_that_moves_at_the_neutral_values_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    vanishes_at_its_neutral_values(installed(monkeypatch, Broken))
    with pytest.raises(AssertionError, match="at neutral values run 1 changes by"):
        vanishes_at_its_neutral_values(installed(monkeypatch, MovesASensor))


def test_warmth_at_the_neutral_values_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(AssertionError, match="a thermometer beside the aircraft shows 2 K more"):
        vanishes_at_its_neutral_values(installed(monkeypatch, WarmsUp))


def test_every_size_must_show(monkeypatch: pytest.MonkeyPatch) -> None:
    """Alone, or beside the others where it acts on what these do."""
    for fine in (Broken, TwoGains, Together):
        changes_the_records(installed(monkeypatch, fine))
    with pytest.raises(AssertionError, match=r"other = 0\.1 changes nothing"):
        changes_the_records(installed(monkeypatch, Idle))
