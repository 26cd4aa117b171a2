"""How much noise a measuring chain adds: sensor or transducer, converter and rounding, as one-sided densities.

All of it as what would have to be sensed to read it by the stated sensitivity. A filter or a gain that an effect puts
behind the sensor changes what is sensed and the sensor's noise alike, so that one stands out of the other as before:
what is said here of the sensor holds with such an effect, too. Of the converter's part, which it does not change, this
leaves the effect out.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.instruments import NoiseSpectrum
from vgvt.signals.noise import interpolated_density
from vgvt.simulation.assembly import Plan
from vgvt.simulation.rig import GRAVITY_M_PER_S2

Array = NDArray[np.float64]


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
