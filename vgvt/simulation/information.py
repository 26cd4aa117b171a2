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
from vgvt.simulation.command import sample_times_s, sent_commands
from vgvt.simulation.rig import GRAVITY_M_PER_S2
from vgvt.simulation.state_space import StateSpace

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


def frequency_limit_hz(layout: Plan, run: int, driven: StateSpace, modes: ModalModel) -> Array:
    """Smallest standard deviation, Hz, shape (M,), of each natural frequency that one run (from 0) allows.

    Infinite for a mode that the force or every sensor misses, 0 without noise.
    """
    if modes.residues is None:
        raise ValueError("modes need residues")
    omega, decay = np.abs(modes.poles), -modes.poles.real
    nodes = {p.dof for p in layout.run_points(run)}
    measured = [i for i, dof in enumerate(modes.dofs) if dof in nodes]
    strongest, share = _strongest_column(modes.residues[:, measured])
    peak = np.abs(strongest) * (omega**2 / decay)[:, None]
    frequency = omega / (2 * np.pi)
    felt = (np.abs(share) ** 2).sum(axis=1) * force_noise(layout, frequency)
    noise = response_noise(layout, frequency)[:, None] + peak**2 * felt[:, None]
    # Several forces push a mode as one, each by its share of the mode's shape.
    push = np.einsum("mr,mri->mi", share, _force_per_input(driven, omega, share.shape[1]))
    energy = _input_energy(layout, run, frequency, decay / np.pi, push)
    with np.errstate(divide="ignore", invalid="ignore"):
        signal = np.where(peak > 0, peak**2 / noise, 0.0).sum(axis=1) * energy
        return np.asarray(np.sqrt(2 * decay / signal) / (2 * np.pi))


def _strongest_column(residues: Complex) -> tuple[Complex, Complex]:
    """Of residues (M, D, R): those of each mode's strongest reference, (M, D), and all references' shares of it."""
    size = (np.abs(residues) ** 2).sum(axis=1)
    strongest = residues[np.arange(len(residues)), :, np.argmax(size, axis=1)]
    power = np.maximum((np.abs(strongest) ** 2).sum(axis=1), np.finfo(float).tiny)
    return strongest, np.einsum("md,mdr->mr", strongest.conj(), residues) / power[:, None]


def _force_per_input(driven: StateSpace, omega: Array, forces: int) -> Complex:
    """The measured forces for a unit of each input at some frequencies, (omega, forces, inputs)."""
    identity = np.eye(driven.state_matrix.shape[0])
    states = [np.linalg.solve(1j * w * identity - driven.state_matrix, driven.inputs) for w in omega]
    return np.asarray(driven.output_matrix[-forces:] @ np.array(states) + driven.feedthrough_rows[-forces:])


def _input_energy(layout: Plan, run: int, frequency_hz: Array, width_hz: Array, push: Complex) -> Array:
    """Energy density, N² s², of inputs times ``push`` (M, inputs), over each mode's half-power width or four lines."""
    time = sample_times_s(layout.scenario)
    rate = layout.scenario.acquisition.sample_rate_hz
    spectra = np.fft.rfft(sent_commands(layout, run, time), axis=1) / rate
    line_hz = rate / time.size
    half = np.maximum(width_hz / 2, 2 * line_hz)
    first = np.clip(np.round((frequency_hz - half) / line_hz), 0, spectra.shape[1] - 5).astype(int)
    last = np.clip(np.round((frequency_hz + half) / line_hz).astype(int) + 1, first + 1, spectra.shape[1])
    return np.array([(np.abs(p @ spectra[:, a:b]) ** 2).mean() for p, a, b in zip(push, first, last, strict=True)])


def response_noise(layout: Plan, frequency_hz: Array) -> Array:
    """One-sided power density of an accelerometer channel, (m/s²)²/Hz, shape (M,)."""
    sensors = layout.scenario.accelerometers
    volts_per_unit = sensors.sensitivity_v_per_g * sensors.conditioner_gain / GRAVITY_M_PER_S2
    return _chain_noise(layout, sensors.noise, GRAVITY_M_PER_S2, volts_per_unit, frequency_hz)


def force_noise(layout: Plan, frequency_hz: Array) -> Array:
    """One-sided power density of the force channel, N²/Hz, shape (M,)."""
    transducer, hammer = layout.scenario.transducer, layout.scenario.hammer
    if layout.strike is not None and hammer is not None:
        return _chain_noise(layout, hammer.noise, 1.0, hammer.sensitivity_v_per_n, frequency_hz)
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
