"""What a confirmation simulates has the noise that was predicted, whatever the converter."""

from __future__ import annotations

import pytest

from vgvt.planning.lighter import lighter
from vgvt.planning.prediction import predict
from vgvt.scenario import load_scenario


def with_acquisition(scenario, **changes):
    return scenario.model_copy(update={"acquisition": scenario.acquisition.model_copy(update=changes)})


@pytest.mark.parametrize("bits", [12, 14, 16, 18, 20, 24])
def test_a_lighter_campaign_is_predicted_as_the_whole_one(light, bits) -> None:
    scenario = with_acquisition(light, bits=bits, sample_rate_hz=2000.0)
    for whole, less in zip(predict(scenario).modes, predict(lighter(scenario)).modes, strict=True):
        assert less.frequency_std_hz == pytest.approx(whole.frequency_std_hz, rel=0.006)
        assert less.damping_ratio_std == pytest.approx(whole.damping_ratio_std, rel=0.006)


def test_a_fine_converter_is_sampled_as_its_band_needs_and_a_coarse_one_as_it_is(light) -> None:
    assert lighter(light).acquisition.sample_rate_hz == 8 * light.excitation.band_hz[1]
    coarse = with_acquisition(light, bits=16)
    assert lighter(coarse) == coarse


@pytest.mark.parametrize(
    ("name", "rate_hz"),
    [("garteur-sm-ag19", 520), ("hati-unsymmetric", 280), ("quick", 280), ("skoll-gvt1", 280), ("skoll-gvt2", 104)],
)
def test_the_bundled_tests_stay_light(name, rate_hz) -> None:
    assert lighter(load_scenario(name)).acquisition.sample_rate_hz == rate_hz
