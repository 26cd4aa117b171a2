"""Records, campaigns, response sets and modal models refuse what does not fit and keep their laws."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest

from vgvt.data import (
    Campaign,
    Channel,
    ChannelRole,
    Dof,
    FrequencyResponseSet,
    Geometry,
    InputError,
    ModalModel,
    Outcome,
    Quantity,
    Record,
    RigidBodyProperties,
    Truth,
)

D = Dof.from_label
FORCE = Channel("f", Quantity.EXCITATION_FORCE, ChannelRole.REFERENCE, D("9+Z"))
RESPONSE = Channel("a", Quantity.ACCELERATION, ChannelRole.RESPONSE, D("1+Z"))
GEOMETRY = Geometry((1, 9), np.array([[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]))


def record(run: int = 1) -> Record:
    """Two channels of 100 samples at 50 Hz."""
    return Record(run, 50.0, (FORCE, RESPONSE), np.arange(200.0).reshape(2, 100))


def frf(references: int = 1) -> FrequencyResponseSet:
    """Three responses at ten lines."""
    values = np.random.default_rng(0).standard_normal((3, references, 10, 2)) @ np.array([1, 1j])
    return FrequencyResponseSet(
        (D("1+Z"), D("2+Z"), D("3+Z")),
        tuple(D(f"{9 + k}+Z") for k in range(references)),
        np.arange(1.0, 11.0),
        values,
        (1, 1, 2),
        variance=np.abs(values),
        remarks=("a remark",),
    )


def model() -> ModalModel:
    """Three modes at two DOFs."""
    return ModalModel(
        natural_frequency_hz=np.array([1.0, 5.0, 9.0]),
        damping_ratio=np.array([0.01, 0.02, 0.03]),
        shapes=np.arange(6.0).reshape(3, 2) + 1j,
        dofs=(D("1+Z"), D("2-X")),
        references=(D("9+Z"),),
        residues=np.ones((3, 2, 1), complex),
        labels=("a", "b", "c"),
        flags=((), ("x",), ()),
    )


def test_a_record_knows_its_time_and_its_channels_by_role() -> None:
    one = record()
    assert one.duration_s == 2.0
    np.testing.assert_allclose(one.time_s[[0, 1, -1]], [0, 0.02, 1.98])
    channels, samples = one.select(ChannelRole.RESPONSE)
    assert channels == (RESPONSE,)
    np.testing.assert_array_equal(samples, [np.arange(100.0, 200.0)])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"samples": np.zeros((3, 100))}, r"samples must be \(2, N\)"),
        ({"samples": np.zeros((2, 0))}, "no samples"),
        ({"samples": np.zeros(100)}, r"samples must be \(2, N\)"),
        ({"sample_rate_hz": 0.0}, "sample_rate_hz"),
        ({"sample_rate_hz": float("nan")}, "sample_rate_hz"),
    ],
)
def test_a_record_that_does_not_fit_is_refused(change: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(record(), **change)


def test_a_campaign_lists_each_dof_once() -> None:
    campaign = Campaign("c", GEOMETRY, (record(1), record(2)), (1.0, 20.0))
    assert campaign.response_dofs == (D("1+Z"),)
    assert campaign.reference_dofs == (D("9+Z"),)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"runs": ()}, "no runs"),
        ({"runs": (record(1), record(1))}, "run numbers must be unique"),
        ({"band_hz": (20.0, 1.0)}, "band_hz"),
        ({"geometry": Geometry((1,), np.zeros((1, 3)))}, r"without a position: \[9\]"),
    ],
)
def test_a_campaign_that_does_not_fit_is_refused(change: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(Campaign("c", GEOMETRY, (record(),), (1.0, 20.0)), **change)


def test_nouns_are_frozen() -> None:
    with pytest.raises(FrozenInstanceError):
        record().run = 2  # type: ignore[misc]


def test_a_geometry_finds_its_nodes() -> None:
    np.testing.assert_array_equal(GEOMETRY.position_m(9), [3, 4, 5])
    np.testing.assert_array_equal(GEOMETRY.positions_of((D("9+Z"), D("1-X"))), [[3, 4, 5], [0, 1, 2]])
    assert GEOMETRY.positions_of(()).shape == (0, 3)
    with pytest.raises(KeyError, match="no node 5"):
        GEOMETRY.position_m(5)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (((1, 2), np.zeros((3, 3))), "positions_m must be"),
        (((1, 1), np.zeros((2, 3))), r"unique; twice: \[1\]"),
        (((1, 2), np.zeros((2, 3)), ((1, 7),)), r"do not exist: \[7\]"),
    ],
)
def test_a_geometry_that_does_not_fit_is_refused(arguments: tuple, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Geometry(*arguments)


@pytest.mark.parametrize("references", [1, 2])
def test_sigma_is_the_largest_singular_value(references: int) -> None:
    some = frf(references)
    expected = [np.linalg.norm(some.values[:, :, k], ord=2) for k in range(10)]
    np.testing.assert_allclose(some.sigma(), expected)


def test_a_band_of_responses_keeps_everything_else() -> None:
    part = frf().band(3.0, 6.0)
    np.testing.assert_array_equal(part.frequency_hz, [3, 4, 5, 6])
    np.testing.assert_array_equal(part.values, frf().values[:, :, 2:6])
    assert part.variance is not None
    assert part.variance.shape == part.values.shape
    assert part.remarks == ("a remark",)
    assert part.resolution_hz == 1.0


@pytest.mark.parametrize(
    ("band", "problem"),
    [
        ((6.0, 3.0), "6 to 3 Hz is not low <= high"),
        ((float("nan"), 3.0), "nan to 3 Hz is not low <= high"),
        ((3.0, float("nan")), "3 to nan Hz is not low <= high"),
        ((10.5, 20.0), r"10.5 to 20 Hz lies outside the lines, 1 to 10 Hz"),
        ((0.0, 0.9), r"0 to 0.9 Hz lies outside the lines, 1 to 10 Hz"),
    ],
)
def test_a_band_without_a_meaning_is_refused(band: tuple[float, float], problem: str) -> None:
    with pytest.raises(InputError, match=problem):
        frf().band(*band)


@pytest.mark.parametrize(("band", "lines"), [((10.0, 20.0), 1), ((0.0, np.inf), 10), ((4.0, 4.0), 1), ((4.2, 4.8), 0)])
def test_a_band_reaches_beyond_the_lines_or_falls_between_two(band: tuple[float, float], lines: int) -> None:
    part = frf().band(*band)
    assert part.frequency_hz.size == lines
    assert part.values.shape == (3, 1, lines)
    assert not frf().lines(np.zeros(10, bool)).band(1.0, 2.0).frequency_hz.size


@pytest.mark.parametrize(
    "change",
    [
        {"values": np.zeros((3, 1, 9), complex)},
        {"variance": np.zeros((3, 10))},
        {"runs": (1, 2)},
        {"frequency_hz": np.arange(10.0, 0.0, -1.0)},
    ],
)
def test_responses_that_do_not_fit_are_refused(change: dict) -> None:
    with pytest.raises(ValueError, match="must"):
        replace(frf(), **change)


def test_poles_have_the_frequency_and_damping_of_the_modes() -> None:
    poles = model().poles
    np.testing.assert_allclose(np.abs(poles) / (2 * np.pi), model().natural_frequency_hz)
    np.testing.assert_allclose(-poles.real / np.abs(poles), model().damping_ratio)
    assert (poles.imag > 0).all()


def test_selecting_modes_keeps_rows_together() -> None:
    part = model().select([2, 0][::-1])
    assert part.labels == ("a", "c")
    np.testing.assert_array_equal(part.shapes, model().shapes[[0, 2]])
    masked = model().band(4.0, 6.0)
    assert (len(masked), masked.flags) == (1, (("x",),))


def test_the_same_modes_seen_the_other_way_round_change_sign() -> None:
    seen = model().at((D("2+X"), D("1+Z")))
    np.testing.assert_array_equal(seen.shapes, model().shapes[:, [1, 0]] * [-1, 1])
    assert seen.residues is not None
    np.testing.assert_array_equal(seen.residues[:, :, 0], [[-1, 1]] * 3)
    with pytest.raises(KeyError, match=r"no DOF 7\+Z"):
        model().at((D("7+Z"),))


def test_an_empty_model_says_why() -> None:
    empty = ModalModel.empty(Outcome.DECLINED, ("needs force",), "m", (D("1+Z"),))
    assert (len(empty), empty.outcome, empty.advice) == (0, Outcome.DECLINED, ("needs force",))
    assert empty.band(0, 100).shapes.shape == (0, 1)
    assert empty.at((D("1-Z"),)).shapes.shape == (0, 1)


@pytest.mark.parametrize(
    "change",
    [
        {"damping_ratio": np.zeros(2)},
        {"shapes": np.zeros((3, 3), complex)},
        {"residues": np.zeros((3, 2), complex)},
        {"natural_frequency_hz": np.array([5.0, 1.0, 9.0])},
        {"natural_frequency_hz": np.array([1.0, 5.0, np.nan])},
        {"natural_frequency_hz": np.array([1.0, 5.0, np.inf])},
        {"natural_frequency_hz": np.array([-1.0, 5.0, 9.0])},
        {"dofs": (D("1+Z"), D("1+Z"))},
        {"dofs": (D("1+Z"), D("1-Z"))},
        {"labels": ("a",)},
        {"flags": ((),)},
    ],
)
def test_a_modal_model_that_does_not_fit_is_refused(change: dict) -> None:
    with pytest.raises(ValueError, match="must"):
        replace(model(), **change)


def test_a_dof_that_is_there_twice_is_named() -> None:
    """Along an axis and against it is one DOF; along another axis it is another one."""
    with pytest.raises(ValueError, match=r"once each; twice: 1\+Z$"):
        model().at((D("1+Z"), D("1-Z")))
    assert replace(model(), dofs=(D("1+Z"), D("1+RZ"))).dofs[1] == D("1+RZ")


def test_a_truth_has_a_model_for_each_run() -> None:
    body = RigidBodyProperties(1.0, np.zeros(3), np.eye(3))
    with pytest.raises(ValueError, match="one entry a run"):
        Truth("s", body, model(), (1, 2), (model(),), (model(),))
