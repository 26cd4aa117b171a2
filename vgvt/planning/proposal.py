"""A plan for a test: a scenario to run, what it costs, and what it is expected to tell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vgvt.data.shown import counted, headed
from vgvt.planning.budget import AS_DESCRIBED, Budget, Mount
from vgvt.planning.pairing import named_alike, paired
from vgvt.planning.prediction import ModePrediction, Prediction, predict
from vgvt.scenario.full_scale import expected_overloads
from vgvt.scenario.model import Scenario
from vgvt.simulation.command import peak_command_v

RIGID = frozenset({"fore-aft swing", "sideways swing", "heave", "yaw", "pitch", "roll"})
_NEAR = 0.1  # of its frequency: so far a target may lie from where it was before the plan changed anything


@dataclass(frozen=True, slots=True, eq=False)
class Proposal:
    """One plan with its prediction; ``targets`` are the labels and frequencies of the modes that it is judged by."""

    name: str
    scenario: Scenario
    mount: Mount
    minutes: float
    prediction: Prediction
    targets: tuple[tuple[str, float], ...]

    def __repr__(self) -> str:
        return headed(f"Proposal {self.in_words}")

    @property
    def in_words(self) -> str:
        """What the plan takes, and how well it would know the damping of the worst mode."""
        x, y, z = self.scenario.shaker.position_m
        worst = self.worst_relative_damping_std if self.targets else np.inf
        known = f"std(ζ)/ζ of the worst mode {100 * worst:.2g} %" if np.isfinite(worst) else "not all modes are seen"
        acquisition = self.scenario.acquisition
        runs = counted(len(acquisition.runs), "run")
        runs += f", {acquisition.repeats} times each" if acquisition.repeats > 1 else ""
        return f"{self.name}: {self.minutes:.3g} min, {runs}, shaker at ({x:.3f}, {y:.3f}, {z:.3f}) m, {known}"

    @property
    def modes(self) -> tuple[ModePrediction, ...]:
        """The predictions of the target modes in order; infinite deviations for one that the plan does not sweep."""
        modes = self.prediction.modes
        alike = named_alike([label for label, _ in self.targets], [mode.label for mode in modes])
        pairs = paired([hz for _, hz in self.targets], [mode.frequency_hz for mode in modes], _NEAR, alike)
        return tuple(_missed(*target) if k is None else modes[k] for target, k in zip(self.targets, pairs, strict=True))

    @property
    def worst_relative_damping_std(self) -> float:
        """The criterion: std(ζ)/ζ of the worst target mode."""
        return max(mode.relative_damping_std for mode in self.modes)

    @property
    def overloads(self) -> tuple[str, ...]:
        """What its largest force, acceleration and command would drive beyond its full scale, in words."""
        expected, peak_v = self.prediction, peak_command_v(self.scenario)
        return expected_overloads(self.scenario, expected.peak_force_n, expected.peak_acceleration_m_per_s2, peak_v)

    def as_dict(self) -> dict[str, Any]:
        """The plan with the keys of the JSON contract."""
        scenario, e = self.scenario, self.scenario.excitation
        return {
            "name": self.name,
            "minutes": self.minutes,
            "shaker_m": list(scenario.shaker.position_m),
            "shaker_on": scenario.shaker.attached_to,
            "mount": self.mount.name,
            "runs": [list(run) for run in scenario.acquisition.runs],
            "repeats": scenario.acquisition.repeats,
            "excitation": {
                "kind": e.kind,
                "start_hz": e.start_hz,
                "stop_hz": e.stop_hz,
                "duration_s": e.duration_s,
                "amplitude_v": e.amplitude_v,
            },
            "worst_relative_damping_std": self.worst_relative_damping_std,
            "modes": [mode.as_dict() for mode in self.modes],
            "peak_force_n": self.prediction.peak_force_n,
            "peak_acceleration_m_per_s2": self.prediction.peak_acceleration_m_per_s2,
            "peak_drive_mm": self.prediction.peak_drive_mm,
            "overloads": list(self.overloads),
        }


def proposal(
    name: str,
    scenario: Scenario,
    budget: Budget,
    targets: tuple[tuple[str, float], ...],
    mount: Mount = AS_DESCRIBED,
    prediction: Prediction | None = None,
) -> Proposal:
    """A scenario as a plan, with its costs and its prediction, made unless it is given."""
    return Proposal(name, scenario, mount, budget.minutes_of(scenario, mount), prediction or predict(scenario), targets)


def _missed(label: str, frequency_hz: float) -> ModePrediction:
    return ModePrediction(label, frequency_hz, 0.01, np.inf, np.inf, np.nan)


def elastic(prediction: Prediction) -> tuple[tuple[str, float], ...]:
    """Labels and frequencies of the modes in the band that are no rigid-body motions."""
    return tuple((m.label, m.frequency_hz) for m in prediction.modes if m.label not in RIGID)
