"""The standard deviations that a scenario's whole campaign would have, without simulating it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data.mode_numbers import number_text
from vgvt.data.shown import counted, headed, in_columns
from vgvt.planning.driven_peaks import largest_of_a_sine
from vgvt.planning.system import System, run_information, systems_of
from vgvt.scenario.model import Scenario
from vgvt.scenario.rig import RANDOM_KINDS
from vgvt.simulation.fisher import mean_deviation
from vgvt.simulation.information import Seen

Array = NDArray[np.float64]
# Of Gaussian noise over its root mean square: one in 16 000 independent values goes beyond.
_NOISE_PEAK = 4.0
_NUMBERS = ("frequency Hz", "± Hz", "damping %", "± %", "moved by instruments %")


@dataclass(frozen=True, slots=True)
class ModePrediction:
    """How well a campaign would know one mode; deviations are infinite where it cannot see it."""

    label: str
    frequency_hz: float
    damping_ratio: float
    frequency_std_hz: float
    damping_ratio_std: float
    loading_percent: float

    def __repr__(self) -> str:
        hz, std_hz, ratio, std_ratio, moved = self.in_numbers()
        loading = f", moved by {moved} % by the instruments" if moved else ""
        return headed(f"ModePrediction {self.label}: {hz} ± {std_hz} Hz, damping {ratio} ± {std_ratio} %{loading}")

    def in_numbers(self) -> tuple[str, ...]:
        """Frequency in Hz, its deviation, damping in per cent, its deviation, and how far instruments move the mode."""
        hz, ratio, moved = self.frequency_hz, 100 * self.damping_ratio, self.loading_percent
        deviations = (self.frequency_std_hz, 100 * self.damping_ratio_std)
        std_hz, std_ratio = (f"{std:.2g}" if np.isfinite(std) else "unseen" for std in deviations)
        return f"{hz:.3f}", std_hz, f"{ratio:.2f}", std_ratio, number_text(moved, "{:+.2f}")

    @property
    def relative_damping_std(self) -> float:
        """Standard deviation of the damping ratio over the ratio."""
        return self.damping_ratio_std / self.damping_ratio

    def as_dict(self) -> dict[str, Any]:
        """The prediction with the keys of the JSON contract."""
        return {
            "label": self.label,
            "frequency_hz": self.frequency_hz,
            "frequency_std_hz": self.frequency_std_hz,
            "damping_ratio": self.damping_ratio,
            "damping_ratio_std": self.damping_ratio_std,
            "relative_damping_std": self.relative_damping_std,
            "loading_percent": self.loading_percent,
        }


@dataclass(frozen=True, slots=True, eq=False)
class Prediction:
    """All modes of the band, and the largest motion and force to expect: m/s², N and mm."""

    modes: tuple[ModePrediction, ...]
    peak_acceleration_m_per_s2: float
    peak_force_n: float
    peak_drive_mm: float

    def __repr__(self) -> str:
        peaks = f"{self.peak_force_n:.3g} N, {self.peak_acceleration_m_per_s2:.3g} m/s^2, {self.peak_drive_mm:.3g} mm"
        table = in_columns((*_NUMBERS, "name"), [(*m.in_numbers(), m.label) for m in self.modes], words=("name",))
        head = headed(f"Prediction: {counted(len(self.modes), 'mode')}; at most {peaks}")
        return "\n".join(filter(None, (head, table)))


def predict(scenario: Scenario) -> Prediction:
    """Expected deviations of the modes in the swept band, by Fisher information; one shaker, no simulation.

    A campaign's frequency and damping are the random-effects means over its runs, whose true poles
    differ a little: roving sensors weigh something.
    """
    systems = systems_of(scenario)
    return predicted(systems)


def predicted(systems: tuple[System, ...]) -> Prediction:
    """The prediction from the rigs of all runs."""
    first, band = systems[0], systems[0].layout.scenario.excitation.recorded_band_hz
    frequency = first.modes.natural_frequency_hz
    modes = np.flatnonzero((frequency >= band[0]) & (frequency <= band[1]))
    hz, ratio, std_hz, std_ratio = (np.full((len(systems), modes.size), np.nan) for _ in range(4))
    expected = np.zeros(3)
    for run, system in enumerate(systems):
        information, seen = run_information(system, run)
        found_hz, found_ratio = information.deviations()
        for k, mode in enumerate(modes):
            place = np.flatnonzero(seen.unknown == mode)
            std_hz[run, k] = found_hz[place[0]] if place.size else np.inf
            std_ratio[run, k] = found_ratio[place[0]] if place.size else np.inf
            hz[run, k], ratio[run, k] = system.modes.natural_frequency_hz[mode], system.modes.damping_ratio[mode]
        expected = np.maximum(expected, _expected(system, seen))
    return Prediction(
        tuple(
            ModePrediction(
                first.modes.labels[mode] if first.modes.labels else "",
                float(hz[:, k].mean()),
                float(ratio[:, k].mean()),
                mean_deviation(hz[:, k], std_hz[:, k]),
                mean_deviation(ratio[:, k], std_ratio[:, k]),
                _loading(first, int(mode), float(hz[:, k].mean())),
            )
            for k, mode in enumerate(modes)
        ),
        *(float(e) for e in expected),
    )


def _expected(system: System, seen: Seen) -> Array:
    """Largest acceleration of the sensors, force, and motion of the drive point in mm: of a sine, or of noise.

    The peaks of noise are Gaussian ones, of a multisine as well, whose command may be flatter but not its responses.
    """
    e, frequency = system.layout.scenario.excitation, seen.lines.frequency_hz
    if e.kind not in RANDOM_KINDS:
        return e.amplitude_v * largest_of_a_sine(system)
    force = np.abs(system.force_per_volt(frequency)) * e.amplitude_v
    drive = len(system.layout.grid)
    moved = 1000 * np.abs(seen.response[drive, 0]) * force / (2 * np.pi * frequency) ** 2
    accelerated = np.abs(seen.response[list(system.sensors), 0]) * force
    share = seen.lines.width_hz / seen.lines.width_hz.sum()
    return _NOISE_PEAK * np.sqrt([(g**2 @ share).max() for g in (accelerated, force, moved)])


def _loading(system: System, mode: int, frequency_hz: float) -> float:
    """How far the instruments move a mode, per cent, against the bare one of the same name; NaN without it."""
    label = system.modes.labels[mode] if system.modes.labels else ""
    if label not in system.bare.labels:
        return float("nan")
    bare = float(system.bare.natural_frequency_hz[system.bare.labels.index(label)])
    return 100 * (frequency_hz / bare - 1)
