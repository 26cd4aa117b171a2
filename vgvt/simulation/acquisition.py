"""From physical quantities to what the data acquisition writes down: sensor, conditioner, converter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.signal
from numpy.typing import NDArray

from vgvt.data import Channel, ChannelRole, Quantity, Record
from vgvt.scenario.full_scale import (
    FullScale,
    acceleration_sensor_scale,
    converter_scale,
    force_sensor_scale,
    generator_scale,
)
from vgvt.scenario.instruments import NoiseSpectrum
from vgvt.scenario.model import Scenario
from vgvt.scenario.streams import named_stream
from vgvt.signals.noise import coloured_noise
from vgvt.simulation.assembly import Plan
from vgvt.simulation.channel_effects import changed_by_effects
from vgvt.simulation.command import limited_drives, unrecorded_samples
from vgvt.simulation.rig import GRAVITY_M_PER_S2
from vgvt.simulation.seats import MeasurementPoint


@dataclass(frozen=True, slots=True, eq=False)
class _Chain:
    """One channel on its way: volts at the converter per SI unit, noise in SI units, AC coupling, the sensor's end."""

    channel: Channel
    noise: NoiseSpectrum | None
    noise_unit: float
    high_pass_hz: float
    full_scale: FullScale | None


def record(layout: Plan, run: int, command_v: NDArray[np.float64], readings: NDArray[np.float64]) -> Record:
    """The record of a run (counted from 0) as the converter delivers it, in SI units.

    ``command_v`` (shakers, samples), none for a hammer; ``readings`` (points + forces, samples) hold
    the run's accelerations, m/s^2, and the forces, N, both from rest. Each channel is AC coupled, gets its
    sensor's noise from a random stream of its own, ends at the sensor's full scale, gets the converter's noise, is
    clipped and rounded to the converter's steps. Effects change it at the stages of
    :data:`vgvt.effects.action.Stage`. The instruments are on before the record begins.
    """
    scenario = layout.scenario
    points = layout.run_points(run)
    drives = [_drive(layout, k) for k in range(len(command_v))]
    forces = [_force(layout, k) for k in range(len(layout.forces))]
    chains = [*drives, *forces, *(_acceleration(scenario, p) for p in points)]
    signals = np.vstack([command_v, readings[len(points) :], readings[: len(points)]])
    begin = unrecorded_samples(scenario)
    generator = generator_scale(scenario)
    reached: dict[str, list[str]] = {}
    if generator is not None:
        reached = {drives[k].channel.name: [generator.words] for k in limited_drives(scenario, run)}
    for chain, row in zip(chains, signals, strict=True):
        scales = _through(layout, chain, run, row, begin)
        if scales:
            reached.setdefault(chain.channel.name, []).extend(scales)
    channels = tuple(chain.channel for chain in chains)
    overloaded = tuple(channel.name for channel in channels if channel.name in reached)
    notes = tuple(f"{name}: reached {' and '.join(reached[name])}" for name in overloaded)
    return Record(run + 1, scenario.acquisition.sample_rate_hz, channels, signals[:, begin:], overloaded, notes)


def _name(layout: Plan, quantity: str, exciter: int) -> str:
    """The name of an exciter's channel: plain for the first, with its node for the others."""
    return quantity if exciter == 0 else f"{quantity} {layout.forces[exciter].dof.node}"


def _drive(layout: Plan, exciter: int) -> _Chain:
    range_v = layout.scenario.acquisition.range_v
    channel = Channel(_name(layout, "drive", exciter), Quantity.GENERAL, ChannelRole.DRIVE, range_v=range_v)
    return _Chain(channel, None, 1.0, 0.0, None)


def _force(layout: Plan, exciter: int) -> _Chain:
    scenario, transducer = layout.scenario, layout.scenario.transducer
    volts_per_n = transducer.sensitivity_v_per_n * transducer.conditioner_gain
    noise, high_pass_hz = transducer.noise, transducer.high_pass_hz
    if layout.strike is not None and scenario.hammer is not None:
        volts_per_n, noise, high_pass_hz = scenario.hammer.sensitivity_v_per_n, scenario.hammer.noise, 0.0
    channel = Channel(
        _name(layout, "force", exciter),
        Quantity.EXCITATION_FORCE,
        ChannelRole.REFERENCE,
        layout.forces[exciter].dof,
        sensitivity_v_per_unit=volts_per_n,
        range_v=scenario.acquisition.range_v,
    )
    return _Chain(channel, noise, 1.0, high_pass_hz, force_sensor_scale(scenario))


def _acceleration(scenario: Scenario, point: MeasurementPoint) -> _Chain:
    sensors = scenario.accelerometers
    channel = Channel(
        f"acceleration {point.dof}",
        Quantity.ACCELERATION,
        ChannelRole.RESPONSE,
        point.dof,
        sensitivity_v_per_unit=sensors.sensitivity_v_per_g * sensors.conditioner_gain / GRAVITY_M_PER_S2,
        range_v=scenario.acquisition.range_v,
    )
    return _Chain(channel, sensors.noise, GRAVITY_M_PER_S2, sensors.high_pass_hz, acceleration_sensor_scale(scenario))


def _through(layout: Plan, chain: _Chain, run: int, row: NDArray[np.float64], begin: int) -> list[str]:
    """Send one channel (samples,) through its chain, in place; what it reaches the end of, recorded from ``begin``."""
    reached = []
    scenario = layout.scenario
    acquisition = scenario.acquisition
    rate, name = acquisition.sample_rate_hz, chain.channel.name
    row[:] = changed_by_effects(layout, chain.channel, run, "sensor", row)
    if chain.high_pass_hz > 0:
        numerator, denominator = scipy.signal.butter(1, chain.high_pass_hz, "highpass", fs=rate)
        row[:] = scipy.signal.lfilter(numerator, denominator, row)
    if chain.noise is not None:
        generator = named_stream(scenario.seed, "sensor noise", run, name)
        density = np.array(chain.noise.density) * chain.noise_unit
        row += coloured_noise(generator, row.size, rate, chain.noise.frequency_hz, density)
    end = chain.full_scale
    if end is not None:
        if np.abs(row[begin:]).max() > end.si:
            reached.append(end.words)
        np.clip(row, -end.si, end.si, out=row)
    row *= chain.channel.sensitivity_v_per_unit
    row[:] = changed_by_effects(layout, chain.channel, run, "conditioner", row)
    row[:] = changed_by_effects(layout, chain.channel, run, "converter", row)
    if acquisition.noise_v_per_rthz > 0:
        generator = named_stream(scenario.seed, "converter noise", run, name)
        row += generator.standard_normal(row.size) * acquisition.noise_v_per_rthz * np.sqrt(rate / 2)
    step = 2 * acquisition.range_v / 2**acquisition.bits
    highest = acquisition.range_v - step
    recorded = row[begin:]
    if np.any((recorded < -acquisition.range_v) | (recorded > highest)):
        reached.append(converter_scale(scenario).words)
    np.clip(np.round(row / step) * step, -acquisition.range_v, highest, out=row)
    recorded[:] = changed_by_effects(layout, chain.channel, run, "record", recorded)
    row /= chain.channel.sensitivity_v_per_unit
    return reached
