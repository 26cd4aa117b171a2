"""What is the same everywhere: a law of the whole airframe's stiffness, against airframes that are given it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
from reconciled_case import campaign_of, roving_scenario

from vgvt.effects import available_effects
from vgvt.reconcile.evidence.nameless import with_nameless
from vgvt.reconcile.evidence.smooth_law import SmoothLaw
from vgvt.reconcile.evidence.still_explained import still_explained
from vgvt.reconcile.evidence.whole_airframe import WHOLE, whole_airframe
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.next_test.before_test import expected_fit
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.scenario import load_scenario

KNOWN = available_effects()
LATER = np.array([0.0, 1.0, 1.0, 1.0])


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    scenario = roving_scenario()
    return make_problem(campaign_of(scenario, 3), scenario, lines=120, cache=tmp_path_factory.mktemp("cache"))


def drifted(case: Problem, drift: float) -> Fit:
    """The stated aircraft, all of its stiffness another one from run 2 on."""
    hypothesis = Hypothesis(KNOWN["run-drift"], {"shape": "step", "from_run": 2})
    return fit(case, (hypothesis,), np.zeros(case.size), hypothesis.scores({"drift": drift}), ())


@pytest.mark.parametrize("drift", [0.04, -0.04])
def test_a_law_is_exact_however_large(plain: Problem, drift: float) -> None:
    """Peaks that move by half their width and more, against the structure assembled so."""
    u, e = np.zeros(plain.size), np.zeros(0)
    here = anchor(plain, u, (), e)
    law = np.full(plain.measured.frequency_hz.size, drift, dtype=complex)
    acting = SmoothLaw(tuple(whole_airframe(here)), LATER)
    without, found = here.predict(u, e), acting.on(here, law).predict(u, e)
    wanted = drifted(plain, drift).predicted
    to_first_order = without + acting.by_law(here, 0 * law, u, e) * law
    size = np.linalg.norm(wanted - without)
    assert np.linalg.norm(to_first_order - wanted) > 0.3 * size
    # A law leaves dashpots as they are; beside another stiffness as stated they follow, as ratios stay.
    assert np.linalg.norm(found - wanted) < 0.03 * size


def test_a_free_beam_that_is_so_much_stiffer_has_the_frequencies_of_closed_forms(tmp_path: Path) -> None:
    """(βL)²/(2πL²) √(EI/m) and n/(2L) √(GJ/I) times √(1 + z), of a law z = 0.21: all of the energy, and no other.

    The lowest bending mode is left out: the spring lifts it by a hundredth.
    """
    case = expected_fit(load_scenario("teaching-beam"), lines=40, cache=tmp_path).problem
    here = anchor(case, np.zeros(case.size), (), np.zeros(0))
    (place,) = whole_airframe(here)
    assert place.rows is not None
    structure, rows = here.assembled[0].structure, place.rows[0]
    squared = scipy.linalg.eigh(structure.stiffness + 0.21 * rows.T @ rows, structure.mass, eigvals_only=True)
    found = np.sqrt(np.maximum(squared, 0.0)) / (2 * np.pi)
    length_m, ei, gj, mass, inertia = 2.0, 40.0, 20.0, 1.0, 0.01
    bending = [b**2 / (2 * np.pi * length_m**2) * np.sqrt(ei / mass) for b in (7.853205, 10.995608)]
    torsion = [n / (2 * length_m) * np.sqrt(gj / inertia) for n in (1, 2, 3)]
    for stated in (*bending, *torsion):
        assert np.abs(found / (1.1 * stated) - 1).min() < 0.005


def test_where_an_airframe_has_less_than_no_mass_it_is_no_place(plain: Problem) -> None:
    here = anchor(plain, np.zeros(plain.size), (), np.zeros(0))
    first, *others = here.assembled
    taken = replace(first, structure=replace(first.structure, mass=-first.structure.mass))
    assert [p.label for p in whole_airframe(here)] == [WHOLE]
    assert whole_airframe(replace(here, assembled=(taken, *others))) == []


def test_slopes_are_those_of_the_law(plain: Problem) -> None:
    u, e = np.zeros(plain.size), np.zeros(0)
    here = anchor(plain, u, (), e)
    acting, law = SmoothLaw(tuple(whole_airframe(here)), LATER), np.full(plain.measured.frequency_hz.size, 0.02 + 0.01j)
    step = 1e-6
    difference = (acting.on(here, law + step).predict(u, e) - acting.on(here, law - step).predict(u, e)) / (2 * step)
    slopes = acting.by_law(here, law, u, e)
    assert np.linalg.norm(difference - slopes) < 1e-5 * np.linalg.norm(slopes)


@pytest.mark.parametrize(
    ("coefficient", "drift", "loss"), [pytest.param(0.0, -0.02, 0.0, marks=pytest.mark.slow), (0.03, -0.02, 0.0144)]
)
def test_a_warming_without_a_name_is_told(tmp_path: Any, coefficient: float, drift: float, loss: float) -> None:
    """20 K from run 3 on, at 0.1 % of stiffness a kelvin, and ratios of 1.2 % that are 60 % more, or stay."""
    scenario = roving_scenario()
    warming = KNOWN["temperature-change"](
        warming_k=20.0, stiffness_per_k=-1e-3, damping_per_k=coefficient, shape="step", from_run=3
    )
    case = make_problem(campaign_of(scenario, 5, warming), scenario, lines=160, cache=tmp_path)
    null = calibrate(case)
    where = still_explained(null)
    assert where is not None
    assert (where.label, where.kind, where.when) == (WHOLE, "airframe", "from run 3 on")
    told = with_nameless(case, (), null.u, null.e, where)
    assert told is not None
    stiffness, found = told.law.reading.parts
    assert stiffness.value == pytest.approx(drift, abs=4 * stiffness.std)
    assert stiffness.std < 0.2 * abs(drift)
    assert found.value == pytest.approx(loss, abs=4 * found.std)
    assert found.std < 0.003
    assert told.in_words.startswith("a factor on the stiffness of the whole airframe from run 3 on")
