"""The checks every effect must pass; shipped, so that a plugin's whole test file is three lines.

    import pytest
    from my_effect import MyEffect
    from vgvt.simulation.effect_conformance import checks

    @pytest.mark.parametrize("check", checks(), ids=str)
    def test_conformance(check):
        check(MyEffect)

Each check takes the effect's class, which must be installed (entry-point group
``vgvt.effects``), and raises AssertionError with the reason. The simulations are of
``example_scenario()``: two short runs, a coarse airframe, instruments without noise.
"""

from __future__ import annotations

from functools import lru_cache
from typing import cast

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Record
from vgvt.effects.acting import action_of
from vgvt.effects.action import Action
from vgvt.effects.conformance import (
    Check,
    as_checks,
    declaration_checks,
    neutral,
    sizes,
    switched_on,
    with_effect,
)
from vgvt.effects.parameter import Parameter, parameters_of
from vgvt.effects.protocol import Effect
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation.campaign import SimulationResult, simulate

ROUND_OFF = 1e-12
ENGINES_AGREE = 0.01
"""Largest difference of the two engines' FRFs, relative, away from antiresonances."""
LEAST_CHANGE = 1e-8
"""Least change of a channel's record, relative to its rms, that counts as a response."""
QUIET_V, LOUD_V = 0.05, 1.0
"""Command amplitudes at which geometry stays linear and at which nonlinear effects show."""


def checks() -> tuple[Check, ...]:
    """All checks, in the order in which a new effect meets them; InputError where Python runs without assert (-O)."""
    return (
        *declaration_checks(),
        *as_checks(
            vanishes_at_its_neutral_values,
            simulates_over_its_plausible_range,
            changes_the_records,
            scales_with_the_drive,
            looks_the_same_to_both_engines,
        ),
    )


@lru_cache(maxsize=4)
def example_scenario(amplitude_v: float = QUIET_V) -> Scenario:
    """Hati, four links a wing, in two runs of three seconds with different sensors, noise-free."""
    whole = load_scenario("quick")
    wing = whole.airframe.beam[0].model_copy(update={"cells": 4})
    clean: dict[str, object] = {"noise": None, "high_pass_hz": 0.0}
    changes: dict[str, dict[str, object]] = {
        "airframe": {"beam": (wing,)},
        "accelerometers": clean,
        "transducer": clean,
        "acquisition": {"runs": ((1, 10), (11, 20)), "sample_rate_hz": 1000.0, "bits": 32, "noise_v_per_rthz": 0.0},
        "excitation": {
            "start_hz": 3.0,
            "stop_hz": 35.0,
            "duration_s": 2.0,
            "ring_down_s": 1.0,
            "taper_s": 0.2,
            "amplitude_v": amplitude_v,
        },
    }
    tables = {name: getattr(whole, name).model_copy(update=update) for name, update in changes.items()}
    return whole.model_copy(update=tables)


def vanishes_at_its_neutral_values(effect: type) -> None:
    """At its neutral values it does nothing, or truth and records equal those without it to round-off."""
    off, scenario = neutral(effect), example_scenario()
    actions = [action_of(off, scenario, run) for run in range(len(scenario.acquisition.run_nodes))]
    warmest = max(abs(a.warming_k) for a in actions)
    assert warmest == 0, f"at neutral values a thermometer beside the aircraft shows {warmest:g} K more"
    if all(a.command is None and not a.channels and _as_ideal(a, scenario) for a in actions):
        return
    with_it, without = simulate(with_effect(scenario, off), engine="linear"), _bare("linear", QUIET_V)
    for one, other in zip(with_it.campaign.runs, without.campaign.runs, strict=True):
        largest = np.abs(other.samples).max(axis=1, keepdims=True)
        change = float((np.abs(one.samples - other.samples) / largest).max())
        assert change < ROUND_OFF, f"at neutral values run {one.run} changes by {change:.1e}"
    models = zip(
        (with_it.truth.bare, *with_it.truth.as_tested), (without.truth.bare, *without.truth.as_tested), strict=True
    )
    for got, wanted in models:
        assert len(got) == len(wanted), f"at neutral values {len(wanted)} true modes become {len(got)}"
        moved = float(np.abs(got.natural_frequency_hz / wanted.natural_frequency_hz - 1).max())
        assert moved < ROUND_OFF, f"at neutral values true frequencies move by {moved:.1e}"


def _as_ideal(action: Action, scenario: Scenario) -> bool:
    """Whether an action leaves aircraft, rig and sensors' places as a scenario has them."""
    return action.same_rig(Action(scenario=None if action.scenario is None else scenario))


def simulates_over_its_plausible_range(effect: type) -> None:
    """With its defaults, and with every parameter at either end of its range, the records are finite."""
    cases = [{p.name: value} for p in parameters_of(effect) for value in (p.low, p.high)]
    for made in (effect(), *(switched_on(effect, **case) for case in cases)):
        for record in simulate(with_effect(example_scenario(), made), engine="linear").campaign.runs:
            assert np.isfinite(record.samples).all(), f"{made} gives samples that are not finite in run {record.run}"


def changes_the_records(effect: type) -> None:
    """Switched on it shows, and the more the bigger it is; nonlinear effects need only show at one end.

    That goes for every parameter with a neutral value: on its own, or where it is nothing alone beside the others.
    """
    # One that is switched by a choice, like which two sensors are swapped, has none: its own tests know what shows.
    for size in sizes(effect):
        others: dict[str, float] = {p.name: cast(float, p.neutral) for p in sizes(effect) if p != size}
        if others and not _shows(effect, size, others):
            others = {p.name: p.high for p in sizes(effect) if p != size}
        _changes_by(effect, size, others)


def _shows(effect: type, size: Parameter, others: dict[str, float]) -> bool:
    """Whether the upper end of a parameter's range is seen at all beside values of the others."""
    high, off = (effect(**others, **{size.name: value}) for value in (size.high, size.neutral))
    engine, amplitude_v = ("linear", QUIET_V) if getattr(effect, "linear", False) else ("mujoco", LOUD_V)
    return _change(high, engine, amplitude_v, off) > LEAST_CHANGE


def _changes_by(effect: type, size: Parameter, others: dict[str, float]) -> None:
    """The check of one parameter, beside values of the others."""
    low, high, off = (effect(**others, **{size.name: value}) for value in (size.low, size.high, size.neutral))
    if not getattr(effect, "linear", False):
        shown = any(_change(made, "mujoco", LOUD_V, off) > LEAST_CHANGE for made in (high, low))
        assert shown, f"neither {size.name} = {size.low:g} nor {size.high:g} changes a loud test"
        return
    smaller, bigger = (_change(made, "linear", QUIET_V, off) for made in (low, high))
    assert bigger > LEAST_CHANGE, f"{size.name} = {size.high:g} changes nothing"
    if size.neutral is not None and size.low < size.neutral:
        assert smaller > LEAST_CHANGE, f"{size.name} = {size.low:g} changes nothing"
    else:
        assert bigger > smaller, (
            f"{size.name} = {size.high:g} changes the records by {bigger:.2g}, {size.low:g} by {smaller:.2g}"
        )


def scales_with_the_drive(effect: type) -> None:
    """A linear effect lets twice the drive give twice the record."""
    if not getattr(effect, "linear", False):
        return
    made = switched_on(effect)
    once, twice = (simulate(with_effect(example_scenario(v), made), engine="linear") for v in (QUIET_V, 2 * QUIET_V))
    for one, two in zip(once.campaign.runs, twice.campaign.runs, strict=True):
        excess = np.abs(two.samples - 2 * one.samples).max(axis=1)
        allowed = 3 * _converter_step(one) + 1e-9 * np.abs(two.samples).max(axis=1)
        assert np.all(excess <= allowed), f"declared linear, but twice the drive misses twice the record by {excess}"


def looks_the_same_to_both_engines(effect: type) -> None:
    """A linear effect gives the same small-amplitude FRFs stepped by MuJoCo and solved exactly, within 1 %."""
    if not getattr(effect, "linear", False):
        return
    scenario = with_effect(example_scenario(), switched_on(effect))
    stepped, solved = (simulate(scenario, engine=engine).campaign for engine in ("mujoco", "linear"))
    for one, other in zip(stepped.runs, solved.runs, strict=True):
        got, wanted = _frf(one), _frf(other)
        clear = np.abs(wanted) > 0.1 * np.median(np.abs(wanted), axis=1, keepdims=True)
        difference = float(np.abs(got / wanted - 1)[clear].max())
        assert difference < ENGINES_AGREE, f"run {one.run}: the engines' FRFs differ by {difference:.1%}"


@lru_cache(maxsize=4)
def _bare(engine: str, amplitude_v: float) -> SimulationResult:
    return simulate(example_scenario(amplitude_v), engine=engine)


def _change(effect: Effect, engine: str, amplitude_v: float, off: Effect) -> float:
    """Largest rms change of a channel in any run by an effect, relative to its rms with one that is switched off."""
    scenario = example_scenario(amplitude_v)
    changed = simulate(with_effect(scenario, effect), engine=engine).campaign
    without = (
        _bare(engine, amplitude_v) if off == neutral(type(off)) else simulate(with_effect(scenario, off), engine=engine)
    )
    largest = 0.0
    for one, other in zip(changed.runs, without.campaign.runs, strict=True):
        if one.samples.shape != other.samples.shape:
            return float("inf")
        rms = np.sqrt(np.mean(other.samples**2, axis=1))
        largest = max(largest, float((np.sqrt(np.mean((one.samples - other.samples) ** 2, axis=1)) / rms).max()))
    return largest


def _frf(record: Record) -> NDArray[np.complex128]:
    """Accelerance (responses, lines) in the swept band, from whole-record spectra."""
    frequency = np.fft.rfftfreq(record.samples.shape[1], 1 / record.sample_rate_hz)
    spectra = np.fft.rfft(record.samples, axis=1)[:, (frequency > 4.0) & (frequency < 34.0)]
    return np.asarray(spectra[2:] / spectra[1])


def _converter_step(record: Record) -> NDArray[np.float64]:
    """The converter's step in each channel's unit, (channels,)."""
    acquisition = example_scenario().acquisition
    volts = 2 * acquisition.range_v / 2**acquisition.bits
    return np.array([volts / abs(channel.sensitivity_v_per_unit) for channel in record.channels])
