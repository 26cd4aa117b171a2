"""A claim without the force is judged by the modes with the shaker, and told how far those are from the aircraft's."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import ModalModel, ModeStatus, Outcome, TrueModes, Truth
from vgvt_scoreboard import counterparts, judged_by, score

BAND = (3.0, 36.0)
SHAPES = np.array([[1, 0.6, 0.2, 0.6, 1], [-1, -0.6, 0.1, 0.6, 1], [-1, 0.5, 1, 0.5, -1.0]])
SHAKEN = np.array([[0.7, 0.8, 0.9, 0.8, 0.7], *SHAPES])
TESTED_HZ, SHAKEN_HZ = [8.14, 15.6, 31.8], [4.0, 8.55, 15.62, 31.7]
LABELS = ("1st symmetric bending", "1st antisymmetric bending", "2nd symmetric bending")


@pytest.fixture
def truth(model, sealed) -> Truth:
    """Three modes as tested; the shaker stiffens and damps the first, and adds a resonance of its own."""
    bound = {"natural_frequency_std_hz": np.full(3, 0.001), "damping_ratio_std": np.full(3, 1e-4), "labels": LABELS}
    tested = model(TESTED_HZ, [0.012, 0.013, 0.016], SHAPES, drive=4, **bound)
    shaken = model(SHAKEN_HZ, [0.035, 0.046, 0.017, 0.018], SHAKEN, drive=4)
    return replace(sealed(tested), coupled=(shaken,))


@pytest.fixture
def claim(model) -> ModalModel:
    """What a method without the force can find: the resonances of shaker and aircraft, well within its own ±."""
    frequency = np.array(SHAKEN_HZ) * 1.001
    ratio = np.array([0.036, 0.0477, 0.0171, 0.0181])
    stated = {"natural_frequency_std_hz": np.full(4, 0.04), "damping_ratio_std": np.full(4, 2e-3)}
    return model(frequency, ratio, SHAKEN, **stated, output_only=True, method="ssi-cov")


def test_it_is_right_about_what_it_could_find(truth: Truth, claim: ModalModel) -> None:
    card = score(truth, claim, BAND)
    assert card.true_modes is TrueModes.COUPLED
    assert (card.found, card.missed, card.false) == (4, 0, 0)
    assert [row.true_hz for row in card.modes] == SHAKEN_HZ
    assert all(row.frequency_covered and row.damping_covered for row in card.modes)
    assert min(row.mac or 0 for row in card.modes) == pytest.approx(1)
    assert card.summary()["max_abs_frequency_error_percent"] == pytest.approx(0.1)
    assert all(row.frequency_bound_hz is None and row.scaling_error_percent is None for row in card.modes)


def test_how_far_that_is_from_the_test_stands_beside_it(truth: Truth, claim: ModalModel) -> None:
    card = score(truth, claim, BAND)
    assert [row.as_tested_hz for row in card.modes] == [None, *TESTED_HZ]
    assert [row.as_tested_damping_ratio for row in card.modes] == [None, 0.012, 0.013, 0.016]
    assert [row.label for row in card.modes] == ["", *LABELS]
    assert card.modes[0].remark == "shaker and aircraft together: like no mode as tested"
    (remark,) = card.remarks
    assert "up to 5 % away in frequency and a factor of 3.8 in damping" in remark
    document = json.loads(json.dumps(card.as_dict(), allow_nan=False))
    assert document["true_modes"] == "coupled"
    assert document["remarks"] == [remark]
    assert [row["as_tested_hz"] for row in document["modes"]] == [None, *TESTED_HZ]


def test_the_same_claim_with_the_force_is_wrong_and_nothing_is_said(truth: Truth, claim: ModalModel) -> None:
    card = score(truth, replace(claim, output_only=False), BAND)
    assert card.true_modes is TrueModes.AS_TESTED
    assert card.remarks == ()
    assert [row.frequency_covered for row in card.modes if row.label == LABELS[0]] == [False]
    assert all(row.as_tested_hz is None for row in card.modes)


def test_a_resonance_that_the_records_show_is_asked_for(truth: Truth, claim: ModalModel) -> None:
    """By its share of the response to the command: as a claim of no modes shows, and one that is hardly driven."""
    nothing = replace(ModalModel.empty(Outcome.NOTHING_FOUND, ("nothing",)), output_only=True)
    assert score(truth, nothing, BAND).missed == 4
    assert truth.coupled[0].residues is not None
    weak = truth.coupled[0].residues * np.array([1e-4, 1, 1, 1])[:, None, None]
    card = score(replace(truth, coupled=(replace(truth.coupled[0], residues=weak),)), nothing, BAND)
    assert (card.missed, [row.true_hz for row in card.unreached]) == (3, SHAKEN_HZ[:1])
    assert card.unreached[0].status is ModeStatus.UNREACHED


def test_residues_for_a_volt_are_not_held_against_those_of_a_claim(truth: Truth, claim: ModalModel) -> None:
    there = truth.coupled[0]
    stated = replace(claim, references=there.references, residues=there.residues)
    assert all(row.scaling_error_percent is None for row in score(truth, stated, BAND).modes)


def test_a_truth_without_modes_with_the_shaker_says_so(truth: Truth, claim: ModalModel) -> None:
    bare = replace(truth, coupled=(ModalModel.empty(Outcome.NOTHING_FOUND, ("not computed",)),))
    card = score(bare, claim, BAND)
    assert card.true_modes is TrueModes.AS_TESTED
    assert [row.true_hz for row in card.modes if row.label == LABELS[0]] == TESTED_HZ[:1]
    assert ["holds no modes with the shaker attached" in remark for remark in card.remarks] == [True]


def test_runs_are_averaged_with_the_shaker_too(truth: Truth, claim: ModalModel) -> None:
    first = truth.coupled[0]
    second = replace(first, natural_frequency_hz=first.natural_frequency_hz * 1.002)
    both = replace(truth, runs=(1, 2), as_tested=truth.as_tested * 2, coupled=(first, second))
    rows = score(both, claim, BAND).modes
    assert [row.frequency_error_percent for row in rows] == pytest.approx([0, 0, 0, 0], abs=1e-9)
    assert all(row.true_spread_hz for row in rows)


def test_a_mode_that_the_shaker_changes_beyond_recognition_is_named(truth: Truth, claim: ModalModel) -> None:
    far = replace(truth.coupled[0], shapes=np.array([SHAKEN[0], [1, -1, 1, -1, 1], *SHAPES[1:]], dtype=complex))
    card = score(replace(truth, coupled=(far,)), claim, BAND)
    assert card.remarks[1].endswith("no mode is recognised as that as tested: 1st symmetric bending (8.14 Hz)")


def test_a_counterpart_is_given_once_and_not_for_frequency_alone(truth: Truth) -> None:
    assert counterparts(truth.coupled[0], truth.as_tested[0]).tolist() == [-1, 0, 1, 2]
    empty = truth.as_tested[0].select([])
    assert counterparts(truth.coupled[0], empty).tolist() == [-1] * 4
    assert judged_by(truth, truth.as_tested[0]).counterpart.tolist() == [0, 1, 2]
