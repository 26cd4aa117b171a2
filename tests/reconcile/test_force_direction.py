"""A force is what its label says: a gauge read the other way round is no other test, along another axis it is one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from reconciled_case import roving_scenario

from vgvt.data import Campaign, ChannelRole, Dof, InputError
from vgvt.reconcile.fitting.fit import fit
from vgvt.reconcile.question.data import Measured, measured_frfs
from vgvt.reconcile.question.problem import CELLS, problem_of
from vgvt.reconcile.question.suitable import check_suitable
from vgvt.scenario import load_scenario
from vgvt.simulation import simulated_campaign


@pytest.fixture(scope="module")
def original() -> Campaign:
    """The scenario's own four runs, the force along +Z."""
    return simulated_campaign(roving_scenario(), engine="linear")


def with_force(campaign: Campaign, label: str, factor: float, *numbers: int) -> Campaign:
    """The same with another label on the force channel, and its samples times a factor, of some runs (none: all)."""
    runs = []
    for run in campaign.runs:
        changed = not numbers or run.run in numbers
        force = [c.role is ChannelRole.REFERENCE and changed for c in run.channels]
        channels = tuple(
            replace(c, dof=Dof.from_label(label)) if mine else c for c, mine in zip(run.channels, force, strict=True)
        )
        samples = run.samples * np.where(force, factor, 1.0)[:, None]
        runs.append(replace(run, channels=channels, samples=samples))
    return replace(campaign, runs=tuple(runs))


def same(one: Measured, other: Measured) -> None:
    for name in ("values", "noise", "sigma", "force", "pushed", "level_n", "of_force"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)
    for a, b in zip(one.endings, other.endings, strict=True):
        np.testing.assert_array_equal(a.last, b.last)


def test_a_gauge_read_the_other_way_round_tells_the_same(original: Campaign, tmp_path: Path) -> None:
    """All of it, in A/F and in what a march is pushed with; so it is as well foretold. It had come to χ² of 142."""
    scenario = roving_scenario()
    turned = with_force(original, "100-Z", -1.0)
    check_suitable(turned, scenario)
    there = measured_frfs(turned, lines=60)
    same(there, measured_frfs(original, lines=60))
    case = problem_of(there, scenario, cache=tmp_path)
    scores = np.zeros(case.size)
    scores[case.unknowns.index(CELLS)] = -3 / CELLS.sd  # the records come from the chain as stated
    assert fit(case, (), scores, np.zeros(0), ()).chi2_per_dof < 2


def test_the_label_alone_turns_the_answer_round(original: Campaign) -> None:
    """Else nothing that is said here would follow from the label."""
    given, turned = (measured_frfs(c, lines=60) for c in (original, with_force(original, "100-Z", 1.0)))
    np.testing.assert_array_equal(turned.values, -given.values)
    np.testing.assert_array_equal(turned.pushed, -given.pushed)
    np.testing.assert_array_equal(turned.noise, given.noise)


def test_runs_may_have_their_gauge_either_way_round(original: Campaign) -> None:
    mixed = with_force(original, "100-Z", -1.0, 2, 4)
    check_suitable(mixed, roving_scenario())
    same(measured_frfs(mixed, lines=60), measured_frfs(original, lines=60))


@pytest.mark.parametrize("label", ["100+X", "100-Y", "100+RZ", "100S"])
def test_another_axis_than_the_shaker_pushes_along_is_refused(original: Campaign, label: str) -> None:
    scenario = roving_scenario()
    with pytest.raises(InputError) as told:
        check_suitable(with_force(original, label, 1.0), scenario)
    for word in (f"force at {label}", f"shaker of scenario {scenario.name} pushes along +Z", "100-Z"):
        assert word in str(told.value)


def test_runs_along_two_axes_are_two_drives(original: Campaign) -> None:
    with pytest.raises(InputError, match=r"driven at 2 points: 100\+Z, 100\+X"):
        check_suitable(with_force(original, "100+X", 1.0, 2), roving_scenario())


def noted(campaign: Campaign, **notes: str) -> Campaign:
    kept = {k: v for k, v in campaign.notes.items() if k != "excitation"}
    return replace(campaign, notes=kept | notes)


@pytest.mark.parametrize(
    "notes",
    [
        {"excitation": "impact 1 to 35 Hz in 60 s, 10 hits"},
        {"excitation": "Modal hammer with a soft tip, 10 hits a run"},
        {"impacts": '{"free_s": 5.0}'},
    ],
)
def test_records_of_a_hammer_are_refused_whatever_the_scenario(original: Campaign, notes: dict[str, str]) -> None:
    with pytest.raises(InputError, match=r"(?s)hammer struck.*a shaker drove") as told:
        check_suitable(noted(original, **notes), roving_scenario())
    assert next(iter(notes)) in told.value.where


@pytest.mark.parametrize("excitation", ["electrodynamic shaker, one sweep; hammer taps beforehand", "linear-chirp", ""])
def test_records_of_a_shaker_are_taken(original: Campaign, excitation: str) -> None:
    check_suitable(noted(original, excitation=excitation), roving_scenario())


def test_a_simulated_hammer_is_known_by_its_notes() -> None:
    """The scenario beside it has a shaker: it is the campaign that is refused."""
    hammered = load_scenario("teaching-beam-hammer")
    campaign = simulated_campaign(hammered, engine="linear")
    assert "impacts" in campaign.notes
    with pytest.raises(InputError) as told:
        check_suitable(campaign, load_scenario("teaching-beam"))
    assert told.value.where.startswith(campaign.name)
    assert "hammer" in told.value.problem
