"""One measured channel: what it measures, where, and in which unit."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum, StrEnum

from vgvt.data.dof import Dof


class Quantity(IntEnum):
    """What a channel measures; values are the specific data types of UFF dataset 58."""

    UNKNOWN = 0
    GENERAL = 1
    DISPLACEMENT = 8
    REACTION_FORCE = 9
    VELOCITY = 11
    ACCELERATION = 12
    EXCITATION_FORCE = 13

    @property
    def si_unit(self) -> str:
        """The SI unit that samples of this quantity are stored in ('V' for general)."""
        units = {8: "m", 9: "N", 11: "m/s", 12: "m/s^2", 13: "N", 1: "V", 0: ""}
        return units[self.value]


class ChannelRole(StrEnum):
    """The part a channel plays in a test."""

    RESPONSE = "response"
    REFERENCE = "reference"
    DRIVE = "drive"


@dataclass(frozen=True, slots=True)
class Channel:
    """A channel of a record; samples are in ``unit`` (SI), already divided by the sensitivity.

    ``sensitivity_v_per_unit`` and ``range_v`` say how the volts at the
    converter were scaled, so that clipping can be judged afterwards.
    """

    name: str
    quantity: Quantity
    role: ChannelRole
    dof: Dof | None = None
    unit: str = ""
    sensitivity_v_per_unit: float = 1.0
    range_v: float = float("inf")

    def __post_init__(self) -> None:
        if not self.unit:
            object.__setattr__(self, "unit", self.quantity.si_unit)
        if self.role is not ChannelRole.DRIVE and self.dof is None:
            raise ValueError(f"channel {self.name!r}: a {self.role.value} needs a degree of freedom, like 12+Z")

    def __repr__(self) -> str:
        where = "" if self.dof is None else f" at {self.dof}"
        measures = self.quantity.name.lower().replace("_", " ")
        return f"<Channel {self.name}: {self.role.value}, {measures}{where}{f' in {self.unit}' if self.unit else ''}>"
