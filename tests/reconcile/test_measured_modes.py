"""Modes as responses show them: against sums of modes in closed form, and the truth of simulated records."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from vgvt.reconcile.outcome.measured_modes import mac_of_residues, seen_modes
from vgvt.reconcile.question.data import measured_frfs
from vgvt.scenario import load_scenario
from vgvt.simulation import simulate

Array = NDArray[np.float64]
HZ, DAMPING = np.array([4.0, 9.0, 9.7, 20.0]), np.array([0.02, 0.015, 0.012, 0.01])
LINES = np.linspace(2.0, 30.0, 900)
SHAPES = np.array(
    [[1.0, 0.8, 0.3, -0.2, 0.5], [0.4, -0.7, 1.0, 0.2, 0.0], [-0.5, 0.9, 0.6, 1.0, 0.1], [0.2, 1.0, -1.0, 0.3, 0.4]]
)
NOTHING = np.ones((5, LINES.size))
ONE_RUN = np.zeros(5, dtype=int)


def response(hz: Array = HZ, damping: Array = DAMPING, shapes: Array = SHAPES) -> NDArray[np.complex128]:
    """Accelerances (5, L) of modes driven at the first channel."""
    s = 2j * np.pi * LINES
    omega = 2 * np.pi * hz[:, None]
    poles = s**2 / (s**2 + 2 * damping[:, None] * omega * s + omega**2)
    return np.einsum("mc,m,ml->cl", shapes, shapes[:, 0], poles)


def test_modes_that_overlap_are_told_apart() -> None:
    """Two of the four are 7 % apart, each 3 % wide; begun 1 % off, with damping half as large again."""
    found = seen_modes(response(), NOTHING, LINES, ONE_RUN, HZ * 1.01, DAMPING * 1.5)
    for k, seen in enumerate(found):
        assert seen is not None
        # What is left is the other modes' curvature over the window.
        assert seen.frequency_hz == pytest.approx(HZ[k], rel=2e-4)
        assert seen.damping_ratio == pytest.approx(DAMPING[k], rel=2e-2)
        own = np.abs(np.vdot(seen.residues, SHAPES[k])) ** 2
        assert own / (np.linalg.norm(seen.residues) * np.linalg.norm(SHAPES[k])) ** 2 > 0.999
        assert seen.residues == pytest.approx(SHAPES[k] * SHAPES[k, 0], abs=0.05)


def test_a_weak_mode_between_strong_ones_is_seen_where_it_is() -> None:
    """A hundredth of their size, as an absorber's is: with a straight line for all the others it is 1 % off."""
    hz, damping = np.array([8.0, 12.2, 15.3]), np.array([0.012, 0.02, 0.013])
    weak = SHAPES[:3] * np.array([1.0, 0.1, 1.0])[:, None]
    (seen,) = seen_modes(response(hz, damping, weak), NOTHING, LINES, ONE_RUN, [12.1], [0.03])
    assert seen is not None
    assert seen.frequency_hz == pytest.approx(12.2, rel=1e-3)
    assert seen.damping_ratio == pytest.approx(0.02, rel=0.05)


def test_their_deviations_are_those_of_noise() -> None:
    """Of 40 readings with 2 % noise, in deviations that each states: chi-square bounds at one in a thousand."""
    g, clean = np.random.default_rng(4), response()
    size = 0.02 * np.abs(clean).max(axis=1, keepdims=True) / np.sqrt(2)
    off = []
    for _ in range(40):
        noise = g.standard_normal(clean.shape) + 1j * g.standard_normal(clean.shape)
        (seen,) = seen_modes(clean + size * noise, NOTHING, LINES, ONE_RUN, HZ[3:], DAMPING[3:])
        assert seen is not None
        off += [
            (seen.frequency_hz - HZ[3]) / seen.frequency_std_hz,
            (seen.damping_ratio - DAMPING[3]) / seen.damping_std,
        ]
    assert 0.6 < np.mean(np.square(off)) < 1.6
    assert abs(np.mean(off)) < 0.4


def test_runs_have_poles_of_their_own_and_a_mean() -> None:
    """Sensors that rove: three runs apart by half a per cent; a run whose sensors sit in nodes says nothing."""
    shifts = np.array([-0.005, 0.0, 0.005])
    runs = [response(hz=HZ * (1 + shift)) for shift in shifts]
    values = np.concatenate([*runs, np.zeros((5, LINES.size))])
    run_of, sigma = np.repeat([0, 2, 3, 7], 5), np.ones((20, LINES.size))
    (seen,) = seen_modes(values, sigma, LINES, run_of, HZ[:1], DAMPING[:1])
    assert seen is not None and seen.runs == 3
    assert seen.frequency_hz == pytest.approx(4.0, rel=1e-3)
    # The deviation of a mean of three.
    assert seen.frequency_std_hz == pytest.approx(4.0 * np.std(shifts) / np.sqrt(2), rel=0.1)
    assert np.isnan(seen.residues[15:]).all() and np.isfinite(seen.residues[:15]).all()


def test_a_start_far_off_finds_its_lines() -> None:
    """Begun 7 % off, with a window of 4 half-power widths: the lines are chosen anew where the fit has led."""
    alone = response(HZ[:1], DAMPING[:1], SHAPES[:1])
    rest = 0.3 * response(HZ[3:], DAMPING[3:], SHAPES[3:])
    (seen,) = seen_modes(alone + rest, NOTHING, LINES, ONE_RUN, [4.28], [0.02])
    assert seen is not None
    assert seen.frequency_hz == pytest.approx(4.0, rel=2e-5) and seen.damping_ratio == pytest.approx(0.02, rel=2e-3)
    # Of noisy records they say as much of it as where it was begun at its place.
    g = np.random.default_rng(7)
    noisy = alone + 0.5 * (g.standard_normal(alone.shape) + 1j * g.standard_normal(alone.shape))
    far, near = (seen_modes(noisy, NOTHING, LINES, ONE_RUN, [hz], [0.02])[0] for hz in (4.28, 4.0))
    assert far is not None and near is not None
    assert far.frequency_hz == pytest.approx(near.frequency_hz, abs=0.2 * near.frequency_std_hz)


def test_how_a_channel_is_judged_weighs_it_and_scales_no_residue() -> None:
    """One that noise drowns says little of the pole; residues are those of A/F."""
    g, clean = np.random.default_rng(2), response(HZ[3:], DAMPING[3:], SHAPES[3:])
    noise = g.standard_normal(clean.shape) + 1j * g.standard_normal(clean.shape)
    sigma = np.where(np.arange(5)[:, None] == 1, 20.0, 0.05) * np.ones_like(NOTHING)
    (seen,) = seen_modes(clean + sigma * noise, sigma, LINES, ONE_RUN, HZ[3:], DAMPING[3:])
    assert seen is not None
    assert seen.residues[[0, 2, 3, 4]] == pytest.approx(SHAPES[3, [0, 2, 3, 4]] * SHAPES[3, 0], abs=0.01)
    (blind,) = seen_modes(clean + sigma * noise, NOTHING, LINES, ONE_RUN, HZ[3:], DAMPING[3:])
    assert blind is None or seen.frequency_std_hz < 0.2 * blind.frequency_std_hz


def test_what_is_not_there_is_not_seen() -> None:
    """A start in a valley finds no mode, nor the neighbour's; without lines around it there is no fit."""
    alone = response(HZ[:1], DAMPING[:1], SHAPES[:1])
    astray, seen = seen_modes(alone, NOTHING, LINES, ONE_RUN, [6.0, 4.0], [0.02, 0.02])
    assert astray is None and seen is not None
    few = LINES[::300]
    assert seen_modes(alone[:, ::300], NOTHING[:, ::300], few, ONE_RUN, [4.0], [0.02]) == [None]


@pytest.mark.parametrize("damping", [0.0, -0.01, 1e-9])
def test_a_model_s_mode_without_damping_is_where_a_fit_begins(damping: float) -> None:
    """An unstable one ended the whole command, after its search."""
    (seen,) = seen_modes(response(), NOTHING, LINES, ONE_RUN, HZ[3:], [damping])
    assert seen is not None and seen.damping_ratio == pytest.approx(DAMPING[3], rel=1e-2)


def test_a_response_that_is_not_finite_shows_nothing() -> None:
    """A joint's march that ran away is foretold as no number; the other run says what it says."""
    values = np.concatenate([response(), np.full((5, LINES.size), np.nan)])
    (seen,) = seen_modes(values, np.ones((10, LINES.size)), LINES, np.repeat([0, 1], 5), HZ[3:], DAMPING[3:])
    assert seen is not None and seen.runs == 1


def test_a_mode_is_seen_once() -> None:
    """Two modes of a model beside one of the records: it is that of the nearer one."""
    alone = response(HZ[:1], DAMPING[:1], SHAPES[:1])
    near, far = seen_modes(alone, NOTHING, LINES, ONE_RUN, [4.02, 4.3], [0.004, 0.004])
    assert near is not None and far is None


def test_shapes_are_held_against_each_other_where_both_are_known() -> None:
    (one,) = seen_modes(response(), NOTHING, LINES, ONE_RUN, HZ[:1], DAMPING[:1])
    assert one is not None
    turned = replace(one, residues=-3j * one.residues)
    assert mac_of_residues(one, turned) == pytest.approx(1.0)
    part = replace(one, residues=np.where(np.arange(5) < 2, np.nan, one.residues))
    assert mac_of_residues(one, part) == pytest.approx(1.0)
    assert mac_of_residues(one, replace(one, residues=np.full(5, np.nan, dtype=complex))) is None
    (other,) = seen_modes(response(), NOTHING, LINES, ONE_RUN, HZ[3:], DAMPING[3:])
    assert other is not None
    assert mac_of_residues(one, other) == pytest.approx(
        np.dot(SHAPES[0], SHAPES[3]) ** 2 / (np.dot(SHAPES[0], SHAPES[0]) * np.dot(SHAPES[3], SHAPES[3])), abs=0.02
    )


def test_simulated_records_show_the_modes_of_their_truth() -> None:
    """Whole records with their instruments' noise, against the sealed truth: closer than a line of the spectrum."""
    result = simulate(load_scenario("quick"), engine="linear")
    measured, truth = measured_frfs(result.campaign, lines=500), result.truth.as_tested[0]
    low, high = measured.frequency_hz[[0, -1]]
    inside = (truth.natural_frequency_hz > low) & (truth.natural_frequency_hz < high)
    hz, damping = truth.natural_frequency_hz[inside], truth.damping_ratio[inside]
    assert hz.size >= 3
    run_of = np.array([c.run for c in measured.channels])
    found = seen_modes(measured.values, measured.sigma, measured.frequency_hz, run_of, 1.01 * hz, 1.4 * damping)
    for k, seen in enumerate(found):
        assert seen is not None
        assert seen.frequency_hz == pytest.approx(hz[k], rel=1e-4)
        assert seen.damping_ratio == pytest.approx(damping[k], rel=5e-3)
