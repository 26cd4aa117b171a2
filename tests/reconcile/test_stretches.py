"""How many stretches of a beam vary on their own: by the shortest wave within the band, and what fewer leave."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from vgvt.reconcile import Fit, augment, calibrate, make_problem, residual, thresholds_for
from vgvt.reconcile.decision import reasons
from vgvt.reconcile.outcome.cells import at_whole_cells
from vgvt.reconcile.question.stretches import half_waves, with_stretches
from vgvt.reconcile.question.uncertain import edited
from vgvt.reconcile.rehearsal import placebo_campaign
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.airframe import Beam

# Of a cantilever's first modes in bending, roots of cos x cosh x = -1 (Blevins, 1979, table 8-1).
CANTILEVER = (1.87510407, 4.69409113, 7.85475744, 10.99554073)
EI, GJ, MASS, INERTIA, LENGTH = 40.0, 20.0, 1.0, 0.01, 1.0


@pytest.fixture(scope="module")
def teaching() -> Scenario:
    return load_scenario("teaching-beam")


def beam(**columns: float) -> Beam:
    stations = {
        "position_m": [[0.0, 0.0, 0.0], [0.0, LENGTH, 0.0]],
        "bending_stiffness_n_m2": [EI, EI],
        "torsional_stiffness_n_m2": [GJ, GJ],
        "mass_kg_per_m": [MASS, MASS],
        "pitch_inertia_kg_m": [INERTIA, INERTIA],
        "forward_edge_m": [0.1, 0.1],
        "aft_edge_m": [0.1, 0.1],
    }
    stations |= {name: [value, value] for name, value in columns.items()}
    return Beam.model_validate({"name": "wing", "stations": stations})


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_a_cantilever_has_half_a_half_wave_less_than_modes(n: int) -> None:
    bending_hz = CANTILEVER[n - 1] ** 2 / (2 * np.pi * LENGTH**2) * np.sqrt(EI / MASS)
    # Its first mode is shorter than a wave that goes along it; all others are what they are called.
    expected = CANTILEVER[n - 1] / np.pi
    assert half_waves(beam(torsional_stiffness_n_m2=1e6), bending_hz) == pytest.approx(expected, rel=1e-6)
    assert expected == pytest.approx(n - 0.5, abs=0.1 if n == 1 else 0.01)
    torsion_hz = (2 * n - 1) / (4 * LENGTH) * np.sqrt(GJ / INERTIA)
    assert half_waves(beam(bending_stiffness_n_m2=1e9), torsion_hz) == pytest.approx(n - 0.5, rel=1e-6)


def test_air_and_offsets_make_waves_shorter() -> None:
    """Inertia about the axis is what torsion turns; air is carried along in bending and in torsion."""
    frequency_hz = 30.0
    whole = half_waves(beam(torsional_stiffness_n_m2=1e6), frequency_hz)
    air = half_waves(beam(torsional_stiffness_n_m2=1e6, air_kg_per_m=3 * MASS), frequency_hz)
    assert air == pytest.approx(4**0.25 * whole, rel=1e-9)
    still = half_waves(beam(bending_stiffness_n_m2=1e9), frequency_hz)
    offset = half_waves(beam(bending_stiffness_n_m2=1e9, cg_offset_m=np.sqrt(3 * INERTIA / MASS)), frequency_hz)
    assert offset == pytest.approx(2 * still, rel=1e-9)
    moved = half_waves(
        beam(
            bending_stiffness_n_m2=1e9, air_kg_per_m=0.1, air_offset_m=0.2, air_pitch_inertia_kg_m=3 * INERTIA - 0.004
        ),
        frequency_hz,
    )
    assert moved == pytest.approx(2 * still, rel=1e-9)


def test_waves_are_counted_where_they_are_short() -> None:
    """A wing whose EI falls to a sixteenth along it: the phase of its wave, integrated by hand."""
    frequency_hz, lost = 30.0, 15 / 16
    tapered = beam(torsional_stiffness_n_m2=1e6)
    stations = tapered.stations.model_copy(update={"bending_stiffness_n_m2": (EI, (1 - lost) * EI)})
    wave_per_m = (MASS * (2 * np.pi * frequency_hz) ** 2 / EI) ** 0.25
    phase = wave_per_m * LENGTH * (1 - (1 - lost) ** 0.75) / (0.75 * lost)
    found = half_waves(tapered.model_copy(update={"stations": stations}), frequency_hz)
    assert found == pytest.approx(phase / np.pi, rel=1e-4)


@pytest.mark.parametrize(
    ("name", "stations"),
    [("quick", 4), ("hati-unsymmetric", 4), ("bff", 5), ("garteur-sm-ag19", 5), ("teaching-beam", 6)],
)
def test_stations_that_the_band_asks_for(name: str, stations: int) -> None:
    scenario = load_scenario(name)
    assert scenario.tolerances.segments is None
    found = with_stretches(scenario, np.ceil(scenario.excitation.band_hz[1]))
    assert found.tolerances.segments == stations
    assert found == scenario.model_copy(update={"tolerances": found.tolerances})


def test_what_a_file_says_counts_and_there_are_bounds(teaching: Scenario) -> None:
    for stated in (0, 3, 12):
        said = teaching.model_copy(update={"tolerances": teaching.tolerances.model_copy(update={"segments": stated})})
        assert with_stretches(said, 1e4) is said
    assert with_stretches(teaching, 0.1).tolerances.segments == 4
    assert with_stretches(teaching, 1e4).tolerances.segments == 12


@pytest.mark.parametrize(("stated", "told"), [(None, False), (6, False), (12, False), (4, True), (0, True)])
def test_fewer_than_the_band_asks_for_are_told_beside_what_is_left(
    teaching: Scenario, stated: int | None, told: bool
) -> None:
    tolerances = teaching.tolerances.model_copy(update={"segments": stated})
    scenario = with_stretches(teaching.model_copy(update={"tolerances": tolerances}), 40.0)
    measured = SimpleNamespace(frequency_hz=np.array([2.0, 39.6]))
    said = reasons._of_few_stretches(SimpleNamespace(scenario=scenario, measured=measured))  # type: ignore[arg-type]
    assert bool(said) == told
    assert all(f"segments = {stated}," in words and "would have 6" in words for words in said)
    known = scenario.tolerances.model_copy(update={"stiffness_segment": 0.0, "mass_segment": 0.0})
    even = SimpleNamespace(scenario=scenario.model_copy(update={"tolerances": known}), measured=measured)
    assert reasons._of_few_stretches(even) == []  # type: ignore[arg-type]


@pytest.mark.slow
def test_four_stretches_leave_what_those_that_the_band_asks_for_do_not(
    teaching: Scenario, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """A placebo of a uniform beam with ideal sensors: with fewer it would be called unknown, as are six of twelve."""
    cache, campaign = tmp_path_factory.mktemp("cache"), placebo_campaign(teaching, 5)
    left, limits = [], []
    for segments in (None, 4):
        tolerances = teaching.tolerances.model_copy(update={"segments": segments})
        problem = make_problem(campaign, teaching.model_copy(update={"tolerances": tolerances}), lines=100, cache=cache)
        count = sum(u.name.startswith("EI beam-right") for u in problem.unknowns)
        assert count == (segments or 6)
        found = calibrate(problem)
        limits.append(thresholds_for(problem))
        left.append(residual(found, limits[-1]).train_chi2_per_dof)
        _is_written(found, problem.stated.model_copy(update={"tolerances": tolerances}))
    assert left[0] < 0.1 * limits[0].chi2_per_dof
    assert left[1] > limits[1].chi2_per_dof


def _is_written(found: Fit, scenario: Scenario) -> None:
    """What is written holds the stretches that were fitted, and leaves it to the next band how many there are."""
    written = augment(scenario, SimpleNamespace(final=found))  # type: ignore[arg-type]
    assert written.tolerances == scenario.tolerances
    final = at_whole_cells(found)
    expected = edited(final.problem.scenario, final.problem.unknowns, final.u[: len(final.problem.unknowns)])
    for column in ("bending_stiffness_n_m2", "torsional_stiffness_n_m2", "mass_kg_per_m"):
        for one, other in zip(written.airframe.beam, expected.airframe.beam, strict=True):
            assert getattr(one.stations, column) == getattr(other.stations, column)
