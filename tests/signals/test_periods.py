"""Periodic excitation in steady state: what repeats, from when on, and responses at the harmonics alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from vgvt.data import Campaign, FrequencyResponseSet, InputError
from vgvt.signals import Periods, estimate_frf

RATE = 200.0
BAND = (6.0, 16.0)
PERIOD_S, COUNT = 5.0, 8
GAINS = np.array([[1.0, 0.4], [-0.3, 1.2]])


def multisine(seed: int = 1, step: int = 1) -> NDArray[np.float64]:
    """Periods of harmonics ``step`` apart, the first among them, from 2 to 40 Hz."""
    time = np.arange(round(PERIOD_S * COUNT * RATE)) / RATE
    harmonics = np.arange(1, 40 * PERIOD_S, step)
    harmonics = harmonics[harmonics >= 2 * PERIOD_S]
    phase = np.random.default_rng(seed).uniform(0, 2 * np.pi, harmonics.size)
    return np.sin(2 * np.pi * np.outer(time, harmonics) / PERIOD_S + phase).sum(axis=1)


def campaign(make_campaign, records: list[dict[str, NDArray]], **note: object) -> Campaign:
    made = make_campaign(records, band_hz=BAND)
    return replace(made, notes={"periods": Periods(**({"period_s": PERIOD_S} | note)).note()})


def record(single_mass, force: NDArray[np.float64], begin: int = 0, noise: float = 0.0) -> dict[str, NDArray]:
    moved = single_mass.acceleration(force, RATE)
    moved = moved + noise * moved.std() * np.random.default_rng(9).standard_normal(moved.size)
    return {"F9+Z": force[begin:], "1+Z": moved[begin:]}


def error(single_mass, frf: FrequencyResponseSet, gains: NDArray | float = 1.0) -> float:
    exact = gains * single_mass.held_accelerance(frf.frequency_hz, RATE)
    return float(np.sqrt((np.abs(frf.values - exact) ** 2).mean() / (np.abs(exact) ** 2).mean()))


@pytest.mark.parametrize("begin", [3000, 3137, 7000])
def test_what_repeats_is_averaged_over_whole_periods(make_campaign, single_mass, begin: int) -> None:
    """15 s after the start 3e-9 still rings. Wherever the record begins, and be it one period and a part of one."""
    frf = estimate_frf(campaign(make_campaign, [record(single_mass, multisine(), begin)]), "auto", band_hz=BAND)
    assert error(single_mass, frf) < 1e-6
    np.testing.assert_allclose(frf.frequency_hz * PERIOD_S, np.arange(30, 81))
    assert "at harmonics only" in frf.remarks[-1]


def test_a_record_that_is_one_sample_longer_is_cut(make_campaign, single_mass) -> None:
    long = np.append(multisine(), multisine()[0])
    frf = estimate_frf(campaign(make_campaign, [record(single_mass, long, 3000)]), "auto", band_hz=BAND)
    assert error(single_mass, frf) < 1e-6


@pytest.mark.parametrize(("noise", "least", "within"), [(0.0, 2, 1e-3), (0.02, 5, 0.02)])
def test_periods_before_it_has_settled_are_left_out(make_campaign, single_mass, noise, least: int, within) -> None:
    """From rest the first period is 20 % off or so, the second a thousandth."""
    frf = estimate_frf(campaign(make_campaign, [record(single_mass, multisine(), 0, noise)]), "auto", band_hz=BAND)
    words = frf.remarks[-1].split()
    kept, every = int(words[words.index("last") + 1]), int(words[words.index("whole") - 1])
    assert least <= kept < every == COUNT
    assert error(single_mass, frf) < within
    assert frf.variance is not None


def test_odd_harmonics_alone_are_kept_where_the_others_are_not_excited(make_campaign, single_mass) -> None:
    data = campaign(make_campaign, [record(single_mass, multisine(step=2), 3000)], lines="odd")
    frf = estimate_frf(data, "auto", band_hz=BAND)
    np.testing.assert_allclose(frf.frequency_hz * PERIOD_S, np.arange(31, 81, 2))
    assert error(single_mass, frf) < 1e-6


def test_what_fades_belongs_to_no_period(make_campaign, single_mass) -> None:
    force = multisine() * np.clip((np.arange(8000)[::-1] - 1000) / 1000, 0, 1)
    data = campaign(make_campaign, [record(single_mass, force, 3000)], end_s=(6000 - 3000) / RATE)
    assert error(single_mass, estimate_frf(data, "auto", band_hz=BAND)) < 1e-6


def test_two_forces_are_told_apart_by_as_many_runs(make_campaign, single_mass) -> None:
    """Within a run all periods have the same forces: eight of them are one average of these."""

    def run(seed: int) -> dict[str, NDArray]:
        forces = np.array([multisine(seed), multisine(seed + 1)])
        moved = [single_mass.acceleration(f, RATE)[3000:] for f in GAINS @ forces]
        return {"F8+Z": forces[0, 3000:], "F9+Z": forces[1, 3000:], "1+Z": moved[0], "2+Z": moved[1]}

    frf = estimate_frf(campaign(make_campaign, [run(1), run(3)]), "auto", band_hz=BAND)
    assert error(single_mass, frf, GAINS[:, :, None]) < 1e-6
    one = estimate_frf(campaign(make_campaign, [run(1)]), "auto", band_hz=BAND)
    assert any("under a window" in remark for remark in one.remarks)


def test_periods_between_samples_and_none_at_all_are_left_to_local_fits(make_campaign, single_mass) -> None:
    for period_s in (PERIOD_S + 0.3 / RATE, 100.0):
        frf = estimate_frf(
            campaign(make_campaign, [record(single_mass, multisine(), 3000, 1e-3)], period_s=period_s), "auto"
        )
        assert not any("at harmonics only" in remark for remark in frf.remarks)


@pytest.mark.parametrize(
    "note",
    ["5", "[]", "{}", '{"period_s": 0}', '{"period_s": 5, "begin_s": -1}', '{"period_s": 5, "end_s": 0}',
     '{"period_s": 5, "lines": "even"}'],
)  # fmt: skip
def test_a_note_of_periods_that_cannot_be_read_is_refused(make_campaign, single_mass, note: str) -> None:
    data = make_campaign([record(single_mass, multisine(), 3000)])
    with pytest.raises(InputError, match="cannot be read"):
        estimate_frf(replace(data, notes={"periods": note}), "auto")
