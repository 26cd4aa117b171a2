"""What a frequency response estimate does with bad records: it says so, and never corrupts in silence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt.signals import estimate_frf

NOISE = np.random.default_rng(0).standard_normal((4, 2000))


def test_nan_samples_drop_the_channel_with_the_reason(make_campaign) -> None:
    broken = NOISE[1].copy()
    broken[500:503] = np.nan
    campaign = make_campaign([{"F9+Z": NOISE[0], "1+Z": broken, "2+Z": NOISE[2]}, {"F9+Z": NOISE[0], "3+Z": NOISE[3]}])
    frf = estimate_frf(campaign)
    assert [str(d) for d in frf.responses] == ["2+Z", "3+Z"]
    assert np.isfinite(frf.values).all()
    assert frf.remarks == ("run 1: 1+Z (1+Z) left out, 3 of 2000 samples are not finite (first at 2.5 s)",)


@pytest.mark.parametrize("bad", [np.inf, -np.inf, np.nan])
def test_every_kind_of_not_a_number_is_seen(make_campaign, bad: float) -> None:
    broken = NOISE[1].copy()
    broken[0] = bad
    frf = estimate_frf(make_campaign([{"F9+Z": NOISE[0], "1+Z": broken, "2+Z": NOISE[2]}]))
    assert "1 of 2000 samples are not finite (first at 0 s)" in frf.remarks[0]


def test_a_dead_channel_is_dropped_and_a_clipped_one_is_remarked(make_campaign) -> None:
    campaign = make_campaign([{"F9+Z": NOISE[0], "1+Z": np.full(2000, 0.25), "2+Z": NOISE[2]}])
    campaign = replace(campaign, runs=(replace(campaign.runs[0], overloaded=("2+Z",)),))
    frf = estimate_frf(campaign)
    assert [str(d) for d in frf.responses] == ["2+Z"]
    assert frf.remarks[0] == "run 1: 1+Z (1+Z) left out, dead: every sample is 0.25"
    assert "clipped" in frf.remarks[1]


def test_a_channel_bad_in_one_run_survives_by_its_other_runs(make_campaign) -> None:
    runs = [{"F9+Z": NOISE[0], "1+Z": np.zeros(2000)}, {"F9+Z": NOISE[0], "1+Z": NOISE[1]}]
    frf = estimate_frf(make_campaign(runs))
    assert frf.runs == (2,)
    assert len(frf.remarks) == 1


def test_no_sound_response_at_all_is_bad_input(make_campaign) -> None:
    with pytest.raises(InputError, match=r"no response channel can be used(.|\n)*dead"):
        estimate_frf(make_campaign([{"F9+Z": NOISE[0], "1+Z": np.zeros(2000)}]))


@pytest.mark.parametrize(("force", "reason"), [(np.zeros(2000), "dead"), (np.full(2000, np.nan), "not finite")])
def test_a_bad_reference_names_run_and_channel(make_campaign, force, reason: str) -> None:
    runs = [{"F9+Z": NOISE[0], "1+Z": NOISE[1]}, {"F9+Z": force, "2+Z": NOISE[2]}]
    with pytest.raises(InputError, match=rf"run 2, channel F9\+Z .*{reason}(.|\n)*leave run 2 out"):
        estimate_frf(make_campaign(runs))


def test_a_run_without_force_is_bad_input(make_campaign) -> None:
    with pytest.raises(InputError, match=r"run 1: no reference"):
        estimate_frf(make_campaign([{"1+Z": NOISE[1]}]))


def test_runs_of_different_rate_are_named(make_campaign) -> None:
    runs = [{"F9+Z": NOISE[0], f"{k}+Z": NOISE[1]} for k in (1, 2, 3)]
    with pytest.raises(InputError, match=r"sample rate: 100 Hz in run 2; 200 Hz in run 1, 3(.|\n)*resample"):
        estimate_frf(make_campaign(runs, [200.0, 100.0, 200.0]))


def test_runs_of_different_length_are_named_unless_segments_make_them_alike(make_campaign) -> None:
    runs = [{"F9+Z": NOISE[0], "1+Z": NOISE[1]}, {"F9+Z": NOISE[0, :1000], "2+Z": NOISE[1, :1000]}]
    campaign = make_campaign(runs)
    with pytest.raises(InputError, match=r"length: 1000 samples in run 2; 2000 samples in run 1(.|\n)*segment_s"):
        estimate_frf(campaign)
    frf = estimate_frf(campaign, "h1", segment_s=1.0)
    assert frf.values.shape == (2, 1, 100)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"estimator": "H1"}, "did you mean 'h1'"),
        ({"estimator": "h1"}, "give segment_s"),
        ({"estimator": "ratio", "segment_s": 1.0}, "takes whole records"),
        ({"estimator": "h1", "segment_s": 100.0}, "does not fit run 1"),
        ({"band_hz": (500.0, 600.0)}, "fewer than two frequency lines"),
    ],
)
def test_settings_that_cannot_work_say_what_to_write(make_campaign, settings: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        estimate_frf(make_campaign([{"F9+Z": NOISE[0], "1+Z": NOISE[1]}]), **settings)


def test_two_forces_that_are_copies_are_refused(make_campaign) -> None:
    campaign = make_campaign([{"F8+Z": NOISE[0], "F9+Z": 2 * NOISE[0], "1+Z": NOISE[1]}])
    with pytest.raises(InputError, match="copies of one another"):
        estimate_frf(campaign, "h1", segment_s=0.5)
    with pytest.raises(InputError, match="needs more averages"):
        estimate_frf(campaign)
    with pytest.raises(InputError, match="defined for one reference"):
        estimate_frf(campaign, "h2", segment_s=0.5)


def test_a_response_not_measured_with_every_reference_is_left_out(make_campaign) -> None:
    runs = [{"F8+Z": NOISE[0], "1+Z": NOISE[1], "2+Z": NOISE[2]}, {"F9+Z": NOISE[3], "1+Z": NOISE[1]}]
    frf = estimate_frf(make_campaign(runs))
    assert [str(d) for d in frf.responses] == ["1+Z"]
    assert frf.remarks == ("2+Z left out: not measured with every reference",)


def test_lines_without_any_force_hold_nan_and_are_counted(make_campaign) -> None:
    alternating = np.tile([1.0, 0.0, -1.0, 0.0], 500)
    frf = estimate_frf(make_campaign([{"F9+Z": alternating, "1+Z": NOISE[1]}]))
    assert np.isnan(frf.values).sum() > 0
    assert "without any force hold NaN" in frf.remarks[0]
