"""Which modes outside the band count as unknowns: those whose absence would show, found again by least squares."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.simulation.fisher import (
    BACKGROUND,
    accelerance,
    deviations,
    information_of_responses,
    lines_for,
    weighted_slopes,
)
from vgvt.simulation.unknowns import FURTHER_TERMS, Unknowns, unknowns

HZ = np.array([0.4, 0.6, 9.0, 14.0, 24.0, 60.0])
POLES = 2 * np.pi * HZ * (-0.015 + 1j * np.sqrt(1 - 0.015**2))
INSIDE = np.array([2, 3])
BAND = (7.0, 20.0)
LINES = lines_for(BAND, POLES[INSIDE])
RESIDUES = np.random.default_rng(5).uniform(-0.02, 0.02, (6, 4)) / (2j * POLES.imag[:, None])
RESPONSES = accelerance(LINES.frequency_hz, POLES, RESIDUES)
PRICE = 2 * 4 + 2


def asked(weight: float, responses: np.ndarray = RESPONSES) -> Unknowns:
    return unknowns(LINES, POLES, INSIDE, np.full(LINES.frequency_hz.size, weight), responses)


def misfit(weight: float, modes: np.ndarray, powers: tuple[int, ...]) -> float:
    """What the weighted responses (4) have left when modes with these poles and powers of s are fitted to them."""
    s = 2j * np.pi * LINES.frequency_hz
    pairs = [(1 / (s - p), 1 / (s - p.conj())) for p in POLES[modes]]
    columns = [s**2 * (a + b) for a, b in pairs] + [1j * s**2 * (a - b) for a, b in pairs]
    columns += [(s / abs(s).mean()) ** n for n in powers]
    root = np.sqrt(weight * LINES.width_hz)
    both = [np.concatenate([c.real * root, c.imag * root]) for c in columns]
    matrix = np.transpose([c / np.linalg.norm(c) for c in both])
    values = np.transpose([np.concatenate([r.real * root, r.imag * root]) for r in RESPONSES])
    found = np.linalg.lstsq(matrix, values, rcond=None)[0]
    return float(((values - matrix @ found) ** 2).sum())


@pytest.mark.parametrize("weight", [1e3, 1e6, 1e9, 1e13])
def test_what_is_left_out_costs_less_than_its_unknowns_and_what_is_not_costs_more(weight: float) -> None:
    found = asked(weight)
    whole = misfit(weight, found.modes, found.background)
    for mode in np.setdiff1d(np.arange(6), found.modes):
        assert whole - misfit(weight, np.append(found.modes, mode), found.background) <= PRICE
    for mode in np.setdiff1d(found.modes, INSIDE):
        assert misfit(weight, np.setdiff1d(found.modes, [mode]), found.background) - whole > PRICE


def test_a_faint_test_asks_for_the_band_alone_and_a_strong_one_for_its_neighbours() -> None:
    faint, strong = asked(1e-3), asked(1e13)
    assert faint.modes.tolist() == INSIDE.tolist()
    assert faint.background == BACKGROUND
    assert 4 in strong.modes, "the mode just above"
    assert strong.background == (*FURTHER_TERMS, *BACKGROUND) or {0, 1} & set(strong.modes.tolist()), "those below"


def test_a_mode_that_nobody_sees_is_not_asked_for() -> None:
    unseen = accelerance(LINES.frequency_hz, POLES, RESIDUES * (np.arange(6) != 4)[:, None])
    assert 4 not in asked(1e9, unseen).modes


def test_a_neighbour_that_is_unknown_takes_from_what_is_known() -> None:
    weight = np.full(LINES.frequency_hz.size, 1e6)
    stds = []
    for modes in (INSIDE, np.append(INSIDE, 4)):
        gram = weighted_slopes(LINES, POLES[modes], weight)
        stds.append(deviations(POLES[modes], information_of_responses(gram, RESIDUES[modes]).sum(axis=0))[1][:2])
    assert (stds[1] > stds[0]).all()
    assert stds[1][1] > 1.02 * stds[0][1], "the nearer mode most"
