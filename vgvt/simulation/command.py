"""The command: what the generator sends to the amplifier, run by run, as a function of time."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.model import Scenario
from vgvt.scenario.rig import Excitation
from vgvt.scenario.streams import named_stream
from vgvt.signals import (
    burst_random,
    continuous_random,
    linear_chirp,
    logarithmic_chirp,
    multisine,
    stepped_sine,
)
from vgvt.simulation.assembly import Plan

_T = TypeVar("_T")


def sample_times_s(scenario: Scenario, steps_per_sample: int = 1) -> NDArray[np.float64]:
    """The sampling instants of a record, or the time steps between them, from 0 to the last sample inclusive."""
    rate = scenario.acquisition.sample_rate_hz
    samples = round(scenario.excitation.record_s * rate) + 1
    return np.arange((samples - 1) * steps_per_sample + 1) / (rate * steps_per_sample)


def drive_command(scenario: Scenario, run: int, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """The command of a run (counted from 0) in volts, shape of ``time_s``.

    One function of time whatever the instants: random kinds draw from the run's own named stream.
    """
    e = scenario.excitation
    return e.amplitude_v * _unit_command(e, time_s - e.lead_in_s, named_stream(scenario.seed, "excitation", run))


def sent_command(layout: Plan, run: int, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """The command as it reaches the amplifier in a run, effects included, shape of ``time_s``."""
    command = drive_command(layout.scenario, run, time_s)
    for action in layout.actions:
        command = command if action.command is None else action.command(command, time_s)
    return command


def excitation_in_words(e: Excitation) -> str:
    """What a campaign's notes say of its excitation."""
    details = {
        "points": f"{e.points} points",
        "blocks": f"{e.blocks} blocks",
        "lines": f"{e.lines} lines",
    }
    extra = "".join(f", {text}" for key, text in details.items() if getattr(e, key) is not None)
    return f"{e.kind} {e.start_hz:g} to {e.stop_hz:g} Hz in {e.duration_s:g} s{extra}"


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


def _known(value: _T | None) -> _T:
    """A key that the schema has made sure of."""
    assert value is not None, "Excitation refuses this kind without the key"
    return value
