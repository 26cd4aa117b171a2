"""The right-hand panel of an effect's picture: the quantity in which that effect shows best."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data import ModalModel, Record
from vgvt.effects import available_effects
from vgvt.scenario import Scenario
from vgvt.simulation.campaign import SimulationResult

CLEAN, SPOILED, OTHER, THIRD = "0.65", "tab:red", "tab:blue", "tab:green"
Complex = NDArray[np.complex128]
Array = NDArray[np.float64]
COMMAND, FORCE, FIRST = 0, 1, 2
"""Rows of a record: the command, the force, then the accelerometers."""


@dataclass(frozen=True, eq=False)
class Pair:
    """One scenario simulated with its effects and without, and perhaps quieter."""

    scenario: Scenario
    spoiled: SimulationResult
    clean: SimulationResult
    quieter: tuple[SimulationResult, ...] = ()

    def accelerance(self) -> tuple[Array, Complex, Complex]:
        """Frequency (lines,), and A/F (sensors, lines) of the last run in the swept band, without and with."""
        f, clean = ratio(self.clean.campaign.runs[-1], FORCE, self.scenario)
        return f, clean, ratio(self.spoiled.campaign.runs[-1], FORCE, self.scenario)[1]

    def sensor_name(self, sensor: int) -> str:
        """The DOF of an accelerometer."""
        return str(self.clean.campaign.runs[0].channels[FIRST + sensor].dof)


def spectra(record: Record) -> tuple[Array, Complex]:
    """Frequency (lines,), and amplitude spectra (channels, lines) of the whole record."""
    frequency = np.fft.rfftfreq(record.samples.shape[1], 1 / record.sample_rate_hz)
    return frequency, np.fft.rfft(record.samples, axis=1) * 2 / record.samples.shape[1]


def ratio(record: Record, reference: int, scenario: Scenario) -> tuple[Array, Complex]:
    """Accelerations over a reference channel (sensors, lines), inside the swept band."""
    frequency, spectrum = spectra(record)
    low, high = scenario.excitation.band_hz
    inside = (frequency >= low + 0.5) & (frequency <= min(high, 60.0) - 1.0)
    return frequency[inside], spectrum[FIRST:, inside] / spectrum[reference, inside]


@dataclass(frozen=True)
class Panel:
    """A kind of panel, what it shows in words, and further levels (shares of the command) that it needs."""

    draw: Callable[[Any, Pair, int], None]
    says: str
    quieter: tuple[float, ...] = ()


def draw_panel(axes: Any, panel: Panel, pair: Pair, sensor: int) -> None:
    """Draw one panel with its title."""
    panel.draw(axes, pair, sensor)
    if not axes.get_title():
        axes.set_title(panel.says)


def _turn(axes: Any, pair: Pair, sensor: int) -> None:
    frequency, clean, spoiled = pair.accelerance()
    for k in range(clean.shape[0]):
        colour = SPOILED if k == sensor else CLEAN
        # Cut at -90 degrees, not at 180: half a turn is a case to show.
        turn = (np.degrees(np.angle(spoiled[k] / clean[k])) + 90.0) % 360.0 - 90.0
        axes.plot(frequency, turn, color=colour, zorder=3 if k == sensor else 2)
    axes.set(xlabel="frequency in Hz")


def _share(axes: Any, pair: Pair, sensor: int) -> None:
    frequency, clean, spoiled = pair.accelerance()
    for k in range(clean.shape[0]):
        colour = SPOILED if k == sensor else CLEAN
        change = 100 * np.abs(spoiled[k] / clean[k] - 1)
        axes.semilogy(frequency, change, color=colour, zorder=3 if k == sensor else 2)
    axes.set(xlabel="frequency in Hz")
    top = axes.get_ylim()[1]
    axes.set_ylim(bottom=max(axes.get_ylim()[0], 1e-5 * top))


def _command(axes: Any, pair: Pair, sensor: int) -> None:
    for result, colour, width in ((pair.clean, CLEAN, 1.6), (pair.spoiled, SPOILED, 0.9)):
        frequency, values = ratio(result.campaign.runs[0], COMMAND, pair.scenario)
        axes.semilogy(frequency, np.abs(values[sensor]), color=colour, linewidth=width)
    axes.set(xlabel="frequency in Hz")


def _force(axes: Any, pair: Pair, sensor: int) -> None:
    del sensor
    _wide(axes, pair, FORCE)


def _response(axes: Any, pair: Pair, sensor: int) -> None:
    _wide(axes, pair, FIRST + sensor)


def _wide(axes: Any, pair: Pair, channel: int) -> None:
    for result, colour, width in ((pair.clean, CLEAN, 1.6), (pair.spoiled, SPOILED, 0.7)):
        frequency, values = spectra(result.campaign.runs[0])
        axes.semilogy(frequency[1:], np.abs(values[channel, 1:]), color=colour, linewidth=width)
    top = axes.get_ylim()[1]
    axes.set(xlabel="frequency in Hz", ylim=(1e-8 * top, top), xlim=(0, frequency[-1]))


def _record(axes: Any, pair: Pair, sensor: int) -> None:
    runs = [result.campaign.runs[0] for result in (pair.clean, pair.spoiled)]
    difference = np.abs(runs[1].samples[FIRST + sensor] - runs[0].samples[FIRST + sensor])
    middle, half = int(np.argmax(difference)), round(0.12 * runs[0].sample_rate_hz)
    start = max(middle - half, 0)
    for record, colour, width in zip(runs, (CLEAN, SPOILED), (1.8, 0.9), strict=True):
        values = record.samples[FIRST + sensor, start : start + 2 * half]
        axes.plot((start + np.arange(values.size)) / record.sample_rate_hz, values, color=colour, linewidth=width)
    axes.set(xlabel="time in s")


def _runs(axes: Any, pair: Pair, sensor: int) -> None:
    """Around the first elastic resonance, so that a small shift is seen: first and last run."""
    runs = pair.spoiled.campaign.runs
    first, last = (ratio(run, FORCE, pair.scenario) for run in (runs[0], runs[-1]))
    peak = first[0][int(np.argmax(np.abs(first[1][sensor]) * (first[0] < 12)))]
    near = np.abs(first[0] - peak) < 1.0
    axes.semilogy(first[0][near], np.abs(first[1][sensor][near]), color=OTHER, label="with, first run")
    axes.semilogy(last[0][near], np.abs(last[1][sensor][near]), color=SPOILED, label="with, last run")
    axes.set(xlabel="frequency in Hz")
    _legend_beside(axes)


def _command_runs(axes: Any, pair: Pair, sensor: int) -> None:
    runs = pair.spoiled.campaign.runs
    for run, colour, label in ((runs[0], OTHER, "with, first run"), (runs[-1], SPOILED, "with, last run")):
        frequency, values = ratio(run, COMMAND, pair.scenario)
        axes.semilogy(frequency, np.abs(values[sensor]), color=colour, label=label)
    axes.set(xlabel="frequency in Hz")
    _legend_beside(axes)


def _levels(axes: Any, pair: Pair, sensor: int) -> None:
    """Around the resonance that the level changes most."""
    results = (*pair.quieter, pair.spoiled)
    curves = [ratio(result.campaign.runs[0], FORCE, pair.scenario) for result in results]
    frequency, quiet, loud = curves[0][0], np.abs(curves[0][1][sensor]), np.abs(curves[-1][1][sensor])
    peak = frequency[int(np.argmax(np.abs(loud - quiet)))]
    near = np.abs(frequency - peak) < max(1.5, 0.12 * peak)
    for result, (_, values), colour in zip(results, curves, (THIRD, OTHER, SPOILED)[-len(results) :], strict=True):
        label = f"{np.abs(result.campaign.runs[0].samples[COMMAND]).max():.2g} V"
        axes.semilogy(frequency[near], np.abs(values[sensor][near]), color=colour, label=label)
    axes.set(xlabel="frequency in Hz")
    _legend_beside(axes)


def _modes(axes: Any, pair: Pair, sensor: int) -> None:
    """Change of every true mode that keeps its name, in per cent: frequency and damping ratio."""
    del sensor
    clean, spoiled = (_in_sight(r.truth.as_tested[-1]) for r in (pair.clean, pair.spoiled))
    pairs = [(i, spoiled.labels.index(name)) for i, name in enumerate(clean.labels) if name in spoiled.labels]
    place = np.arange(len(pairs))
    for values, others, colour, marker, label in (
        (clean.natural_frequency_hz, spoiled.natural_frequency_hz, SPOILED, "o", "frequency"),
        (clean.damping_ratio, spoiled.damping_ratio, OTHER, "x", "damping"),
    ):
        change = [100 * (others[j] / values[i] - 1) for i, j in pairs]
        axes.plot(place, change, marker, color=colour, markersize=4, label=label)
    axes.axhline(0.0, color="0.5", linewidth=0.6)
    axes.set_yscale("symlog", linthresh=0.1)
    low, high = axes.get_ylim()
    # Room beyond the outermost points, and never so little that round-off looks like a change.
    axes.set_ylim(min(3 * low, -0.3), max(3 * high, 0.3))
    axes.set_xticks(place, [f"{clean.natural_frequency_hz[i]:.2g}" for i, _ in pairs])
    axes.set(xlabel="true mode by its frequency in Hz")
    _legend_beside(axes)


def _legend_beside(axes: Any) -> None:
    """Outside: there is always something that a box within would hide."""
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, handlelength=1.2)


def _in_sight(modes: ModalModel) -> ModalModel:
    return modes.band(0.1, 60.0)


TURN = Panel(_turn, "change of the phase of A/F in degrees, all sensors")
SHARE = Panel(_share, "relative change of A/F in per cent, all sensors")
PER_COMMAND = Panel(_command, "response per command, |A/V|")
FORCE_SPECTRUM = Panel(_force, "spectrum of the force in N, beyond the sweep too")
RESPONSE_SPECTRUM = Panel(_response, "spectrum of the response, beyond the sweep too")
RECORD = Panel(_record, "the record itself, in m/s²")
RUNS = Panel(_runs, "|A/F| in the first and the last run, near the first resonance")
COMMAND_RUNS = Panel(_command_runs, "response per command, |A/V|, in the first and the last run")
LEVELS = Panel(_levels, "|A/F| at three levels, where they differ most", (0.02, 0.2))
MODES = Panel(_modes, "change of the true modes in per cent")

_KINDS = {
    TURN: "anti-alias-delay channel-delay clock-skew high-pass-mismatch sign-flip swapped-sensors loose-sensor-mount "
    "nonproportional-damper",
    SHARE: "base-strain drive-point-offset lateral-force transducer-mass channel-gain sensor-tilt drive-remount "
    "sensor-position-error transverse-sensitivity suspension-surge local-absorber bend-twist-coupling warm-up",
    PER_COMMAND: "mount-compliance stinger-compliance",
    FORCE_SPECTRUM: "force-distortion shaker-backlash",
    RESPONSE_SPECTRUM: "clipping-range aliased-interference mains-hum quantisation mount-lift-off rattling-mass "
    "cubic-root-stiffness",
    RECORD: "dropped-samples",
    RUNS: "payload-change run-drift root-creep temperature-change gain-drift",
    COMMAND_RUNS: "mount-creep",
}
_PANELS = {name: panel for panel, names in _KINDS.items() for name in names.split()}


def panel_of(effect: str) -> Panel:
    """The panel of an effect: where one is known to show most, else levels if nonlinear, else the true modes."""
    return _PANELS.get(effect) or (MODES if available_effects()[effect].linear else LEVELS)
