"""The command: what the generator sends to the amplifier, run by run, as a function of time."""

from __future__ import annotations

import json
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.generator import Generator
from vgvt.scenario.model import Scenario
from vgvt.scenario.rig import RANDOM_KINDS, UNRECORDED_NOTE, Excitation
from vgvt.scenario.streams import named_stream
from vgvt.signals import (
    DwellSchedule,
    ImpactWindows,
    Periods,
    burst_random,
    continuous_random,
    impact_train,
    linear_chirp,
    logarithmic_chirp,
    multisine,
    stepped_sine,
)
from vgvt.simulation.assembly import Plan

_T = TypeVar("_T")
# Of the highest frequency, where a peak is looked for: it is seen to 0.2 %.
_INSTANTS_PER_PERIOD = 50.0


def sample_times_s(scenario: Scenario) -> NDArray[np.float64]:
    """The times from rest to a record's last sample inclusive; the first :func:`unrecorded_samples` are not its own.

    A periodic record in steady state ends one sample before the next period begins: that one would be there twice.
    """
    e, rate = scenario.excitation, scenario.acquisition.sample_rate_hz
    steady = e.kind == "multisine" and e.before_record_s > 0 and e.ring_down_s == 0
    return np.arange(round(e.whole_s * rate) + (not steady)) / rate


def unrecorded_samples(scenario: Scenario) -> int:
    """How many samples the shaker has run for when the record begins."""
    return scenario.unrecorded_samples


def drive_command(scenario: Scenario, run: int, time_s: NDArray[np.float64], shaker: int = 0) -> NDArray[np.float64]:
    """The command to a shaker (counted from 0) in a run (from 0) in volts, shape of ``time_s``.

    One function of time whatever the instants: random kinds draw from named streams of their own.
    Several shakers get signals that can be told apart, as ``excitation.shakers`` says: independent
    ones, or one with the signs of a Hadamard matrix from repeat to repeat (Dobrowiecki, Schoukens
    and Guillaume, IEEE Trans. Instrum. Meas. 55(5), 2006), or one shaker at a time.
    """
    e, count = scenario.excitation, len(scenario.shakers)
    name: tuple[str | int, ...] = ("excitation", run) if shaker == 0 else ("excitation", run, "shaker", shaker)
    sign = 1.0
    if count > 1 and e.shaker_signals == "sequential":
        sign = float(run % count == shaker)
    elif count > 1 and e.shaker_signals == "orthogonal":
        # One signal for a round of repeats; entry (row, column) of the matrix is the parity of their common bits.
        name = ("excitation", run - run % count)
        sign = -1.0 if (run % count & shaker).bit_count() % 2 else 1.0
    amplitude_v = scenario.acquisition.level_in(run) * e.amplitude_v
    asked = sign * amplitude_v * _unit_command(e, time_s - e.lead_in_s, named_stream(scenario.seed, *name))
    return _generated(scenario.generator, asked)


def _generated(generator: Generator, command_v: NDArray[np.float64]) -> NDArray[np.float64]:
    """What a generator makes of a command, volts: its steps, and no more than its range."""
    if generator.range_v is None:
        return command_v
    if generator.bits is not None:
        step_v = 2 * generator.range_v / 2**generator.bits
        command_v = np.round(command_v / step_v) * step_v
    return np.clip(command_v, -generator.range_v, generator.range_v)


def limited_drives(scenario: Scenario, run: int) -> tuple[int, ...]:
    """The shakers (counted from 0) whose command of a run (from 0) the generator cuts off at its range."""
    e, range_v = scenario.excitation, scenario.generator.range_v
    peak_v = scenario.acquisition.level_in(run) * e.amplitude_v
    if range_v is None or e.kind == "impact" or (e.kind not in RANDOM_KINDS and peak_v <= range_v):
        return ()
    times = _dense_times_s(scenario)
    recorded = times[times >= e.before_record_s]
    peaks = np.abs(drive_commands(_ungenerated(scenario), run, recorded)).max(axis=1)
    return tuple(int(k) for k in np.flatnonzero(peaks > range_v))


def hammer_force(scenario: Scenario, run: int, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """The force of the hammer on the aircraft in a run (counted from 0), N, shape of ``time_s``."""
    e, hammer = scenario.excitation, _known(scenario.hammer)
    blocks = _known(e.blocks)
    return (
        scenario.acquisition.level_in(run)
        * hammer.peak_force_n
        * impact_train(
            time_s - e.lead_in_s,
            named_stream(scenario.seed, "hammer", run),
            blocks,
            e.duration_s / blocks,
            hammer.first_hit_s,
            hammer.contact_s,
            hammer.strength_scatter,
            hammer.timing_scatter_s,
            hammer.double_hit_probability,
            hammer.double_hit_interval_s,
        )
    )


def drive_commands(scenario: Scenario, run: int, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """The commands to all shakers, volts, (shakers, times); none with a hammer."""
    if scenario.excitation.kind == "impact":
        return np.empty((0, time_s.size))
    return np.array([drive_command(scenario, run, time_s, k) for k in range(len(scenario.shakers))])


def peak_command_v(scenario: Scenario, runs: int | None = None) -> float:
    """The largest that is asked of the generator in the first ``runs`` runs (default: all), V; 0 under a hammer.

    That is the amplitude of a sine, in the loudest run; noise and multisines, whose amplitude is a root mean square,
    go beyond it, and may beyond what the generator gives.
    """
    e = scenario.excitation
    if e.kind == "impact":
        return 0.0
    if e.kind not in RANDOM_KINDS:
        return e.amplitude_v * scenario.acquisition.loudest
    times = _dense_times_s(scenario)
    count = len(scenario.acquisition.run_nodes) if runs is None else runs
    asked = _ungenerated(scenario)
    return max(float(np.abs(drive_commands(asked, run, times)).max()) for run in range(count))


def _ungenerated(scenario: Scenario) -> Scenario:
    """The same with a generator that has neither an end nor steps: its commands are what is asked for."""
    return scenario.model_copy(update={"generator": Generator()})


def _dense_times_s(scenario: Scenario) -> NDArray[np.float64]:
    """Instants from rest to a record's end among which no peak of the command is missed."""
    e = scenario.excitation
    rate_hz = max(scenario.acquisition.sample_rate_hz, _INSTANTS_PER_PERIOD * e.band_hz[1])
    return np.arange(round(e.whole_s * rate_hz) + 1) / rate_hz


def sent_commands(layout: Plan, run: int, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """What drives the rig in a run, (inputs, times): volts at the amplifiers, effects included, or a hammer's force."""
    if layout.strike is not None:
        return hammer_force(layout.scenario, run, time_s)[None]
    commands = drive_commands(layout.scenario, run, time_s)
    for change in (action.command for action in layout.actions if action.command is not None):
        commands = np.array([change(command, time_s) for command in commands])
    return commands


def excitation_in_words(scenario: Scenario) -> str:
    """What a campaign's notes say of its excitation."""
    e, levels = scenario.excitation, scenario.acquisition.levels or (1.0,)
    details = {
        "points": f"{e.points} points",
        "blocks": f"{e.blocks} {'hits' if e.kind == 'impact' else 'blocks'}",
        "lines": f"{e.lines} lines",
    }
    extra = "".join(f", {text}" for key, text in details.items() if getattr(e, key) is not None)
    late = f", the first {e.before_record_s:g} s not recorded" if e.before_record_s else ""
    told = f", at {min(levels):g} to {max(levels):g} times the amplitude" if min(levels) < max(levels) else ""
    return f"{e.kind} {e.start_hz:g} to {e.stop_hz:g} Hz in {e.duration_s:g} s{extra}{late}{told}"


def excitation_notes(scenario: Scenario) -> dict[str, str]:
    """What an estimator needs to know of the excitation: when it dwelt where, or how to cut it at its hits."""
    e, hammer = scenario.excitation, scenario.hammer
    if e.kind == "impact" and hammer is not None:
        free_s = e.duration_s / _known(e.blocks) - 2 * hammer.timing_scatter_s - hammer.first_hit_s
        before_s = 0.5 * hammer.first_hit_s - 0.5 * hammer.timing_scatter_s
        gate_s = before_s + 3 * hammer.contact_s
        return {"impacts": ImpactWindows(round(free_s, 6), round(before_s, 6), round(gate_s, 6)).note()}
    if e.kind == "burst-random":
        # Each block starts and ends at rest, after the lead-in: whole blocks need no window.
        return {"blocks": json.dumps({"block_s": e.duration_s / _known(e.blocks), "lead_in_s": e.lead_in_s})}
    late = {UNRECORDED_NOTE: f"{e.before_record_s:g}"} if e.before_record_s > 0 else {}
    if e.kind == "multisine":
        begin_s = max(0.0, e.lead_in_s + e.taper_s - e.before_record_s)
        end_s = e.lead_in_s + e.duration_s - e.taper_s - e.before_record_s
        if end_s <= begin_s:
            return late  # it fades as long as it is recorded
        return late | {"periods": Periods(e.duration_s / _known(e.blocks), begin_s, end_s, _known(e.lines)).note()}
    if e.kind != "stepped-sine":
        return late
    points = _known(e.points)
    dwells = DwellSchedule(e.start_hz, e.stop_hz, points, e.duration_s / points, _known(e.settle_s), e.lead_in_s)
    return {"dwells": dwells.note()}


def _unit_command(e: Excitation, time_s: NDArray[np.float64], stream: np.random.Generator) -> NDArray[np.float64]:
    """The excitation at amplitude 1 (peak of a sine, root mean square of noise and multisine)."""
    sweep = (e.start_hz, e.stop_hz, e.duration_s)
    band = (*e.band_hz, e.duration_s)
    match e.kind:
        case "linear-chirp":
            return linear_chirp(time_s, *sweep, e.taper_s)
        case "logarithmic-chirp":
            return logarithmic_chirp(time_s, *sweep, e.taper_s)
        case "stepped-sine":
            return stepped_sine(time_s, *sweep, _known(e.points), e.taper_s)
        case "random":
            return continuous_random(time_s, stream, *band, e.taper_s)
        case "burst-random":
            return burst_random(time_s, stream, *band, _known(e.blocks), _known(e.burst_fraction), e.taper_s)
        case "multisine":
            optimised = e.crest_iterations or 0
            return multisine(time_s, stream, *band, _known(e.blocks), _known(e.lines), optimised, e.taper_s)
        case "impact":
            raise ValueError("a hammer takes no command")


def _known(value: _T | None) -> _T:
    """A key that the schema has made sure of."""
    assert value is not None, "Excitation refuses this kind without the key"
    return value
