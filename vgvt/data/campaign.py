"""A campaign: the runs of one ground vibration test and the geometry they were taken on."""

from __future__ import annotations

from dataclasses import dataclass, field

from vgvt.data.channel import ChannelRole
from vgvt.data.dof import Dof
from vgvt.data.geometry import Geometry
from vgvt.data.record import Record
from vgvt.data.shown import counted, headed, listed


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

    def __repr__(self) -> str:
        lengths, rates = {r.duration_s for r in self.runs}, {r.sample_rate_hz for r in self.runs}
        each = f"{_span(lengths)} s at {_span(rates)} Hz"
        force = f"force at {listed(self.reference_dofs)}" if self.reference_dofs else "no measured force"
        responses = counted(len(self.response_dofs), "response")
        clipped = [r.run for r in self.runs if r.overloaded]
        overloaded = f"; overloaded in run {listed(clipped)}" if clipped else ""
        return headed(
            f"Campaign {self.name}: {counted(len(self.runs), 'run')} of {each}, {responses}, {force}, "
            f"{self.band_hz[0]:g} to {self.band_hz[1]:g} Hz{overloaded}"
        )

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


def _span(values: set[float]) -> str:
    """One number, or the least and the largest of several."""
    low, high = f"{min(values):.4g}", f"{max(values):.4g}"
    return low if low == high else f"{low} to {high}"
