"""A campaign: the runs of one ground vibration test and the geometry they were taken on."""

from __future__ import annotations

from dataclasses import dataclass, field

from vgvt.data.channel import ChannelRole
from vgvt.data.dof import Dof
from vgvt.data.geometry import Geometry
from vgvt.data.record import Record


@dataclass(frozen=True, slots=True, eq=False)
class Campaign:
    """What an engineer brings home from the lab.

    ``band_hz`` is the excited band. ``notes`` holds plain facts about the test
    (aircraft, excitation, date) as strings; nothing about the true modes.
    """

    name: str
    geometry: Geometry
    runs: tuple[Record, ...]
    band_hz: tuple[float, float]
    notes: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.runs:
            raise ValueError(f"campaign {self.name!r} has no runs")
        low, high = self.band_hz
        if not 0 <= low < high:
            raise ValueError(f"campaign {self.name!r}: band_hz must be 0 <= low < high, got {self.band_hz}")
        numbers = [r.run for r in self.runs]
        if len(set(numbers)) != len(numbers):
            raise ValueError(f"campaign {self.name!r}: run numbers must be unique, got {numbers}")
        missing = {c.dof.node for r in self.runs for c in r.channels if c.dof is not None} - set(self.geometry.nodes)
        if missing:
            raise ValueError(f"campaign {self.name!r}: channels at nodes without a position: {sorted(missing)}")

    @property
    def response_dofs(self) -> tuple[Dof, ...]:
        """Every response DOF once, in order of first appearance."""
        return self._dofs(ChannelRole.RESPONSE)

    @property
    def reference_dofs(self) -> tuple[Dof, ...]:
        """Every reference (force) DOF once, in order of first appearance."""
        return self._dofs(ChannelRole.REFERENCE)

    def _dofs(self, role: ChannelRole) -> tuple[Dof, ...]:
        seen = (c.dof for r in self.runs for c in r.channels if c.role is role and c.dof is not None)
        return tuple(dict.fromkeys(seen))
