"""What it takes to be an effect."""

from __future__ import annotations

from enum import StrEnum
from typing import ClassVar, Protocol, runtime_checkable

from vgvt.effects.action import Action
from vgvt.scenario.model import Scenario


class Family(StrEnum):
    """Where an effect acts."""

    SUSPENSION = "suspension"
    DRIVE_PATH = "drive path"
    MOUNT = "mount"
    SENSORS = "sensors"
    ACQUISITION = "acquisition"
    AIRFRAME = "airframe"
    NONLINEAR = "nonlinear"
    BETWEEN_RUNS = "between runs"


@runtime_checkable
class Effect(Protocol):
    """A departure from the ideal test: a frozen dataclass of physical parameters with one pure method.

    Class attributes: ``name`` as scenarios write it; ``summary`` in one sentence;
    ``family``; ``linear`` (superposition holds); ``signature`` it leaves in the data, in
    one sentence; ``confused_with`` names of effects that look alike; ``separating_test``
    that tells them apart; ``reference`` where the physics or the numbers come from.
    One that is measured by what others make of the scenario says its ``turn`` (:mod:`vgvt.effects.acting`).
    Parameters are made by :func:`vgvt.effects.parameter.parameter`.
    """

    name: ClassVar[str]
    summary: ClassVar[str]
    family: ClassVar[Family]
    linear: ClassVar[bool]
    signature: ClassVar[str]
    confused_with: ClassVar[tuple[str, ...]]
    separating_test: ClassVar[str]
    reference: ClassVar[str]

    def act(self, scenario: Scenario, run: int) -> Action:
        """What the effect does to a run (counted from 0) of a scenario; nothing at the neutral values."""
        ...
