"""Spectra of commands that are kept are those that would be found anew, and are found once for each excitation."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from small_rig import revised

from vgvt.effects.action import Action
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import command_spectra as kept
from vgvt.simulation.assembly import Plan, plans
from vgvt.simulation.command_spectra import command_spectra
from vgvt.simulation.fisher import lines_for

LINES = lines_for((4.0, 30.0), np.array([-1 + 60j]))


@pytest.fixture(autouse=True)
def nothing_known(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept, "_known", {})


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[tuple[Plan, int]]]:
    """What was transformed."""
    asked: list[tuple[Plan, int]] = []
    transformed = kept._transformed
    monkeypatch.setattr(kept, "_transformed", lambda *what: asked.append(what) or transformed(*what))
    yield asked


def sweep(seed: int = 1, **changes: Any) -> Scenario:
    return revised(load_scenario("quick"), **changes).model_copy(update={"seed": seed})


def anew(layout: Plan, run: int) -> NDArray[np.complex128]:
    kept._known = {}
    return command_spectra(layout, run, LINES)


NOISE = {"kind": "random", "taper_s": 0.5}
CASES = [
    {},
    {"excitation": {"amplitude_v": 2.0}},
    {"excitation": {"kind": "logarithmic-chirp"}},
    {"excitation": {"unrecorded_s": 1.0}},
    {"generator": {"range_v": 0.5}},
    {"generator": {"range_v": 10.0, "bits": 8}},
    {"excitation": NOISE},
    {"excitation": NOISE, "seed": 7},
]


def test_kept_ones_are_those_found_anew_to_the_last_bit() -> None:
    """After all others were asked for, whose scenarios differ by one thing each."""
    layouts = [plans(sweep(**case))[0] for case in CASES]
    asked = [(layout, run) for layout in layouts for run in (0, 1)]
    wanted = [anew(layout, run) for layout, run in asked]
    kept._known = {}
    for _ in range(2):
        for (layout, run), want in zip(asked, wanted, strict=True):
            np.testing.assert_array_equal(command_spectra(layout, run, LINES), want)
    # Each is another one, but runs of a sweep, and those of a generator without steps.
    assert len({w.tobytes() for w in wanted}) == len(kept._known) == 10


def test_other_lines_are_asked_of_the_same_transform(made: list[tuple[Plan, int]]) -> None:
    layout, other = plans(sweep())[0], lines_for((5.0, 20.0), np.array([-1 + 90j]))
    first = command_spectra(layout, 0, LINES)
    first[:] = np.nan
    np.testing.assert_array_equal(command_spectra(layout, 0, other), anew_on(layout, other))
    assert np.isfinite(command_spectra(layout, 0, LINES)).all()
    assert len(made) == 2


def anew_on(layout: Plan, lines: Any) -> NDArray[np.complex128]:
    kept._known = {}
    return command_spectra(layout, 0, lines)


def test_what_effects_and_hammers_do_is_not_kept(made: list[tuple[Plan, int]]) -> None:
    """A function is known by nothing but what it gives."""
    layout = plans(sweep())[0]
    plain = command_spectra(layout, 0, LINES)
    for factor in (2.0, 3.0, 3.0):
        loud = replace(layout, actions=(Action(command=lambda command, time, factor=factor: factor * command),))
        np.testing.assert_allclose(command_spectra(loud, 0, LINES), factor**2 * plain, rtol=1e-12)
    assert len(made) == 4
    struck = plans(load_scenario("teaching-beam-hammer"))[0]
    for _ in range(2):
        command_spectra(struck, 0, LINES)
    assert len(made) == 6
    assert len(kept._known) == 1


def test_no_more_is_kept_than_fits(monkeypatch: pytest.MonkeyPatch, made: list[tuple[Plan, int]]) -> None:
    layouts = [plans(sweep(excitation={"amplitude_v": volts}))[0] for volts in (1.0, 2.0, 3.0)]
    command_spectra(layouts[0], 0, LINES)
    (one,) = kept._known.values()
    monkeypatch.setattr(kept, "_KEPT_BYTES", 2.5 * (one.totals.nbytes + one.axis.nbytes))
    for layout in (*layouts, layouts[1], layouts[0]):
        command_spectra(layout, 0, LINES)
        assert len(kept._known) <= 2
    # The first had been asked for longest ago when the third came.
    assert [layout.scenario.excitation.amplitude_v for layout, _ in made] == [1.0, 2.0, 3.0, 1.0]
    monkeypatch.setattr(kept, "_KEPT_BYTES", 10)
    command_spectra(layouts[1], 0, LINES)
    assert not kept._known


def test_threads_find_the_same() -> None:
    layouts = [plans(sweep(excitation={"amplitude_v": 1.0 + k / 8}))[0] for k in range(8)]
    wanted = [anew(layout, 0) for layout in layouts]
    kept._known = {}
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda k: command_spectra(layouts[k % 8], 0, LINES), range(64)))
    for k, got in enumerate(found):
        np.testing.assert_array_equal(got, wanted[k % 8])
