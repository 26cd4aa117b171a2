"""Laws of the score and its JSON contract."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import Direction, Dof, InputError, ModalModel, ModeScore, ModeStatus, Outcome, Scorecard
from vgvt_scoreboard import merge_truth, reachable, score, sigma_share

FREQUENCY = [8.0, 15.5, 19.1, 31.8]
SHAPES = np.array([[1, 2, 3, 4, 1], [1, -2, 3, -4, 1], [3, 1, -2, -1, 1], [1, 1, 1, -3, 1.0]])
BAND = (3.0, 35.0)


@pytest.fixture
def truth(model, sealed):
    return sealed(model(FREQUENCY, [0.01] * 4, SHAPES, drive=4))


def claim_of(model, frequency_hz, shapes=None, **more):
    shapes = SHAPES[: len(frequency_hz)] if shapes is None else shapes
    return model(frequency_hz, [0.01] * len(frequency_hz), shapes, **more)


def test_the_truth_itself_scores_perfectly(truth) -> None:
    card = score(truth, truth.as_tested[0], BAND)
    assert (card.found, card.missed, card.false) == (4, 0, 0)
    assert all(row.mac == pytest.approx(1.0) for row in card.modes)
    assert card.summary()["max_abs_frequency_error_percent"] == pytest.approx(0.0, abs=1e-12)
    assert card.summary()["max_abs_damping_error_percent"] == pytest.approx(0.0, abs=1e-12)


def test_counts_are_symmetric_when_truth_and_claim_change_places(model, sealed) -> None:
    a = model([8.0, 15.0, 19.0], [0.01] * 3, SHAPES[:3])
    b = model([8.1, 19.1, 26.0, 30.0], [0.01] * 4, SHAPES[[0, 2, 1, 3]])
    forward, back = score(sealed(a), b, BAND), score(sealed(b), a, BAND)
    assert forward.found == back.found == 2
    assert (forward.missed, forward.false) == (back.false, back.missed) == (1, 2)


def test_a_far_false_mode_changes_no_other_row(truth, model) -> None:
    small = score(truth, claim_of(model, [8.1, 15.4, 19.0]), BAND)
    large = score(truth, claim_of(model, [8.1, 15.4, 19.0, 25.0], SHAPES), BAND)
    assert large.false == small.false + 1
    without = [row for row in large.modes if row.status is not ModeStatus.FALSE]
    assert [r.as_dict() for r in without] == [r.as_dict() for r in small.modes]


def test_a_mode_claimed_twice_is_one_found_and_one_split(truth, model) -> None:
    card = score(truth, claim_of(model, [8.01, 8.10], [SHAPES[0], SHAPES[0]]), BAND)
    assert (card.found, card.false) == (1, 1)
    (found,) = card.rows(ModeStatus.FOUND)
    (false,) = card.rows(ModeStatus.FALSE)
    assert found.claimed_hz == 8.01
    assert "split" in false.remark
    assert "8.00" in false.remark


def test_a_far_false_claim_is_no_split(truth, model) -> None:
    (false,) = score(truth, claim_of(model, [25.0]), BAND).rows(ModeStatus.FALSE)
    assert false.remark == ""


def test_errors_are_relative_to_the_truth(truth, model) -> None:
    claim = model([8.08], [0.012], SHAPES[:1])
    row = score(truth, claim, BAND).modes[0]
    assert row.frequency_error_percent == pytest.approx(1.0)
    assert row.damping_error_percent == pytest.approx(20.0)


@pytest.mark.parametrize(("std", "covered"), [(0.05, True), (0.03, False)])
def test_coverage_is_that_of_the_95_percent_interval(truth, model, std: float, covered: bool) -> None:
    claim = claim_of(model, [8.08], natural_frequency_std_hz=np.array([std]), damping_ratio_std=np.array([np.nan]))
    row = score(truth, claim, BAND).modes[0]
    assert row.frequency_covered is covered
    assert row.damping_covered is None


def test_a_mode_on_the_drive_points_node_line_is_unreached_not_missed(model, sealed) -> None:
    shapes = SHAPES.copy()
    shapes[1, 4] = 1e-4
    truth = sealed(model(FREQUENCY, [0.01] * 4, shapes, drive=4))
    share = sigma_share(truth.as_tested[0])
    assert share[1] < 0.02 < share[[0, 2, 3]].min()
    card = score(truth, claim_of(model, [8.0, 19.1, 31.8], shapes[[0, 2, 3]]), BAND)
    assert (card.found, card.missed, card.false) == (3, 0, 0)
    assert [row.true_hz for row in card.unreached] == [15.5]
    assert card.summary()["true_modes"] == 3
    claimed = score(truth, claim_of(model, FREQUENCY, shapes), BAND)
    assert (claimed.found, claimed.missed, len(claimed.unreached)) == (4, 0, 0)
    assert [row.reachable for row in claimed.modes] == [True, False, True, True]


@pytest.mark.parametrize(("deviation", "reached"), [(0.0009, True), (0.0011, False)])
def test_a_mode_is_in_reach_where_its_damping_can_be_known_within_a_tenth(
    model, sealed, deviation: float, reached: bool
) -> None:
    """Of two runs with half the information each; the bound of the frequency alone would say no."""
    stated = {"natural_frequency_std_hz": np.full(4, 5.0), "damping_ratio_std": np.full(4, deviation * np.sqrt(2))}
    merged = merge_truth(sealed(*(model(FREQUENCY, [0.01] * 4, SHAPES, **stated) for _ in range(2)))).model
    assert merged.damping_ratio_std == pytest.approx(np.full(4, deviation))
    assert reachable(merged).tolist() == [reached] * 4


def test_a_share_is_one_for_a_single_mode_and_unknown_without_residues(model) -> None:
    assert sigma_share(model([8.0], [0.01], SHAPES[:1], drive=4)) == pytest.approx([1.0])
    assert np.isnan(sigma_share(model([8.0], [0.01], SHAPES[:1]))).all()


def test_modes_outside_the_band_are_not_required_but_excuse_a_claim(truth, model) -> None:
    card = score(truth, claim_of(model, FREQUENCY, SHAPES), (3.0, 18.0))
    assert (card.found, card.missed, card.false) == (2, 0, 0)
    edge = score(truth, claim_of(model, [8.0, 15.5, 18.95]), (3.0, 19.0))
    assert (edge.found, edge.missed, edge.false) == (3, 0, 0)
    assert [row.in_band for row in edge.modes] == [True, True, False]
    assert edge.summary()["true_modes"] == 2


def test_claims_outside_the_band_that_fit_nothing_are_left_out(truth, model) -> None:
    card = score(truth, claim_of(model, [8.0, 25.0]), (3.0, 18.0))
    assert (card.found, card.missed, card.false) == (1, 1, 0)


def test_a_claim_just_outside_the_band_may_belong_to_a_mode_inside(truth, model) -> None:
    card = score(truth, claim_of(model, [32.1], SHAPES[3:]), (20.0, 32.0))
    assert (card.found, card.missed, card.false) == (1, 0, 0)


def test_nothing_claimed_is_everything_missed(truth) -> None:
    card = score(truth, ModalModel.empty(Outcome.DECLINED, ("needs a force",), method="ssi"), BAND)
    assert (card.found, card.missed, card.false) == (0, 4, 0)
    assert card.outcome is Outcome.DECLINED
    assert card.advice == ("needs a force",)
    assert card.identifier == "ssi"


def test_a_claim_at_some_dofs_and_opposite_directions_has_mac_one(truth) -> None:
    dofs = (Dof(3, Direction.MINUS_Z), Dof(1, Direction.PLUS_Z), Dof(2, Direction.MINUS_Z))
    card = score(truth, truth.as_tested[0].at(dofs), BAND)
    assert [row.mac for row in card.modes] == pytest.approx([1.0] * 4)


def test_a_claim_elsewhere_is_bad_input(truth, model) -> None:
    claim = replace(claim_of(model, [8.0]), dofs=tuple(Dof(90 + k, Direction.PLUS_Z) for k in range(5)))
    with pytest.raises(InputError, match="share no degree of freedom"):
        score(truth, claim, BAND)


def test_a_band_upside_down_is_bad_input(truth) -> None:
    with pytest.raises(InputError, match="no band"):
        score(truth, truth.as_tested[0], (35.0, 3.0))


def test_merging_averages_over_the_runs_whatever_their_scale_and_phase(model, sealed) -> None:
    runs = [
        model(np.array(FREQUENCY) * (1 + shift), [0.01 + shift] * 4, SHAPES * scale, drive=4)
        for shift, scale in ((-0.002, 1.0), (0.0, -3.0), (0.005, 2.0))
    ]
    merged = merge_truth(sealed(*runs))
    assert merged.model.natural_frequency_hz == pytest.approx(np.array(FREQUENCY) * 1.001)
    assert merged.model.damping_ratio == pytest.approx([0.011] * 4)
    assert merged.frequency_spread_hz == pytest.approx(np.array(FREQUENCY) * np.std([-0.002, 0.0, 0.005]))
    assert list(merged.runs_matched) == [3] * 4
    assert np.abs(merged.model.shapes - SHAPES).max() < 1e-12


def test_merging_follows_modes_that_cross_between_runs(model, sealed) -> None:
    """The roving mass exchanges the order of a close pair; each mode keeps its own shape."""
    pair = np.array([[1, 1, 1, 1, 1], [1, -1, 1, -1, 1.0]])
    first = model([19.0, 19.3], [0.01, 0.01], pair, drive=4)
    second = model([19.1, 19.2], [0.01, 0.01], pair[::-1], drive=4)
    merged = merge_truth(sealed(first, second))
    assert merged.model.natural_frequency_hz == pytest.approx([19.1, 19.2])
    assert np.abs(merged.model.shapes - pair).max() < 1e-12


def test_modes_whose_averages_cross_stay_whole(model, sealed) -> None:
    """A rises and B falls from run to run until their averages change order; nothing is left behind."""
    pair = np.array([[1, 1, 1, 1, 1], [1, -1, 1, -1, 2.0]])
    first = model([19.0, 19.3], [0.010, 0.012], pair, drive=4)
    second = model([19.1, 19.6], [0.012, 0.010], pair[::-1], drive=4)
    merged = merge_truth(sealed(first, second))
    assert merged.model.natural_frequency_hz == pytest.approx([19.2, 19.3])
    assert merged.model.damping_ratio == pytest.approx([0.012, 0.010])
    assert list(merged.index) == [1, 0]
    assert np.abs(merged.model.shapes - pair[::-1]).max() < 1e-12
    expected = (first.residues[[1, 0]] + second.residues) / 2
    assert np.abs(merged.model.residues - expected).max() < 1e-15


def test_a_truth_without_runs_is_bad_input(truth) -> None:
    with pytest.raises(InputError, match="no run"):
        merge_truth(replace(truth, runs=(), as_tested=(), coupled=()))


def test_json_contract(truth, model) -> None:
    claim = claim_of(model, [8.05, 25.0, 31.7], SHAPES[[0, 1, 3]], method="quadrature")
    card = json.loads(json.dumps(score(truth, claim, BAND).as_dict(), allow_nan=False))
    assert {"modes", "missed", "false", "summary", "identifier", "scenario", "band_hz", "unreached"} <= card.keys()
    contract = {
        "true_hz", "claimed_hz", "frequency_error_percent", "true_damping_ratio", "damping_error_percent",
        "mac", "status", "label",
    }  # fmt: skip
    assert all(contract <= row.keys() for row in card["modes"])
    assert [row["status"] for row in card["modes"]] == ["found", "missed", "missed", "false", "found"]
    assert card["missed"] == 2
    assert card["false"] == 1
    assert card["identifier"] == "quadrature"
    assert card["summary"]["found"] == 2


def test_rows_that_contradict_their_status_are_refused() -> None:
    with pytest.raises(ValueError, match="missed row"):
        ModeScore(ModeStatus.MISSED, true_hz=8.0, claimed_hz=8.0)
    with pytest.raises(ValueError, match="field unreached"):
        Scorecard("a", "b", BAND, (ModeScore(ModeStatus.UNREACHED, true_hz=8.0),))
    with pytest.raises(ValueError, match="only unreached"):
        Scorecard("a", "b", BAND, (), (ModeScore(ModeStatus.MISSED, true_hz=8.0),))
