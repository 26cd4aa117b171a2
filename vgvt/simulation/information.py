"""How well a test can know a mode at all: the smallest standard deviation of its frequency.

For one lightly damped mode with s = ζω, measured force of energy density E(f)
(the squared magnitude of its Fourier transform, N² s²) and responses of peak
accelerance |H_o| in noise of one-sided density G_o, every unbiased estimate obeys
std(f) ≥ sqrt(2 s / (E Σ|H_o|²/G_o)) / 2π and std(ζ)/ζ ≥ 2π std(f)/s: the
Cramér–Rao bound of one mode alone. For a linear chirp of amplitude F0 over Δf in T
the density is F0² T / (4 Δf). Force noise adds |H_o|² G_f to G_o. E is taken at the mode, where the
force drops out most, which errs on the side of too large a bound.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.data import ModalModel
from vgvt.scenario.instruments import NoiseSpectrum
from vgvt.signals.noise import interpolated_density
from vgvt.simulation.assembly import Plan
from vgvt.simulation.command import sample_times_s, sent_command
from vgvt.simulation.rig import GRAVITY_M_PER_S2
from vgvt.simulation.state_space import StateSpace

Array = NDArray[np.float64]


def frequency_limit_hz(layout: Plan, run: int, driven: StateSpace, modes: ModalModel) -> Array:
    """Smallest standard deviation, Hz, shape (M,), of each natural frequency that one run (from 0) allows.

    Infinite for a mode that the force or every sensor misses, 0 without noise.
    """
    if modes.residues is None:
        raise ValueError("modes need residues")
    omega, decay = np.abs(modes.poles), -modes.poles.real
    nodes = {p.dof for p in layout.run_points(run)}
    measured = [i for i, dof in enumerate(modes.dofs) if dof in nodes]
    peak = np.abs(modes.residues[:, measured, 0]) * (omega**2 / decay)[:, None]
    frequency = omega / (2 * np.pi)
    noise = _response_noise(layout, frequency)[:, None] + peak**2 * _force_noise(layout, frequency)[:, None]
    energy = _command_energy(layout, run, frequency, decay / np.pi) * _force_per_volt(driven, omega) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        signal = np.where(peak > 0, peak**2 / noise, 0.0).sum(axis=1) * energy
        return np.asarray(np.sqrt(2 * decay / signal) / (2 * np.pi))


def _force_per_volt(driven: StateSpace, omega: Array) -> Array:
    identity = np.eye(driven.input_matrix.size)
    states = [np.linalg.solve(1j * w * identity - driven.state_matrix, driven.input_matrix) for w in omega]
    return np.asarray(np.abs(np.array(states) @ driven.output_matrix[-1] + driven.feedthrough[-1]))


def _command_energy(layout: Plan, run: int, frequency_hz: Array, width_hz: Array) -> Array:
    """Energy density of the command, V² s², averaged over each mode's half-power width or four lines."""
    time = sample_times_s(layout.scenario)
    rate = layout.scenario.acquisition.sample_rate_hz
    density = np.abs(np.fft.rfft(sent_command(layout, run, time)) / rate) ** 2
    line_hz = rate / time.size
    first = np.clip(np.round((frequency_hz - np.maximum(width_hz / 2, 2 * line_hz)) / line_hz), 0, density.size - 5)
    last = np.round((frequency_hz + np.maximum(width_hz / 2, 2 * line_hz)) / line_hz)
    total = np.concatenate([[0.0], np.cumsum(density)])
    low = first.astype(int)
    high = np.clip(last.astype(int) + 1, low + 1, density.size)
    return np.asarray((total[high] - total[low]) / (high - low))


def _response_noise(layout: Plan, frequency_hz: Array) -> Array:
    """One-sided power density of an accelerometer channel, (m/s²)²/Hz, shape (M,)."""
    sensors = layout.scenario.accelerometers
    volts_per_unit = sensors.sensitivity_v_per_g * sensors.conditioner_gain / GRAVITY_M_PER_S2
    return _chain_noise(layout, sensors.noise, GRAVITY_M_PER_S2, volts_per_unit, frequency_hz)


def _force_noise(layout: Plan, frequency_hz: Array) -> Array:
    transducer = layout.scenario.transducer
    volts_per_unit = transducer.sensitivity_v_per_n * transducer.conditioner_gain
    return _chain_noise(layout, transducer.noise, 1.0, volts_per_unit, frequency_hz)


def _chain_noise(
    layout: Plan, spectrum: NoiseSpectrum | None, unit: float, volts_per_unit: float, frequency_hz: Array
) -> Array:
    acquisition = layout.scenario.acquisition
    step_v = 2 * acquisition.range_v / 2**acquisition.bits
    # Rounding to a step adds step²/12 of variance, spread up to half the sampling rate.
    rounding = step_v**2 / 6 / acquisition.sample_rate_hz
    power = np.full(frequency_hz.size, (acquisition.noise_v_per_rthz**2 + rounding) / volts_per_unit**2)
    if spectrum is not None:
        power += (unit * interpolated_density(frequency_hz, spectrum.frequency_hz, spectrum.density)) ** 2
    return power
