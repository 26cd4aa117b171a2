"""Predictions: the rig's responses against the state-space model, and the laws of time and level."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt.planning.informed import estimates
from vgvt.planning.prediction import Prediction, predict
from vgvt.planning.system import seen_by, systems_of
from vgvt.scenario import load_scenario
from vgvt.scenario.rig import Excitation
from vgvt.simulation.assembly import plans
from vgvt.simulation.command import sample_times_s, sent_commands
from vgvt.simulation.command_spectra import command_spectra
from vgvt.simulation.fisher import accelerance
from vgvt.simulation.truth import driven_state_space, truth_of


def with_excitation(scenario, **changes):
    return scenario.model_copy(update={"excitation": scenario.excitation.model_copy(update=changes)})


def with_repeats(scenario, repeats):
    acquisition = scenario.acquisition.model_copy(update={"repeats": repeats})
    return scenario.model_copy(update={"acquisition": acquisition})


def test_force_and_accelerance_are_those_of_the_driven_rig(light) -> None:
    (system,) = systems_of(light)
    _, model = driven_state_space(plans(light)[0], 0)
    for hz in (6.0, 8.1, 15.6, 24.0, 31.5):
        identity = np.eye(model.state_matrix.shape[0])
        state = np.linalg.solve(2j * np.pi * hz * identity - model.state_matrix, model.inputs[:, 0])
        outputs = model.output_matrix @ state + model.feedthrough_rows[:, 0]
        assert system.force_per_volt(np.array([hz]))[0] == pytest.approx(outputs[-1], rel=1e-8)
        mine = accelerance(np.array([hz]), system.modes.poles, system.residues)[:, 0]
        theirs = outputs[:-1] / outputs[-1]
        # What tilt feels of gravity is left out here, and what lies above the truth's last mode.
        assert np.abs(mine - theirs).max() < 0.03 * np.abs(theirs).max()


def test_the_energy_of_a_sweep(light) -> None:
    layout = plans(light)[0]
    lines = seen_by(systems_of(light)[0]).lines
    energy = command_spectra(layout, 0, lines)[:, 0, 0].real
    e = light.excitation
    chirp = e.amplitude_v**2 * e.duration_s / (4 * (e.stop_hz - e.start_hz))
    inside = (lines.frequency_hz > 6) & (lines.frequency_hz < 30)
    assert np.average(energy[inside], weights=lines.width_hz[inside]) == pytest.approx(chirp, rel=0.02)
    sent = sent_commands(layout, 0, sample_times_s(light))[0]
    total = (sent**2).sum() / light.acquisition.sample_rate_hz
    assert 2 * (energy * lines.width_hz).sum() == pytest.approx(total, rel=0.05)


def test_four_times_the_time_or_twice_the_level_halve_the_deviations(light) -> None:
    base = predict(light)
    longer = predict(with_excitation(light, duration_s=4 * light.excitation.duration_s))
    louder = predict(with_excitation(light, amplitude_v=2 * light.excitation.amplitude_v))
    again = predict(with_repeats(light, 4))
    assert len(base.modes) == 3
    for k, mode in enumerate(base.modes):
        assert louder.modes[k].damping_ratio_std == pytest.approx(mode.damping_ratio_std / 2, rel=1e-6)
        assert again.modes[k].frequency_std_hz == pytest.approx(mode.frequency_std_hz / 2, rel=1e-6)
        assert longer.modes[k].damping_ratio_std == pytest.approx(mode.damping_ratio_std / 2, rel=0.05)


def test_a_narrow_sweep_gains_the_root_of_its_width(light) -> None:
    """std(f) goes with the root of the swept band where the tails are not needed (closed form of one mode)."""
    base = predict(light)
    narrow = predict(with_excitation(light, start_hz=5.0, stop_hz=13.0))
    gain = base.modes[0].frequency_std_hz / narrow.modes[0].frequency_std_hz
    assert gain == pytest.approx(np.sqrt(32 / 8), rel=0.15)


def test_roving_runs_share_the_information(light) -> None:
    """Ten points two at a time know as much as ten at once with a fifth of the energy, noise of the force apart."""
    nodes = light.acquisition.runs[0]
    pairs = tuple(tuple(nodes[k : k + 2]) for k in range(0, 10, 2))
    no_mass = light.accelerometers.model_copy(update={"mass_kg": 0.0})
    quiet_force = light.transducer.model_copy(update={"noise": None, "sensitivity_v_per_n": 1e4})
    still = light.model_copy(update={"accelerometers": no_mass, "transducer": quiet_force})
    roving = still.model_copy(update={"acquisition": still.acquisition.model_copy(update={"runs": pairs})})
    for one, many in zip(predict(still).modes, predict(roving).modes, strict=True):
        assert many.damping_ratio_std == pytest.approx(one.damping_ratio_std, rel=0.02)


def test_another_exciter_is_refused() -> None:
    with pytest.raises(InputError, match="plans are made for one shaker"):
        predict(load_scenario("teaching-beam-hammer"))


def test_the_bound_of_the_truth_is_what_the_best_fit_is_predicted_to_reach(light) -> None:
    """The prediction takes a short cut with the noise of the force, which can make it a little larger, not smaller."""
    tested = truth_of(light).as_tested[0].band(*light.excitation.band_hz)
    for k, mode in enumerate(predict(light).modes):
        assert 0.98 < tested.natural_frequency_std_hz[k] / mode.frequency_std_hz <= 1 + 1e-9
        assert 0.98 < tested.damping_ratio_std[k] / mode.damping_ratio_std <= 1 + 1e-9


@pytest.mark.parametrize("kind", ["linear-chirp", "random"])
def test_a_band_that_begins_at_0_hz_is_foretold_as_one_that_begins_beside_it(light, kind) -> None:
    """An accelerance is nothing there, and no more is told: yet no mode was seen, and the drive point moved by nan."""

    def expected(start_hz: float) -> Prediction:
        e = Excitation(kind=kind, start_hz=start_hz, stop_hz=35.0, duration_s=17.5, amplitude_v=0.3, ring_down_s=2.0)
        return predict(light.model_copy(update={"excitation": e}))

    zero, beside = expected(0.0), expected(0.01)
    assert len(zero.modes) == len(beside.modes)
    # Rigid-body motions hang on the few lines that there are so far down, of noise above all.
    for mode, other in list(zip(zero.modes, beside.modes, strict=True))[-3:]:
        assert mode.relative_damping_std == pytest.approx(other.relative_damping_std, rel=0.1)
    assert zero.peak_drive_mm == pytest.approx(beside.peak_drive_mm, rel=0.1)
    assert zero.peak_force_n == pytest.approx(beside.peak_force_n, rel=0.05)


@pytest.mark.slow
def test_no_simulated_scatter_is_far_from_the_bound_of_the_truth(light) -> None:
    """Frequencies and damping ratios of 100 campaigns, by the fit that is told the noise: each ratio within 7 %."""
    scatter = np.array(list(estimates(light, range(100)))).std(axis=0, ddof=1)
    tested = truth_of(light).as_tested[0].band(*light.excitation.band_hz)
    ratio = scatter / np.array([tested.natural_frequency_std_hz, tested.damping_ratio_std])
    assert np.abs(ratio - 1).max() < 0.25, ratio
