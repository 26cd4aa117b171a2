"""A lab within its tolerances: what is drawn scatters as they say, and is an aircraft that there can be."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.stats

from vgvt.data import ChannelRole
from vgvt.effects.beams import plain_name, written_out
from vgvt.reconcile.question.drawn import drawn_gains, drawn_lab
from vgvt.reconcile.question.stretches import with_stretches
from vgvt.reconcile.question.uncertain import long_beams, prepared
from vgvt.reconcile.rehearsal import placebo_campaign
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.axis import beam_axis
from vgvt.scenario.library import bundled_scenarios
from vgvt.scenario.tolerances import Tolerances

DRAWS = 60
# Chi-square bounds of a variance from so many draws, each side at one in two thousand.
LOW, HIGH = scipy.stats.chi2.ppf([0.0005, 0.9995], DRAWS - 1)
EXACT = dict.fromkeys(Tolerances.model_fields, 0.0) | {"segments": 4}


@pytest.fixture(scope="module")
def quick() -> Scenario:
    return load_scenario("quick")


@pytest.fixture(scope="module")
def labs(quick: Scenario) -> list[Scenario]:
    g = np.random.default_rng(8)
    return [drawn_lab(quick, g) for _ in range(DRAWS)]


def relative(labs: list[Scenario], of: object, stated: float) -> np.ndarray:
    return np.log([of(lab) / stated for lab in labs])  # type: ignore[operator]


@pytest.mark.parametrize(
    ("tolerance", "of"),
    [
        ("stiffness_scale", lambda s: np.exp(np.mean(np.log(s.airframe.beam[0].stations.bending_stiffness_n_m2)))),
        ("body_mass", lambda s: s.airframe.body.mass_kg),
        ("inertia", lambda s: s.airframe.body.inertia_kg_m2[1]),
        ("item_mass", lambda s: s.airframe.item[0].mass_kg),
        ("damping", lambda s: s.airframe.damping.modal[0]),
        ("suspension_stiffness", lambda s: s.suspension.stiffness_n_per_m),
        ("transducer_end_mass", lambda s: s.transducer.end_mass_kg),
        ("sensor_mass", lambda s: s.accelerometers.mass_kg),
        ("high_pass", lambda s: s.transducer.high_pass_hz),
    ],
)
def test_factors_scatter_as_stated(quick: Scenario, labs: list[Scenario], tolerance: str, of) -> None:
    stated = getattr(quick.tolerances, tolerance)
    if tolerance == "stiffness_scale":  # the mean of a side's own scatter comes on top
        stated = np.hypot(stated, quick.tolerances.stiffness_segment / 2)
    logs = relative(labs, of, of(quick))
    assert LOW < (DRAWS - 1) * np.var(logs, ddof=1) / stated**2 < HIGH


def test_lengths_scatter_as_stated(quick: Scenario, labs: list[Scenario]) -> None:
    for at, stated in ((lambda s: s.suspension.hook_m, "hook_m"), (lambda s: s.shaker.position_m, "drive_point_m")):
        moved = np.array([at(lab) for lab in labs]) - np.array(at(quick))
        for column in moved.T[:2]:
            assert LOW < (DRAWS - 1) * np.var(column, ddof=1) / getattr(quick.tolerances, stated) ** 2 < HIGH
    assert np.ptp([lab.shaker.position_m[2] for lab in labs]) == 0.0


def test_what_is_known_exactly_stays(quick: Scenario) -> None:
    exact = quick.model_copy(update={"tolerances": Tolerances(**EXACT)})
    lab = drawn_lab(exact, np.random.default_rng(1))
    assert lab.airframe.body == exact.airframe.body
    assert lab.suspension == exact.suspension
    assert lab.transducer == exact.transducer
    whole = exact.airframe.beam[0].stations
    for side in lab.airframe.beam[:2]:
        assert np.interp(0.5, [0, 1], side.stations.bending_stiffness_n_m2[:2]) == pytest.approx(
            np.interp(0.5, [0, 1], whole.bending_stiffness_n_m2[:2]), rel=1e-9
        )


@pytest.mark.parametrize("name", ["quick", "bff", "garteur-sm-ag19", "teaching-beam"])
def test_it_scatters_at_other_stations_than_the_analysis(name: str) -> None:
    """One more on a side of a long beam, and none of them within it the same."""
    scenario = load_scenario(name)
    analysis = prepared(with_stretches(scenario, np.ceil(scenario.excitation.band_hz[1])))
    lab, long = drawn_lab(scenario, np.random.default_rng(1)), long_beams(analysis)
    stated = {b.name: beam_axis(b).arc_length_m for b in written_out(scenario).airframe.beam}
    for one, other in zip(analysis.airframe.beam, lab.airframe.beam, strict=True):
        if one.name in long:
            mine, theirs = (
                [s for s in beam_axis(b).arc_length_m if np.abs(stated[one.name] - s).min() > 1e-6]
                for b in (one, other)
            )
            assert theirs and np.abs(np.subtract.outer(mine, theirs)).min(initial=1.0) > 1e-3


def test_nothing_scatters_along_a_beam_that_has_no_stretches() -> None:
    """The analysis has none then, and would miss them in every placebo: a hundred times its limit."""
    scenario = load_scenario("teaching-beam")
    none = scenario.model_copy(update={"tolerances": scenario.tolerances.model_copy(update={"segments": 0})})
    for lab, scatters in (
        (drawn_lab(none, np.random.default_rng(1)), False),
        (drawn_lab(scenario, np.random.default_rng(1)), True),
    ):
        stations = lab.airframe.beam[0].stations
        for column in ("bending_stiffness_n_m2", "torsional_stiffness_n_m2", "mass_kg_per_m"):
            assert (np.ptp(getattr(stations, column)) > 1e-9) == scatters
    assert drawn_lab(none, np.random.default_rng(1)).airframe.beam[0].stations.bending_stiffness_n_m2[0] != 40.0


def test_each_beam_is_off_by_itself_and_its_sides_alike() -> None:
    """A wing's EI says nothing of a fuselage's, in a lab as in the analysis."""
    stated = load_scenario("garteur-sm-ag19")
    even = stated.model_copy(update={"tolerances": stated.tolerances.model_copy(update={"stiffness_segment": 0.0})})
    factors: dict[str, set[float]] = {}
    for beam in drawn_lab(even, np.random.default_rng(0)).airframe.beam:
        own = next(b for b in stated.airframe.beam if b.name == plain_name(beam.name))
        for column in ("bending_stiffness_n_m2", "torsional_stiffness_n_m2", "pitch_inertia_kg_m"):
            factor = getattr(beam.stations, column)[0] / getattr(own.stations, column)[0]
            factors.setdefault(f"{own.name} {column}", set()).add(round(factor, 9))
    assert {len(found) for found in factors.values()} == {1}
    assert len(set.union(*factors.values())) == len(factors)


def test_it_has_more_cells_than_the_analysis_unless_that_has_many(quick: Scenario) -> None:
    stated = quick.airframe.beam[0].cells
    assert {b.cells for b in drawn_lab(quick, np.random.default_rng(1)).airframe.beam[:2]} == {5 * stated}
    many = tuple(b.model_copy(update={"cells": 40}) for b in quick.airframe.beam)
    fine = quick.model_copy(update={"airframe": quick.airframe.model_copy(update={"beam": many})})
    assert {b.cells for b in drawn_lab(fine, np.random.default_rng(1)).airframe.beam} == {80}
    assert {b.cells for b in drawn_lab(quick, np.random.default_rng(1), 7).airframe.beam} == {7}


@pytest.mark.parametrize("name", bundled_scenarios())
def test_a_body_is_one_that_there_can_be(name: str) -> None:
    """No principal inertia is more than the two others together, however wide the tolerance."""
    scenario = load_scenario(name)
    wide = scenario.model_copy(update={"tolerances": scenario.tolerances.model_copy(update={"inertia": 0.8})})
    for seed in range(20):
        inertia = sorted(drawn_lab(wide, np.random.default_rng(seed)).airframe.body.inertia_kg_m2)
        assert 0 < inertia[0] <= inertia[1] <= inertia[2] <= (inertia[0] + inertia[1]) * (1 + 1e-9)


def test_a_sensor_keeps_its_sensitivity_from_run_to_run_and_the_drive_is_no_instrument(quick: Scenario) -> None:
    brief = quick.model_copy(
        update={
            "excitation": quick.excitation.model_copy(update={"duration_s": 4.0, "ring_down_s": 1.0}),
            "acquisition": quick.acquisition.model_copy(update={"runs": ((1, 6), (3, 8))}),
        }
    )
    campaign = placebo_campaign(brief, 1)
    roles = [c.role for c in campaign.runs[0].channels]

    def gains(gain: float, channel_gain: float) -> list[np.ndarray]:
        tolerances = Tolerances(gain=gain, channel_gain=channel_gain)
        read = drawn_gains(campaign, tolerances, np.random.default_rng(2))
        pairs = zip(read.runs, campaign.runs, strict=True)
        return [r.samples.std(axis=1) / s.samples.std(axis=1) for r, s in pairs]

    one, other = gains(0.05, 0.0)
    np.testing.assert_allclose(one, other, rtol=1e-12)
    assert [abs(g - 1) < 1e-12 for g in one] == [role is ChannelRole.DRIVE for role in roles]
    one, other = gains(0.0, 0.05)
    for k, role in enumerate(roles):
        assert (abs(one[k] - other[k]) > 1e-6) == (role is ChannelRole.RESPONSE)
