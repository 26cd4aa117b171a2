"""A mode that moves between runs is one mode, though two poles may each stand for it in some of the runs."""

from __future__ import annotations

import numpy as np
import pytest
from pole_case import GAINS, POLES, accelerance, problem

from vgvt_identifiers.double_poles import without_doubles
from vgvt_identifiers.drifting_poles import RunStates, refined_runs
from vgvt_identifiers.pole_fit import PoleProblem
from vgvt_identifiers.pole_search import least_fall

# A roving sensor's mass, by half a per cent.
SHIFTS = (1.0025, 1.0, 0.9975, 1.002, 0.998)


def problem_of(poles: np.ndarray, gains: np.ndarray, seed: int, std: float = 0.05) -> PoleProblem:
    """A run with noise."""
    clean = accelerance(poles, gains)
    noise = np.random.default_rng(seed).standard_normal((2, *clean.shape)) * std
    return problem(clean + noise[0] + 1j * noise[1], std)


def refined(problems: tuple[PoleProblem, ...], common: np.ndarray) -> RunStates:
    return refined_runs(problems, common, np.tile(common, (len(problems), 1)), 12)


@pytest.mark.parametrize("place", [0, 2, 3])
def test_a_mode_that_moves_is_held_by_one_pole(place: int) -> None:
    """With the others where they are, either pole of the pair counts for hundreds of nats and more."""
    modes = [0, 1, 3]
    problems = tuple(problem_of(POLES[modes] * shift, GAINS[:, modes], k) for k, shift in enumerate(SHIFTS))
    needed = least_fall(problems, 1e-3)
    split = refined(problems, np.insert(POLES[modes], place, 1.004 * POLES[1]))
    assert split.poles.size == 4
    assert split.gain.min() > 3 * needed
    found, dropped = without_doubles(problems, split, needed)
    np.testing.assert_allclose(np.sort_complex(found.poles), np.sort_complex(POLES[modes]), rtol=2e-3)
    ((gone, why),) = dropped
    assert abs(abs(gone) - abs(POLES[1])) < 0.01 * abs(POLES[1])
    assert why.startswith("evidence ") and why.endswith("one mode")
    assert found.cost - split.cost < needed
    assert sum(len(s.poles) for s in found.states) == 3 * len(SHIFTS)


def test_two_modes_closer_than_their_widths_are_two() -> None:
    """As they are in every run, however they move: 0.06 Hz apart, each twice as wide."""
    near = np.array([POLES[0], POLES[1], 1.0055 * POLES[1], POLES[3]])
    assert abs(near[2] - near[1]) < -near[1].real
    problems = tuple(problem_of(near * shift, GAINS, k) for k, shift in enumerate(SHIFTS))
    states = refined(problems, near)
    found, dropped = without_doubles(problems, states, least_fall(problems, 1e-3))
    assert not dropped
    assert found is states
