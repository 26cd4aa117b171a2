"""Lines are chosen among those that hold force: the harmonics of a multisine, and every line of anything else."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from added_noise import Noise
from reconciled_case import small_scenario, without_instrument_noise

from vgvt.data import Campaign
from vgvt.reconcile.question import data
from vgvt.reconcile.question.data import Measured, measured_frfs
from vgvt.reconcile.question.excited import excited_lines
from vgvt.scenario import Scenario
from vgvt.simulation import simulated_campaign

RATE_HZ = 100.0
PERIOD_S = 8.0
BANDS = 5


def excited_by(**excitation: Any) -> Campaign:
    """Two runs of four accelerometers with ideal instruments, and another excitation than the scenario's sweep."""
    scenario = without_instrument_noise(small_scenario())
    runs = ((1, 6, 13, 18), (3, 8, 11, 20))
    whole = scenario.excitation.model_dump(exclude_none=True) | excitation
    changed: Scenario = scenario.model_copy(
        update={
            "acquisition": scenario.acquisition.model_copy(update={"runs": runs, "sample_rate_hz": RATE_HZ}),
            "excitation": type(scenario.excitation).model_validate(whole),
        }
    )
    return simulated_campaign(changed, engine="linear")


def multisine(periods: int, lines: str = "full", rest_s: float = 0.0) -> Campaign:
    return excited_by(kind="multisine", duration_s=periods * PERIOD_S, blocks=periods, lines=lines, ring_down_s=rest_s)


def on_harmonics(measured: Measured, lines: str) -> float:
    """The share of the lines that are next to a harmonic that the shaker was given: records end a sample later."""
    order = measured.frequency_hz * PERIOD_S
    near = np.abs(order - np.rint(order)) < measured.resolution_hz * PERIOD_S
    return float((near & ((np.rint(order) % 2 == 1) | (lines == "full"))).mean())


def without_preference(monkeypatch: pytest.MonkeyPatch, campaign: Campaign, count: int) -> Measured:
    """The same where every line counts as excited."""
    with monkeypatch.context() as patched:
        patched.setattr(data, "excited_lines", lambda force: np.ones(force.shape[1], dtype=bool))
        return measured_frfs(campaign, lines=count)


@pytest.mark.parametrize(("periods", "lines"), [(4, "full"), (8, "full"), (4, "odd"), (16, "odd")])
def test_lines_of_a_multisine_are_its_harmonics(monkeypatch: pytest.MonkeyPatch, periods: int, lines: str) -> None:
    campaign = multisine(periods, lines)
    chosen = measured_frfs(campaign, lines=100)
    assert chosen.lines.size >= 90
    assert on_harmonics(chosen, lines) > 0.95
    assert on_harmonics(without_preference(monkeypatch, campaign, 100), lines) < 0.6


@pytest.mark.parametrize(("periods", "lines"), [(4, "full"), (8, "full"), (8, "odd")])
def test_their_noise_is_what_was_added(periods: int, lines: str) -> None:
    """Around a harmonic most lines hold no force, and tell of noise all the same."""
    campaign, noise, generator = multisine(periods, lines, rest_s=8.0), Noise(0.05, False), np.random.default_rng(7)
    ratios, squared = [], []
    for _ in range(6):
        measured = measured_frfs(noise.on(campaign, generator), lines=100)
        assert not measured.remarks
        exact, variance = noise.variance(campaign, measured)
        ratios.append([part.mean() for part in np.array_split(measured.noise / variance, BANDS, axis=1)])
        squared.append(np.mean(np.abs(measured.values - exact) ** 2 / variance))
    bands = np.mean(ratios, axis=0)
    assert np.mean(squared) == pytest.approx(1.0, abs=0.1)
    assert bands.mean() == pytest.approx(1.0, abs=0.1), bands
    assert np.abs(bands - 1).max() < 0.25, bands


def test_where_harmonics_are_few_other_lines_join_them() -> None:
    """Less than half of what was asked for: all harmonics, and lines between them."""
    campaign = multisine(4, "odd")
    few, many = measured_frfs(campaign, lines=200), measured_frfs(campaign, lines=400)
    assert on_harmonics(few, "odd") > 0.9
    assert many.lines.size > 350
    assert np.isin(few.lines, many.lines).all()


@pytest.mark.parametrize(
    "excitation",
    [
        {},
        {"kind": "logarithmic-chirp"},
        {"kind": "random", "duration_s": 32.0},
        {"kind": "burst-random", "duration_s": 32.0, "blocks": 4, "burst_fraction": 0.5},
        {"kind": "multisine", "duration_s": 16.0, "blocks": 1, "lines": "full"},
    ],
    ids=["linear chirp", "logarithmic chirp", "random", "bursts", "one period"],
)
def test_what_excites_every_line_is_thinned_as_ever(
    monkeypatch: pytest.MonkeyPatch, excitation: dict[str, Any]
) -> None:
    campaign = excited_by(**excitation)
    for count in (100, 300):
        chosen = measured_frfs(campaign, lines=count)
        np.testing.assert_array_equal(chosen.lines, without_preference(monkeypatch, campaign, count).lines)


def comb(spacing: int, dark: float, count: int = 1024) -> tuple[np.ndarray, np.ndarray]:
    """Magnitudes (K,) of scattered lines with harmonics a hundred times as loud, and which those are."""
    g = np.random.default_rng(3)
    harmonic = np.arange(count) % spacing == spacing // 2
    scattered = np.abs(g.standard_normal(count) + 1j * g.standard_normal(count)) * dark
    return np.where(harmonic, 1.0, scattered), harmonic


@pytest.mark.parametrize("spacing", [3, 8, 32])
def test_a_harmonic_that_a_resonance_takes_the_force_from_is_one(spacing: int) -> None:
    """A fifth of its neighbours' force is left there, far above what is between."""
    size, harmonic = comb(spacing, 0.01)
    at = np.arange(size.size)
    force = size * np.where(harmonic, 1 - 0.8 / (1 + ((at - 500) / 30) ** 2), 1.0)
    np.testing.assert_array_equal(excited_lines(force[None]), harmonic)


def test_beside_the_excited_band_no_line_is() -> None:
    size, harmonic = comb(8, 0.01)
    size[600:] = comb(4096, 0.005)[0][600:]
    found = excited_lines(size[None])
    np.testing.assert_array_equal(found[:600], harmonic[:600])
    assert not found[600:].any()


def test_a_line_needs_the_force_of_every_run() -> None:
    """Runs of other periods have few harmonics in common; a sweep excites those of any."""
    (one, harmonic), (other, others) = comb(4, 0.01), comb(6, 0.01)
    np.testing.assert_array_equal(excited_lines(np.array([one, other])), harmonic & others)
    np.testing.assert_array_equal(excited_lines(np.array([one, np.ones_like(one)])), harmonic)


@pytest.mark.parametrize("count", [200, 2000])
def test_scatter_is_no_comb(count: int) -> None:
    g = np.random.default_rng(5)
    for _ in range(50):
        force = np.abs(g.standard_normal((3, count)) + 1j * g.standard_normal((3, count)))
        assert excited_lines(force).all()
