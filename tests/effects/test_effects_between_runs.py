"""Changes between runs: the schedule, and what each does to the truth run by run."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt.effects import make_effect
from vgvt.effects.conformance import with_effect
from vgvt.effects.run_schedule import progress
from vgvt.scenario import Scenario
from vgvt.scenario.effect import EffectTable
from vgvt.scenario.mass import rigid_body_properties
from vgvt.simulation import simulate, truth_of
from vgvt.simulation.attitude import attitudes_deg
from vgvt.simulation.effect_conformance import example_scenario


@pytest.fixture(scope="module")
def four_runs() -> Scenario:
    """The same two sensors in four runs, weightless, so that nothing but the effect changes from run to run."""
    scenario = example_scenario()
    return scenario.model_copy(
        update={
            "acquisition": scenario.acquisition.model_copy(update={"runs": ((1, 10),) * 4}),
            "accelerometers": scenario.accelerometers.model_copy(update={"mass_kg": 0.0}),
        }
    )


def frequencies(scenario: Scenario, name: str, **values: object) -> np.ndarray:
    """Natural frequencies of the elastic modes as tested, (runs, modes)."""
    truth = truth_of(with_effect(scenario, make_effect(name, "test", **values)))
    return np.array([run.band(4.0, 36.0).natural_frequency_hz for run in truth.as_tested])


def test_schedules_start_at_nothing_and_end_at_everything() -> None:
    """Linear and exponential go from 0 to 1 over the runs; a step happens at its run; one run has no drift."""
    for shape in ("linear", "exponential"):
        course = [progress(shape, run, 6, 2.0, 2) for run in range(6)]
        assert course[0] == 0.0
        assert course[-1] == pytest.approx(1.0)
        assert all(b > a for a, b in itertools.pairwise(course))
        assert progress(shape, 0, 1, 2.0, 2) == 0.0
    assert [progress("linear", run, 5, 1.0, 2) for run in range(5)] == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert progress("exponential", 2, 6, 2.0, 2) == pytest.approx((1 - math.exp(-1)) / (1 - math.exp(-2.5)))
    assert [progress("step", run, 4, 1.0, 3) for run in range(4)] == [0.0, 0.0, 1.0, 1.0]


@pytest.mark.parametrize("drift", [-0.04, 0.04])
def test_drift_moves_elastic_modes_by_the_root_of_stiffness(four_runs: Scenario, drift: float) -> None:
    """f ~ sqrt(EI): the last run's modes are sqrt(1 + drift) times the first's; the suspension takes a little."""
    f = frequencies(four_runs, "run-drift", drift=drift)
    np.testing.assert_allclose(f[-1] / f[0], math.sqrt(1 + drift), rtol=2e-3)
    np.testing.assert_allclose(f[1] / f[0], math.sqrt(1 + drift / 3), rtol=1e-3)


@pytest.mark.parametrize("drift_first", [False, True])
@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("run-drift", {"drift": -0.2}),
        ("temperature-change", {"warming_k": 10.0, "stiffness_per_k": -0.02, "damping_per_k": 0.0}),
    ],
)
def test_the_carry_through_drifts_along(
    four_runs: Scenario, name: str, values: dict[str, float], drift_first: bool
) -> None:
    """A mode in which the body's halves rock against each other is all of it spring: 7.88 Hz had hardly moved."""
    drift = EffectTable(name=name, **values)
    halves = EffectTable(name="carry-through-torsion", compliance_rad_per_n_m=0.01)
    tables = (drift, halves) if drift_first else (halves, drift)
    truth = truth_of(four_runs.model_copy(update={"effect": tables}))
    f = np.array([run.band(4.0, 36.0).natural_frequency_hz for run in truth.as_tested])
    assert f[0][0] == pytest.approx(7.88, abs=0.05)
    np.testing.assert_allclose(f[-1] / f[0], math.sqrt(0.8), rtol=5e-3)


@pytest.mark.parametrize("y_m", [0.6, -1.07])
def test_a_payload_is_the_lump_that_an_added_mass_is(four_runs: Scenario, y_m: float) -> None:
    """Between two links both share it alike: torsion had dropped by 0.70 % for the one and by 1.38 % for the other."""
    lump = {"mass_kg": 0.05, "x_m": 0.75, "y_m": y_m}
    later, always, bare = (
        truth_of(four_runs.model_copy(update={"effect": tables})).as_tested[-1].natural_frequency_hz
        for tables in ((EffectTable(name="payload-change", **lump),), (EffectTable(name="added-mass", **lump),), ())
    )
    # The airframe's own damping is found with the one and without the other.
    np.testing.assert_allclose(later, always, rtol=1e-5)
    assert np.abs(later / bare - 1).max() > 3e-3


def test_a_step_leaves_the_runs_before_and_after_alike(four_runs: Scenario) -> None:
    """Runs 1 and 2 share their modes, and so do runs 3 and 4."""
    f = frequencies(four_runs, "run-drift", drift=0.03, shape="step", from_run=3)
    np.testing.assert_array_equal(f[0], f[1])
    np.testing.assert_array_equal(f[2], f[3])
    assert np.abs(f[2] / f[1] - 1).min() > 0.01


def test_warming_softens_and_damps(four_runs: Scenario) -> None:
    """Frequencies by half the stiffness, damping ratios of the bare modes by their own coefficient."""
    effect = make_effect("temperature-change", "test", warming_k=8.0, stiffness_per_k=-1e-3, damping_per_k=0.02)
    truth = truth_of(with_effect(four_runs, effect))
    first, last = (truth.as_tested[run].band(4.0, 36.0) for run in (0, -1))
    ratio = last.natural_frequency_hz / first.natural_frequency_hz
    np.testing.assert_allclose(ratio, math.sqrt(1 - 0.008), rtol=1e-3)
    assert (last.damping_ratio / first.damping_ratio)[-1] == pytest.approx(1.16, abs=0.02)


def test_payload_shifts_poles_by_half_phi_squared_m(four_runs: Scenario) -> None:
    """Rayleigh: df / f = -phi^2 m / 2 at the mass, phi mass-normalised, for a small mass at the drive point."""
    mass = 2e-3
    x, y, _ = four_runs.shaker.position_m
    effect = make_effect("payload-change", "test", mass_kg=mass, x_m=x, y_m=y)
    truth = truth_of(with_effect(four_runs, effect))
    before, after = (truth.as_tested[run].band(4.0, 36.0) for run in (0, 1))
    expected = -0.5 * mass * before.shapes[:, -1].real ** 2 / before.modal_mass_kg
    shift = after.natural_frequency_hz / before.natural_frequency_hz - 1
    np.testing.assert_allclose(shift, expected, rtol=0.05, atol=2e-6)
    assert shift.min() < -5e-5


def test_gain_drift_scales_the_records_and_leaves_the_truth(four_runs: Scenario) -> None:
    """Responses of the last run are 1 + drift times the first's; force and poles stay."""
    effect = make_effect("gain-drift", "test", drift=0.06)
    result = simulate(with_effect(four_runs, effect), engine="linear")
    first, last = result.campaign.runs[0].samples, result.campaign.runs[-1].samples
    step = 1e-5 * np.abs(first).max(axis=1, keepdims=True)
    assert np.all(np.abs(last[2:] - 1.06 * first[2:]) < 20 * step[2:])
    np.testing.assert_array_equal(last[:2], first[:2])
    poles = [run.natural_frequency_hz for run in result.truth.as_tested]
    np.testing.assert_array_equal(poles[0], poles[-1])


def test_re_hanging_moves_rigid_modes_far_more_than_elastic_ones(four_runs: Scenario) -> None:
    """A hook 3 cm further aft changes the rigid-body modes by percent and elastic ones by less than a tenth of it."""
    truth = truth_of(with_effect(four_runs, make_effect("re-hang", "test", shift_x_m=0.03, from_run=3)))
    low = [run.band(0.05, 2.5).natural_frequency_hz for run in truth.as_tested]
    high = [run.band(4.0, 36.0).natural_frequency_hz for run in truth.as_tested]
    np.testing.assert_array_equal(low[0], low[1])
    rigid, elastic = np.abs(low[2] / low[1] - 1).max(), np.abs(high[2] / high[1] - 1).max()
    assert rigid > 0.01
    assert elastic < 0.1 * rigid


def test_remounting_the_drive_scales_residues_by_the_shape(four_runs: Scenario) -> None:
    """Where the shaker pushes on a node instead of elsewhere, the residues are those of a scenario that says so."""
    x, y, z = four_runs.shaker.position_m
    moved = four_runs.model_copy(
        update={"shaker": four_runs.shaker.model_copy(update={"position_m": (x + 0.02, y - 0.01, z)})}
    )
    effect = make_effect("drive-remount", "test", shift_x_m=0.02, shift_y_m=-0.01)
    truth = truth_of(with_effect(four_runs, effect))
    stated, before = truth_of(moved).as_tested[0], truth_of(four_runs).as_tested[0]
    np.testing.assert_allclose(truth.as_tested[0].residues, before.residues, rtol=1e-9)
    np.testing.assert_allclose(truth.as_tested[3].residues, stated.residues, rtol=1e-9)
    grid = slice(0, -1)
    change = np.abs(stated.residues[:, grid] - before.residues[:, grid]).max()
    assert change > 0.01 * np.abs(before.residues[:, grid]).max()


def test_impossible_changes_are_refused(four_runs: Scenario) -> None:
    """A stiffness below nothing, a step before the second run, a time constant of nothing."""
    with pytest.raises(InputError, match="smaller change"):
        truth_of(with_effect(four_runs, make_effect("run-drift", "test", drift=-1.5)))
    with pytest.raises(InputError, match="from_run must be 2 or more"):
        make_effect("re-hang", "test", from_run=1)
    with pytest.raises(InputError, match="time_constant_runs"):
        make_effect("run-drift", "test", time_constant_runs=0.0)


@pytest.mark.parametrize(("shift", "sign"), [("shift_x_m", (0.0, -1.0)), ("shift_y_m", (1.0, 0.0))])
@pytest.mark.parametrize("aside_m", [0.03, -0.03])
def test_re_hanging_tilts_until_the_hook_is_above_the_centre_of_gravity(
    four_runs: Scenario, shift: str, sign: tuple[float, float], aside_m: float
) -> None:
    """By atan(shift/h): a hook further aft lets the nose down, one further right the left wing."""
    cg = rigid_body_properties(four_runs.airframe).centre_of_gravity_m
    above_m = 0.4
    hook = four_runs.suspension.model_copy(update={"hook_m": (cg[0], cg[1], cg[2] + above_m)})
    scenario = four_runs.model_copy(update={"suspension": hook})
    tilted = with_effect(scenario, make_effect("re-hang", "test", from_run=3, **{shift: aside_m}))
    before, after = np.array(attitudes_deg(scenario)), np.array(attitudes_deg(tilted))
    np.testing.assert_array_equal(after[:2], before[:2])
    expected = np.outer([1.0, 1.0], sign) * math.degrees(math.atan(aside_m / above_m))
    np.testing.assert_allclose(after[2:] - before[2:], expected, atol=0.12)


@pytest.mark.parametrize("kind", ["bending", "torsion"])
def test_a_root_that_creeps_is_as_soft_as_it_has_become(four_runs: Scenario, kind: str) -> None:
    """A third of its compliance more in every run of a line, and nothing in the first."""
    crept = frequencies(four_runs, "root-creep", shape="linear", side="left", **{kind: 0.15})
    stated = frequencies(four_runs, "root-compliance", side="left", **{kind: 0.1})
    np.testing.assert_allclose(crept[2], stated[2], rtol=1e-6)
    np.testing.assert_array_equal(crept[0], truth_of(four_runs).as_tested[0].band(4.0, 36.0).natural_frequency_hz)
    assert np.all(np.diff(crept, axis=0).min(axis=1) < -1e-4 * crept[0].max())
