"""Where the instruments end: full scales of sensors, converter and generator, and what a level would reach of them."""

from __future__ import annotations

from dataclasses import dataclass

from vgvt.scenario.model import Scenario

_M_PER_S2_PER_G = 9.80665


@dataclass(frozen=True, slots=True)
class FullScale:
    """The largest value, plus and minus, that something takes: ``si`` in the channel's unit, and in words."""

    si: float
    words: str


def force_sensor_scale(scenario: Scenario) -> FullScale | None:
    """Of what measures the force, N: the transducer, or the hammer's gauge; None where it has no end."""
    hammer = scenario.hammer if scenario.excitation.kind == "impact" else None
    range_n = scenario.transducer.range_n if hammer is None else hammer.range_n
    whose = "the force transducer's" if hammer is None else "the hammer gauge's"
    return None if range_n is None else FullScale(range_n, f"{whose} ±{range_n:g} N")


def acceleration_sensor_scale(scenario: Scenario) -> FullScale | None:
    """Of an accelerometer, m/s²; None where it has no end."""
    range_g = scenario.accelerometers.range_g
    return None if range_g is None else FullScale(range_g * _M_PER_S2_PER_G, f"the accelerometer's ±{range_g:g} g")


def converter_scale(scenario: Scenario) -> FullScale:
    """Of the converter's inputs, V."""
    range_v = scenario.acquisition.range_v
    return FullScale(range_v, f"the converter's ±{range_v:g} V")


def generator_scale(scenario: Scenario) -> FullScale | None:
    """Of the generator's outputs, V; None where it has no end."""
    range_v = scenario.generator.range_v
    return None if range_v is None else FullScale(range_v, f"the generator's ±{range_v:g} V")


def scales_of_force(scenario: Scenario) -> tuple[FullScale, ...]:
    """What a force channel passes through, each with the force, N, at which it ends, in the order of the way."""
    hammer, transducer = scenario.hammer, scenario.transducer
    volts_per_n = transducer.sensitivity_v_per_n * transducer.conditioner_gain
    if hammer is not None and scenario.excitation.kind == "impact":
        volts_per_n = hammer.sensitivity_v_per_n
    return _in_order(force_sensor_scale(scenario), converter_scale(scenario), volts_per_n)


def scales_of_acceleration(scenario: Scenario) -> tuple[FullScale, ...]:
    """What an accelerometer's channel passes through, each with the acceleration, m/s², at which it ends."""
    sensors = scenario.accelerometers
    volts_per_unit = sensors.sensitivity_v_per_g * sensors.conditioner_gain / _M_PER_S2_PER_G
    return _in_order(acceleration_sensor_scale(scenario), converter_scale(scenario), volts_per_unit)


def expected_overloads(
    scenario: Scenario, peak_force_n: float, peak_acceleration_m_per_s2: float, peak_command_v: float
) -> tuple[str, ...]:
    """A remark for everything that peaks as large as these would drive beyond its end; none where all is well."""
    generator = generator_scale(scenario)
    expected = (
        ("the force", peak_force_n, "N", scales_of_force(scenario)),
        ("the acceleration", peak_acceleration_m_per_s2, "m/s²", scales_of_acceleration(scenario)),
        ("the command", peak_command_v, "V", (generator,) if generator is not None else ()),
    )
    return tuple(
        f"{what} of up to {peak:.3g} {unit} is beyond {scale.words}: the record would be cut off there"
        for what, peak, unit, scales in expected
        for scale in scales
        if peak > scale.si
    )


def _in_order(sensor: FullScale | None, converter: FullScale, volts_per_unit: float) -> tuple[FullScale, ...]:
    behind = FullScale(converter.si / volts_per_unit, converter.words)
    return (behind,) if sensor is None else (sensor, behind)
