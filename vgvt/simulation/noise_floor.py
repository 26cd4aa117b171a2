"""How much noise a measuring chain adds: sensor or transducer, converter and rounding, as one-sided densities.

All of it as what would have to be sensed to read it by the stated sensitivity, through the stated AC coupling: that
lets less and less pass below its corner, and the noise comes after it. A filter or a gain that an effect puts behind
the sensor changes what is sensed and the sensor's noise alike, so that one stands out of the other as before: what is
said here of the sensor holds with such an effect, too. Of the converter's part, which it does not change, this leaves
the effect out.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.instruments import NoiseSpectrum
from vgvt.signals.noise import interpolated_density
from vgvt.simulation.assembly import Plan
from vgvt.simulation.rig import GRAVITY_M_PER_S2

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
_LEAST_PASSED = 1e-12
"""Of the power at 0 Hz, where nothing is told either way."""


def response_noise(layout: Plan, frequency_hz: Array) -> Array:
    """One-sided power density of an accelerometer channel, (m/s²)²/Hz, shape (M,)."""
    sensors = layout.scenario.accelerometers
    volts_per_unit = sensors.sensitivity_v_per_g * sensors.conditioner_gain / GRAVITY_M_PER_S2
    noise = _chain_noise(layout, sensors.noise, GRAVITY_M_PER_S2, volts_per_unit, frequency_hz)
    return noise / _passed(layout, sensors.high_pass_hz, frequency_hz)


def force_noise(layout: Plan, frequency_hz: Array) -> Array:
    """One-sided power density of the force channel, N²/Hz, shape (M,)."""
    transducer, hammer = layout.scenario.transducer, layout.scenario.hammer
    if layout.strike is not None and hammer is not None:
        return _chain_noise(layout, hammer.noise, 1.0, hammer.sensitivity_v_per_n, frequency_hz)
    volts_per_unit = transducer.sensitivity_v_per_n * transducer.conditioner_gain
    noise = _chain_noise(layout, transducer.noise, 1.0, volts_per_unit, frequency_hz)
    return noise / _passed(layout, transducer.high_pass_hz, frequency_hz)


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


def ac_coupling(layout: Plan, corner_hz: float, frequency_hz: Array) -> Complex:
    """What AC coupling makes of a signal, (M,), as the acquisition has it; 1 for a corner at 0 Hz."""
    if corner_hz <= 0:
        return np.ones(frequency_hz.size, complex)
    # The bilinear transform of s / (s + w), of first order.
    rate_hz = layout.scenario.acquisition.sample_rate_hz
    here, corner = np.tan(np.pi * frequency_hz / rate_hz), np.tan(np.pi * corner_hz / rate_hz)
    return np.asarray(1j * here / (1j * here + corner))


def _passed(layout: Plan, corner_hz: float, frequency_hz: Array) -> Array:
    """The power that AC coupling lets pass, (M,); never quite 0."""
    return np.asarray(np.maximum(np.abs(ac_coupling(layout, corner_hz, frequency_hz)) ** 2, _LEAST_PASSED))
