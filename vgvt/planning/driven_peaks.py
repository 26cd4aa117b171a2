"""The largest force, acceleration and motion that a sine makes: as it is swept, and where one would dwell on the way.

A sweep that crosses a resonance within its time to build up rings on beside the next frequencies, and what adds to a
force that drops out may go beyond all that a dwell would show. So the states of the rig are followed along the sweep,
each under a sine of the frequency in the middle of a short step, exactly (a rotating frame's exponential integrator).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.planning.system import System
from vgvt.scenario.rig import Excitation
from vgvt.signals.excitation import fade, linear_chirp_frequency
from vgvt.signals.excitation_sines import stepped_frequencies
from vgvt.simulation.fisher import lines_for
from vgvt.simulation.state_space import StateSpace

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

# Of the time in which a sweep's phase runs away from a steady sine's by a cycle, and of the taper.
_STEP, _OF_TAPER = 0.025, 0.125
_CHUNK = 1024


def largest_of_a_sine(system: System) -> Array:
    """Acceleration of a run's sensors, m/s², measured force, N, and motion of the drive point, mm, per volt (3,).

    The most of what the sweep makes and of what a dwell within the recorded band would: whoever stops it at a peak is
    not to be surprised either.
    """
    driven, e, sensors = system.driven, system.layout.scenario.excitation, list(system.sensors)
    freedoms, force = driven.linear.freedoms, [len(driven.output_matrix) - 1]
    moved = np.concatenate([driven.linear.displacement[len(system.layout.grid)], np.zeros(freedoms)])
    outputs = Outputs.of(
        driven,
        np.vstack([driven.output_matrix[sensors + force], 1000 * moved]),
        np.append(driven.feedthrough_rows[sensors + force, 0], 0.0),
    )
    largest = np.maximum(outputs.dwelt(e.recorded_band_hz), outputs.swept(e))
    return np.array([largest[:-2].max(), *largest[-2:]])


@dataclass(frozen=True, slots=True, eq=False)
class Outputs:
    """Outputs of a rig with one input: Σ gains / (s - pole) + through, ``gains`` (O, n) and ``through`` (O,)."""

    poles: Complex
    gains: Complex
    through: Array

    @classmethod
    def of(cls, driven: StateSpace, rows: Array, through: Array) -> Outputs:
        """Combinations ``rows`` (O, states) of a driven rig's states, and ``through`` (O,) of its one command."""
        poles, right = np.linalg.eig(driven.state_matrix)
        entering = np.linalg.solve(right, driven.inputs[:, 0].astype(complex))
        return cls(poles, (rows @ right) * entering, through)

    def dwelt(self, band_hz: tuple[float, float]) -> Array:
        """Largest amplitudes (O,) of sines of unit command that dwell anywhere in a band."""
        s = 2j * np.pi * lines_for(band_hz, self.poles[self.poles.imag > 0]).frequency_hz
        return np.asarray(np.abs(self.gains @ (1 / (s - self.poles[:, None])) + self.through[:, None]).max(axis=1))

    def swept(self, e: Excitation) -> Array:
        """Largest envelopes (O,) under a sine of unit amplitude as it is swept or stepped, from rest to its end."""
        step_s = e.duration_s / math.ceil(e.duration_s / _step_s(e))
        middle_s: Array = np.asarray(step_s * (np.arange(round(e.duration_s / step_s)) + 0.5), dtype=np.float64)
        omega, size = 2 * np.pi * frequency_hz(e, middle_s), fade(middle_s, e.duration_s, e.taper_s)
        # In a frame that turns with the sine; what it had turned by before a step is taken back after it.
        growth, largest = np.exp(self.poles * step_s), np.zeros(len(self.gains))
        state: Complex = np.zeros(self.poles.size, dtype=complex)
        for first in range(0, omega.size, _CHUNK):
            turning = 1j * omega[first : first + _CHUNK, None]
            amplitude = size[first : first + _CHUNK, None]
            kept, met = growth * np.exp(-turning * step_s), amplitude / (turning - self.poles)
            states = np.empty_like(met)
            for k, (keep, steady) in enumerate(zip(kept, met, strict=True)):
                state = keep * (state - steady) + steady
                states[k] = state
            found = np.abs(states @ self.gains.T + amplitude * self.through)
            largest = np.maximum(largest, found.max(axis=0))
        return largest


def frequency_hz(e: Excitation, time_s: Array) -> Array:
    """The frequency of a sine at times (K,) since it began, Hz (K,)."""
    if e.kind == "linear-chirp":
        return linear_chirp_frequency(time_s, e.start_hz, e.stop_hz, e.duration_s)
    if e.kind == "logarithmic-chirp":
        return np.asarray(e.start_hz * (e.stop_hz / e.start_hz) ** (time_s / e.duration_s))
    assert e.kind == "stepped-sine" and e.points is not None, "noise has no frequency"
    steps = np.minimum((time_s * e.points / e.duration_s).astype(int), e.points - 1)
    return np.asarray(stepped_frequencies(e.start_hz, e.stop_hz, e.points)[steps])


def _step_s(e: Excitation) -> float:
    """Seconds within which a sine is all but a steady one."""
    width_hz = abs(e.stop_hz - e.start_hz)
    rate_hz_per_s = width_hz / e.duration_s
    if e.kind == "logarithmic-chirp":
        rate_hz_per_s = max(e.start_hz, e.stop_hz) * abs(math.log(e.stop_hz / e.start_hz)) / e.duration_s
    step_s = _STEP / math.sqrt(rate_hz_per_s)
    return min(step_s, _OF_TAPER * e.taper_s) if e.taper_s > 0 else step_s
