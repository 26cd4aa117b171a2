"""Which channels and runs have no part in any fit, fixed by the scenario's seed before the first one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data.shown import counted
from vgvt.reconcile.question.data import Measured
from vgvt.scenario.model import Scenario
from vgvt.scenario.streams import named_stream

_RUN_SHARE, _CHANNEL_SHARE = 0.2, 0.15
_FEWEST_RUNS, _FEWEST_CHANNELS = 4, 4


@dataclass(frozen=True, slots=True, eq=False)
class Split:
    """Masks over the channels of a campaign, (C,): to fit, held out with their whole run, held out alone.

    ``turn`` counts the draws before it: one after the first is chosen by what the first has shown.
    """

    train: NDArray[np.bool_]
    held_runs: NDArray[np.bool_]
    held_channels: NDArray[np.bool_]
    turn: int = 0

    def __repr__(self) -> str:
        runs, alone = int(self.held_runs.sum()), int(self.held_channels.sum())
        return f"<Split: {counted(int(self.train.sum()), 'channel')} to fit, {runs} held out by run, {alone} alone>"

    @property
    def held(self) -> NDArray[np.bool_]:
        """Everything that no fit may see, (C,)."""
        return self.held_runs | self.held_channels


def split(scenario: Scenario, measured: Measured, turn: int = 0) -> Split:
    """Hold out a fifth of the runs (from four on) and about a seventh of the other channels.

    It depends on the scenario's seed and the campaign's labels alone, not on a single sample; each ``turn`` is
    another draw. Every run that is not held out keeps a channel to fit; a campaign too small for either keeps
    everything. A channel that could not be used is in neither part; a run of such channels is no run to hold out.
    """
    stream = named_stream(scenario.seed, "hold-out", *([turn] if turn else []))
    run = np.array([c.run for c in measured.channels])
    count = len(measured.channels)
    runs = np.unique(run[measured.used])
    held_runs = np.zeros(count, dtype=bool)
    if runs.size >= _FEWEST_RUNS:
        chosen = stream.permutation(runs)[: max(1, round(_RUN_SHARE * runs.size))]
        held_runs = np.isin(run, chosen)
    held_channels, used = np.zeros(count, dtype=bool), measured.used
    left = np.flatnonzero(~held_runs & used)
    if left.size >= _FEWEST_CHANNELS:
        wanted = max(1, round(_CHANNEL_SHARE * left.size))
        for i in stream.permutation(left):
            alone = (run[left] == run[i]).sum() - held_channels[run == run[i]].sum() < 2
            if not alone and held_channels.sum() < wanted:
                held_channels[i] = True
    return Split(used & ~(held_runs | held_channels), used & held_runs, held_channels, turn)
