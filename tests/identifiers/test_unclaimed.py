"""A strong mode that a method does not claim is named in its advice; where all is claimed, nothing is said."""

from __future__ import annotations

import pytest

from vgvt.identification import make_identifier, run_identifier
from vgvt.identification.example import Example

IMPULSE = ["era", "era-dc", "pem"]
LIGHT = Example(damping_ratio=(0.001,) * 3, noise_m_s2=0.05)


def said(name: str, example: Example) -> list[str]:
    advice = run_identifier(make_identifier(name), example.campaign()).advice
    return [line for line in advice if "no mode" in line or "not claimed" in line]


@pytest.mark.parametrize("name", IMPULSE)
def test_a_peak_under_the_taper_is_named(name: str) -> None:
    lines = said(name, Example(frequency_hz=(4.0, 13.7, 26.9), noise_m_s2=0.5))
    assert len(lines) == 1
    assert "4.0" in lines[0] and "13." not in lines[0]


@pytest.mark.parametrize("name", ["era", "era-dc"])
def test_a_mode_at_the_end_of_the_band_is_hinted_at(name: str) -> None:
    """It makes no peak, as the band ends on its flank."""
    assert any("40.000 Hz" in line for line in said(name, Example(frequency_hz=(6.3, 13.7, 39.8), noise_m_s2=0.05)))


@pytest.mark.parametrize("name", ["auto", "maximum-likelihood"])
def test_a_pole_of_which_the_band_shows_one_flank_is_named(name: str) -> None:
    lines = said(name, Example(frequency_hz=(6.3, 13.7, 39.8), noise_m_s2=0.05))
    assert len(lines) == 1 and "39.8" in lines[0] and "widen the band" in lines[0]


@pytest.mark.parametrize("name", [*IMPULSE, "auto"])
@pytest.mark.parametrize("example", [Example(noise_m_s2=0.5), Example(), LIGHT], ids=["noisy", "clean", "light"])
def test_nothing_is_said_where_all_is_claimed_or_there_is_nothing(name: str, example: Example) -> None:
    assert said(name, example) == []


@pytest.mark.parametrize("name", IMPULSE)
def test_noise_is_no_peak(name: str) -> None:
    assert not any("sigma-plot" in x or "rise" in x for x in said(name, Example(force_n=1e-6, noise_m_s2=1.0)))
