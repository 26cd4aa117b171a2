"""What effects do to the channels of a record: linear filters and changes in the time domain."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

from vgvt.data import Channel, ChannelRole, InputError
from vgvt.effects.action import ChannelFilter, ChannelTransform, Stage
from vgvt.scenario.model import Scenario
from vgvt.scenario.streams import named_stream
from vgvt.simulation.assembly import Plan

Array = NDArray[np.float64]
# After so many time constants e to minus that is left of what a filter remembers: 1e-13.
_TIME_CONSTANTS = 30.0
# Samples of silence at most, an hour at 1 kHz: what remembers longer wraps only the record's share of that around.
_LONGEST = 2**22


def changed_by_effects(layout: Plan, channel: Channel, run: int, stage: Stage, samples: Array) -> Array:
    """The samples (N,) of a channel after every effect that acts on it at a stage, in the scenario's order."""
    scenario = layout.scenario
    rate_hz = scenario.acquisition.sample_rate_hz
    if stage == "converter":
        rate_hz /= math.prod(c.pace for c in _transforms(layout) if selects(c.channels, channel))
    for i, (stream, action) in enumerate(zip(_streams(scenario), layout.actions, strict=True)):
        for change in action.channels:
            if change.stage != stage or not selects(change.channels, channel):
                continue
            try:
                if isinstance(change, ChannelFilter):
                    samples = filtered(samples, scenario.acquisition.sample_rate_hz, change.response)
                else:
                    whose = () if change.together else (channel.name,)
                    generator = named_stream(scenario.seed, "effect", *stream, run, *whose)
                    samples = _finite(change.change(samples, rate_hz, generator))
            except FloatingPointError as error:
                raise InputError(
                    f"scenario {scenario.name}: effect[{i}] {stream[0]}",
                    f"what it makes of {channel.name} in run {run + 1} is not finite, first at {error}",
                    "Write parameters within their plausible ranges: `vgvt list effects` shows them.",
                ) from error
    return samples


def _transforms(layout: Plan) -> Iterator[ChannelTransform]:
    """The changes in time of all channels, by every effect."""
    for action in layout.actions:
        yield from (change for change in action.channels if isinstance(change, ChannelTransform))


def _finite(samples: Array) -> Array:
    """The samples (N,); FloatingPointError with the first that is no number."""
    bad = ~np.isfinite(samples)
    if bad.any():
        raise FloatingPointError(f"sample {int(bad.argmax())}")
    return samples


def _streams(scenario: Scenario) -> list[tuple[str, int]]:
    """What each effect's random streams are called by: its name and which of that name it is, wherever it stands."""
    names = [table.name for table in scenario.effect]
    return [(name, names[:i].count(name)) for i, name in enumerate(names)]


def selects(channels: str, channel: Channel) -> bool:
    """Whether a choice of channels ('force', 'drive', 'response', 'all' or a DOF label) holds a channel."""
    roles = {"force": ChannelRole.REFERENCE, "drive": ChannelRole.DRIVE, "response": ChannelRole.RESPONSE}
    if channels == "all":
        return True
    if channels in roles:
        return channel.role is roles[channels]
    return channel.role is ChannelRole.RESPONSE and str(channel.dof) == channels


def filtered(samples: Array, sample_rate_hz: float, response: Callable[[Array], NDArray[np.complex128]]) -> Array:
    """Samples (N,) through a linear response, with silence before and after so that nothing wraps around.

    It is twice as long as they are, or as a slow filter needs to come to rest. FloatingPointError with the first line
    at which the response is no number.
    """
    silence = 2 * samples.size
    while True:
        length = next_fast_len(samples.size + silence, real=True)
        lines_hz = np.asarray(np.fft.rfftfreq(length, 1 / sample_rate_hz), dtype=np.float64)
        factor = response(lines_hz)
        bad = ~np.isfinite(factor)
        if bad.any():
            raise FloatingPointError(f"{lines_hz[bad.argmax()]:g} Hz")
        silence = min(math.ceil(_TIME_CONSTANTS * _memory(factor, length)), _LONGEST)
        if samples.size + silence <= length:
            return np.asarray(irfft(rfft(samples, length) * factor, length)[: samples.size])


def _memory(factor: NDArray[np.complex128], length: int) -> float:
    """How many samples a filter remembers, from its values (length // 2 + 1,) at the lines of so many samples.

    The time constant of the slowest decay, or the delay, is the steepest slope over angular frequency, in parts of the
    largest value. Where lines are too far apart to follow a slope this is about a sixth of ``length``, or more.
    """
    largest = float(np.abs(factor).max())
    if largest == 0:  # nothing passes
        return 0.0
    return float(np.abs(np.diff(factor)).max()) / largest * length / (2 * np.pi)
