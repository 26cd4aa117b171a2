"""What a search for plans is asked: what is free, the limits, the modes that count."""

from __future__ import annotations

import math
from dataclasses import dataclass

from vgvt.planning.budget import MOUNTS, Budget, Mount
from vgvt.scenario.model import Scenario

FREE = ("shaker", "sensors", "band", "sweep-time", "level", "mount")
"""What a search may change."""


@dataclass(frozen=True, slots=True, eq=False)
class Wish:
    """What is looked for; ``targets`` are labels and frequencies, Hz, in order, of the modes that count."""

    free: frozenset[str]
    budget: Budget
    points: int
    largest_peak_v: float
    largest_mac: float = 0.25
    targets: tuple[tuple[str, float], ...] = ()

    @property
    def mounts(self) -> tuple[Mount, ...]:
        """The mounts that may be tried, the scenario's own first."""
        return MOUNTS if "mount" in self.free else MOUNTS[:1]

    def run_count(self, scenario: Scenario) -> int:
        """How many runs a plan has: as many as the points need, or the scenario's own where sensors stay."""
        if "sensors" not in self.free:
            return len(scenario.acquisition.runs)
        return math.ceil(self.points / self.budget.sensors)

    def minutes_of(self, scenario: Scenario, mount: Mount) -> float:
        """What the scenario's sweeps and repeats take in as many runs as a plan has, setting up included."""
        return self.budget.minutes_of(scenario, mount, self.run_count(scenario))
