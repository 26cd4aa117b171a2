"""The bell fit recovers the bell of one mode, and refuses what is none."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt_identifiers.bell_fit import bell_fit

FREQUENCY = np.arange(1.0, 40.0, 1 / 60)


def bell(natural_hz: float, damping: float, constant: float, differentiations: int = 2) -> np.ndarray:
    """A squared singular value of one mode, frequencies in hertz."""
    f = FREQUENCY
    return np.asarray(
        constant * f ** (2 * differentiations) / ((natural_hz**2 - f**2) ** 2 + (2 * damping * natural_hz * f) ** 2)
    )


@pytest.mark.parametrize("differentiations", [0, 1, 2])
@pytest.mark.parametrize("damping", [0.002, 0.01, 0.03])
def test_an_exact_bell_comes_back(damping: float, differentiations: int) -> None:
    power = bell(19.03, damping, 0.7, differentiations)
    fit = bell_fit(FREQUENCY, power, 19.0, differentiations=differentiations)
    assert fit.natural_frequency_hz == pytest.approx(19.03, rel=1e-6)
    assert fit.damping_ratio == pytest.approx(damping, rel=1e-4)
    assert fit.constant == pytest.approx(0.7, rel=1e-4)


def test_the_acceleration_factor_matters() -> None:
    """Read as a displacement, the bell of an acceleration peaks too high."""
    wrong = bell_fit(FREQUENCY, bell(10.0, 0.05, 1.0), 10.0, differentiations=0, search_hz=1.0)
    right = bell_fit(FREQUENCY, bell(10.0, 0.05, 1.0), 10.0, differentiations=2, search_hz=1.0)
    assert right.natural_frequency_hz == pytest.approx(10.0, rel=1e-6)
    assert wrong.natural_frequency_hz > 10.005


def test_scatter_of_a_fifth_moves_it_by_less_than_a_tenth_of_its_width() -> None:
    generator = np.random.default_rng(11)
    for _ in range(20):
        power = bell(19.03, 0.0075, 0.7) * np.exp(0.2 * generator.standard_normal(FREQUENCY.size))
        fit = bell_fit(FREQUENCY, power, 19.0)
        assert abs(fit.natural_frequency_hz - 19.03) < 0.1 * 2 * 0.0075 * 19.03


def test_the_bell_ends_at_the_trough_before_the_next_mode() -> None:
    power = bell(10.0, 0.01, 1.0) + bell(11.0, 0.01, 1.0)
    fit = bell_fit(FREQUENCY, power, 10.0, drop_db=40.0)
    assert fit.natural_frequency_hz == pytest.approx(10.0, abs=0.02)
    assert fit.lines / 60 < 8.0


def test_a_slope_is_no_bell() -> None:
    with pytest.raises(InputError, match="bell fit"):
        bell_fit(FREQUENCY, FREQUENCY**4, 19.0)


def test_a_frequency_outside_the_axis_is_bad_input() -> None:
    with pytest.raises(InputError, match="no line within"):
        bell_fit(FREQUENCY, bell(19.0, 0.01, 1.0), 60.0)
