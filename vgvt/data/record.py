"""One run of a test: simultaneously sampled channels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data.channel import Channel, ChannelRole
from vgvt.data.shown import counted, headed, listed


@dataclass(frozen=True, slots=True, eq=False)
class Record:
    """The time histories of one run; ``samples`` has shape (channels, samples), in the channels' units.

    ``overloaded`` names channels that clipped; ``notes`` are free words for
    the report.
    """

    run: int
    sample_rate_hz: float
    channels: tuple[Channel, ...]
    samples: NDArray[np.floating]
    overloaded: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.samples.ndim != 2 or self.samples.shape[0] != len(self.channels):
            raise ValueError(f"run {self.run}: samples must be ({len(self.channels)}, N), got {self.samples.shape}")
        if self.samples.shape[1] == 0:
            raise ValueError(f"run {self.run}: the record has no samples")
        if not self.sample_rate_hz > 0:
            raise ValueError(f"run {self.run}: sample_rate_hz must be positive, got {self.sample_rate_hz}")

    def __repr__(self) -> str:
        clipped = f", overloaded: {listed(self.overloaded)}" if self.overloaded else ""
        length = f"{self.duration_s:.4g} s at {self.sample_rate_hz:g} Hz"
        return headed(f"Record of run {self.run}: {counted(len(self.channels), 'channel')}, {length}{clipped}")

    @property
    def duration_s(self) -> float:
        """Length of the record in seconds."""
        return float(self.samples.shape[1] / self.sample_rate_hz)

    @property
    def time_s(self) -> NDArray[np.float64]:
        """Time axis, shape (samples,)."""
        return np.arange(self.samples.shape[1]) / self.sample_rate_hz

    def select(self, role: ChannelRole) -> tuple[tuple[Channel, ...], NDArray[np.floating]]:
        """The channels of one role and their samples (k, N)."""
        index = [i for i, c in enumerate(self.channels) if c.role is role]
        return tuple(self.channels[i] for i in index), self.samples[index]
