"""What effects do to the channels of a record: linear filters and changes in the time domain."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

from vgvt.data import Channel, ChannelRole
from vgvt.effects.action import ChannelFilter, Stage
from vgvt.scenario.streams import named_stream
from vgvt.simulation.assembly import Plan

Array = NDArray[np.float64]


def changed_by_effects(layout: Plan, channel: Channel, run: int, stage: Stage, samples: Array) -> Array:
    """The samples (N,) of a channel after every effect that acts on it at a stage, in the scenario's order."""
    scenario = layout.scenario
    for i, action in enumerate(layout.actions):
        for change in action.channels:
            if change.stage != stage or not selects(change.channels, channel):
                continue
            if isinstance(change, ChannelFilter):
                samples = filtered(samples, scenario.acquisition.sample_rate_hz, change.response)
            else:
                generator = named_stream(scenario.seed, "effect", i, run, channel.name)
                samples = change.change(samples, scenario.acquisition.sample_rate_hz, generator)
    return samples


def selects(channels: str, channel: Channel) -> bool:
    """Whether a choice of channels ('force', 'drive', 'response', 'all' or a DOF label) holds a channel."""
    roles = {"force": ChannelRole.REFERENCE, "drive": ChannelRole.DRIVE, "response": ChannelRole.RESPONSE}
    if channels == "all":
        return True
    if channels in roles:
        return channel.role is roles[channels]
    return channel.role is ChannelRole.RESPONSE and str(channel.dof) == channels


def filtered(samples: Array, sample_rate_hz: float, response: Callable[[Array], NDArray[np.complex128]]) -> Array:
    """Samples (N,) through a linear response, with silence before and after so that nothing wraps around."""
    length = next_fast_len(3 * samples.size, real=True)
    spectrum = rfft(samples, length) * response(
        np.asarray(np.fft.rfftfreq(length, 1 / sample_rate_hz), dtype=np.float64)
    )
    return np.asarray(irfft(spectrum, length)[: samples.size])
