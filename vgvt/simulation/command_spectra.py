"""Spectra of what drives a rig, over lines as a test's information is summed over.

A search for the best test asks for the same few excitations at every place of the shaker: transforms are kept.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.rig import RANDOM_KINDS
from vgvt.simulation.assembly import Plan
from vgvt.simulation.command import sent_commands
from vgvt.simulation.fisher import Lines

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

_SAMPLES_PER_CYCLE = 8
# More than the sweeps that a plan compares at one place of the shaker (25), and what may be kept of them in bytes.
_KEPT, _KEPT_BYTES = 40, 1 << 26


@dataclass(frozen=True, slots=True, eq=False)
class _Spectra:
    """Integrals (I, I, B + 1) of U_i U_j* from below up to the edges ``axis`` (B + 1,) of bins ``line_hz`` wide."""

    line_hz: float
    axis: Array
    totals: Complex


def command_spectra(layout: Plan, run: int, lines: Lines) -> Complex:
    """Products U_i U_j* of the inputs' transforms, (unit s)² (K, I, I), averaged over the width of each line."""
    sent = _spectra(layout, run)
    inputs = len(sent.totals)
    # A line is averaged over its own bin at least: below that a record knows nothing.
    half = np.maximum(lines.width_hz, sent.line_hz) / 2
    products = np.empty((lines.frequency_hz.size, inputs, inputs), dtype=complex)
    for i, row in enumerate(sent.totals):
        for j, total in enumerate(row):
            above, below = (np.interp(lines.frequency_hz + h, sent.axis, total) for h in (half, -half))
            products[:, i, j] = (above - below) / (2 * half)
    return products


# The last few, the latest last, in this process. Never changed, but replaced: threads and forks need no lock.
_known: dict[Hashable, _Spectra] = {}


def _spectra(layout: Plan, run: int) -> _Spectra:
    """Spectra of what a run is sent, kept where it is known what they follow from."""
    global _known
    key = _followed(layout, run)
    if key is None:
        return _transformed(layout, run)
    kept = dict(_known)
    found = kept.pop(key, None) or _transformed(layout, run)
    kept[key] = found
    while len(kept) > _KEPT or sum(s.totals.nbytes + s.axis.nbytes for s in kept.values()) > _KEPT_BYTES:
        del kept[next(iter(kept))]
    _known = kept
    return found


def _followed(layout: Plan, run: int) -> Hashable | None:
    """All that a run's commands follow from; None where a hammer strikes or an effect has a hand in it."""
    scenario, shakers = layout.scenario, len(layout.scenario.shakers)
    if layout.strike is not None or any(action.command is not None for action in layout.actions):
        return None
    drawn = shakers > 1 or scenario.excitation.kind in RANDOM_KINDS
    level = scenario.acquisition.level_in(run)
    return scenario.excitation, level, scenario.generator, shakers, (scenario.seed, run) if drawn else None


def _transformed(layout: Plan, run: int) -> _Spectra:
    excitation = layout.scenario.excitation
    # A hit is shorter than a cycle of the band's end.
    struck = layout.strike is not None
    rate = layout.scenario.acquisition.sample_rate_hz if struck else _SAMPLES_PER_CYCLE * excitation.band_hz[1]
    time = np.arange(round(excitation.whole_s * rate) + 1) / rate
    # What was sent before the record began tells nothing, but of what still rings then.
    sent = sent_commands(layout, run, time)[:, time >= excitation.before_record_s]
    spectra = np.fft.rfft(sent) / rate
    line_hz = rate / sent.shape[1]
    axis = np.arange(spectra.shape[1] + 1) * line_hz - 0.5 * line_hz
    totals = np.zeros((len(spectra), len(spectra), axis.size), dtype=complex)
    for i, one in enumerate(spectra):
        for j, other in enumerate(spectra):
            np.cumsum(one * other.conj(), out=totals[i, j, 1:])
            totals[i, j, 1:] *= line_hz
    # Whoever asks again gets the same one.
    axis.flags.writeable = totals.flags.writeable = False
    return _Spectra(line_hz, axis, totals)
