"""The second laboratory against the simulator, against closed forms, and against itself."""

from __future__ import annotations

import functools
from dataclasses import replace

import catalogue_twins as twins
import never_catalogued as never
import numpy as np
import pytest
import second_laboratory as lab

from vgvt.data import Campaign, ChannelRole
from vgvt.effects import make_effect
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import simulated_campaign

NODES = (1, 10, 13, 20)
BAND_HZ = np.linspace(3.0, 35.0, 161)


def scenario(cells: int) -> Scenario:
    """Hati with ideal instruments, one short sweep, four sensors at once."""
    whole = load_scenario("hati-unsymmetric")
    beams = tuple(beam.model_copy(update={"cells": cells}) for beam in whole.airframe.beam)
    damping = whole.airframe.damping.model_copy(update={"limit_hz": 60.0})
    sweep = {"start_hz": 3.0, "stop_hz": 35.0, "duration_s": 12.0, "ring_down_s": 2.0}
    tables = {
        "airframe": whole.airframe.model_copy(update={"beam": beams, "damping": damping}),
        "accelerometers": whole.accelerometers.model_copy(update={"noise": None}),
        "transducer": whole.transducer.model_copy(update={"noise": None}),
        "acquisition": whole.acquisition.model_copy(
            update={"sample_rate_hz": 250.0, "runs": (NODES,), "noise_v_per_rthz": 0.0}
        ),
        "excitation": whole.excitation.model_copy(update=sweep),
    }
    return whole.model_copy(update=tables)


def spectra(campaign: Campaign) -> np.ndarray:
    """A/F (sensors, lines) of the first run in the swept band, of whole records."""
    (run, *_) = campaign.runs
    frequency = np.fft.rfftfreq(run.samples.shape[1], 1 / run.sample_rate_hz)
    inside = (frequency > 4.0) & (frequency < 34.0)
    force = np.fft.rfft(run.select(ChannelRole.REFERENCE)[1][0])[inside]
    return np.asarray(np.fft.rfft(run.select(ChannelRole.RESPONSE)[1], axis=1)[:, inside] / force)


def miss(one: np.ndarray, other: np.ndarray) -> float:
    """Root of the squared difference over that of the other."""
    return float(np.linalg.norm(one - other) / np.linalg.norm(other))


@functools.cache
def plain() -> tuple[np.ndarray, np.ndarray]:
    """Both laboratories' accelerances without an effect, for all tests of effects."""
    return simulated(20), spectra(lab.campaign_of(scenario(8)))


def simulated(cells: int, *effects: EffectTable) -> np.ndarray:
    """The simulator's accelerances."""
    return spectra(simulated_campaign(scenario(cells).model_copy(update={"effect": effects}), engine="linear"))


def test_the_simulator_converges_to_the_second_laboratory() -> None:
    """Links and hinges are of second order in their length: doubling their number quarters what they miss."""
    there = spectra(lab.campaign_of(scenario(8)))
    coarse, fine = (miss(simulated(cells), there) for cells in (8, 16))
    assert fine < 0.4 * coarse
    assert fine < 0.1


def test_at_a_low_sample_rate_nothing_folds_into_the_band() -> None:
    """The other laboratory has no samples to alias. Without the converter's filter 19 % is missed of single lines."""
    slow = [
        s.model_copy(update={"acquisition": s.acquisition.model_copy(update={"sample_rate_hz": 100.0})})
        for s in (scenario(32), scenario(8))
    ]
    here, there = spectra(simulated_campaign(slow[0], engine="linear")), spectra(lab.campaign_of(slow[1]))
    scale = np.hypot(np.abs(there), np.median(np.abs(there), axis=1, keepdims=True))
    assert (np.abs(here - there) / scale).max() < 0.05


CHANGES = {
    "local-absorber": ({"mass_kg": 0.1, "frequency_hz": 11.0, "x_m": 0.9, "y_m": 1.2},
                       twins.local_absorber(0.1, 11.0, 0.02, 0.9, 1.2)),
    "added-mass": ({"mass_kg": 0.1, "x_m": 0.9, "y_m": -1.2}, twins.added_mass(0.1, 0.9, -1.2)),
    "suspension-surge": ({"mass_kg": 0.5, "loss_factor": 0.01}, twins.suspension_surge(0.5, 0.01)),
    "root-compliance": ({"bending": 0.1, "torsion": 0.05, "side": "right"},
                        twins.root_compliance(0.1, 0.05, ("-right",))),
    "stinger-moment": ({"rotational_stiffness_n_m_per_rad": 20.0, "loss_factor": 0.01}, twins.stinger_moment(20.0)),
    "channel-delay": ({"channels": "response", "delay_s": 1e-3}, twins.channel_delay(NODES, 1e-3)),
    "drive-point-offset": ({"dx_m": 0.03, "dy_m": 0.02}, twins.drive_point_offset(0.03, 0.02)),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", CHANGES)
def test_both_laboratories_mean_the_same_by_an_effect(name: str) -> None:
    """What an effect changes agrees to a fraction of the change; the plain aircraft agree to a few per cent."""
    values, change = CHANGES[name]
    here, there = plain()
    with_it = simulated(20, EffectTable(name=name, **values))
    there_with_it = spectra(lab.campaign_of(scenario(8), (change,)))
    changed = np.linalg.norm(there_with_it - there) / np.linalg.norm(there)
    assert changed > 0.05, "the effect must show"
    assert miss(with_it, there_with_it) < 0.5 * changed
    assert miss(with_it, there_with_it) < 3 * miss(here, there) + 0.02


def one_run() -> lab.Rig:
    """The only run of the small scenario."""
    return lab.rig_of(scenario(8), 0)


@pytest.mark.parametrize("name", sorted(twins.TWINS))
def test_every_twin_changes_what_is_recorded(name: str) -> None:
    rig = replace(one_run(), seats=NODES, labels=NODES)
    late = lab.rig_of(scenario(8).model_copy(update={"acquisition": two_runs()}), 1)
    change, settings = twins.TWINS[name](np.random.default_rng(1), NODES)
    make_effect(name, "test", **settings)
    changed, before = change(late, 1), lab.accelerances(late, BAND_HZ)
    assert changed.labels != rig.labels or miss(lab.accelerances(changed, BAND_HZ), before) > 1e-3


def two_runs() -> object:
    """An acquisition with a second run, for what differs between runs."""
    return scenario(8).acquisition.model_copy(update={"runs": (NODES, NODES)})


@pytest.mark.parametrize("name", sorted(never.UNCATALOGUED))
def test_every_uncatalogued_effect_shows_far_above_noise(name: str) -> None:
    rig = lab.rig_of(scenario(8).model_copy(update={"acquisition": two_runs()}), 1)
    change, node = never.UNCATALOGUED[name](np.random.default_rng(2), NODES)
    assert node is None or node in NODES
    assert miss(lab.accelerances(change(rig, 1), BAND_HZ), lab.accelerances(rig, BAND_HZ)) > 0.005


def test_a_surge_far_below_its_first_resonance_is_a_third_of_the_springs_mass() -> None:
    """k g cot g = k - ω² m / 3 - …: Rayleigh's third."""
    rig, low = one_run(), np.array([0.5, 0.8])
    mass = 0.05
    surge = lab.accelerances(twins.suspension_surge(mass, 0.0)(rig, 0), low)
    hook = rig.model.motion_at(np.array(rig.scenario.suspension.hook_m))[2]
    lumped = lab.accelerances(rig.coupled(lab.Coupling(hook, hook, twins.lump(mass / 3))), low)
    before = lab.accelerances(rig, low)
    assert miss(surge - before, lumped - before) < 0.05


def test_a_rigid_absorber_is_a_mass() -> None:
    rig = one_run()
    stiff = lab.accelerances(twins.local_absorber(0.05, 3000.0, 0.0, 0.9, 1.2)(rig, 0), BAND_HZ)
    row = lab.UP @ rig.at(0.9, 1.2)[:3]
    lump = lab.accelerances(rig.coupled(lab.Coupling(row, row, twins.lump(0.05))), BAND_HZ)
    assert miss(stiff, lump) < 1e-3


def test_records_are_the_forced_answer() -> None:
    """The records' own ratio is the accelerance where the sweep is, but for what rings beyond their end."""
    small = scenario(8)
    campaign = lab.campaign_of(small)
    (run,) = campaign.runs
    frequency = np.fft.rfftfreq(run.samples.shape[1], 1 / run.sample_rate_hz)
    inside = frequency[(frequency > 4.0) & (frequency < 34.0)]
    assert miss(spectra(campaign), lab.accelerances(lab.rig_of(small, 0), inside)) < 0.15


def test_only_the_gyroscope_breaks_reciprocity() -> None:
    """Push at one sensor and read the other, and the other way round."""

    def across(rig: lab.Rig) -> float:
        there, back = (replace(rig, seats=(s,), labels=(s,)) for s in (1, 20))
        rows = rig.seat(1), rig.seat(20)

        def pushed(own: lab.Rig, row: np.ndarray) -> np.ndarray:
            mass, damping, stiffness = lab.hung(replace(rig, seats=NODES))
            omega = 2 * np.pi * 12.0
            matrix = stiffness + 1j * omega * damping - omega**2 * mass
            for c in own.couplings:
                matrix = matrix + c.law(np.array([omega]))[0] * np.outer(c.left, c.right)
            return np.asarray(np.linalg.solve(matrix, row.astype(complex)))

        one, other = rows[0] @ pushed(there, rows[1]), rows[1] @ pushed(back, rows[0])
        return float(abs(one - other) / abs(one))

    rig = one_run()
    assert across(rig) < 1e-9
    assert across(never.tip_link(50.0, 1.0)(rig, 0)) < 1e-9
    assert across(never.rotor(1.0)(rig, 0)) > 1e-4
