"""A thing without a name is looked for where names are, too, wherever sensors sit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from reconciled_case import campaign_of, roving_scenario

from vgvt.effects import available_effects
from vgvt.reconcile.decision.beside_nameless import places_beside
from vgvt.reconcile.evidence.free_places import free_places, place_at
from vgvt.reconcile.evidence.nameless import with_nameless
from vgvt.reconcile.evidence.place_of_name import place_of_name
from vgvt.reconcile.evidence.smooth_law import SmoothLaw
from vgvt.reconcile.evidence.still_explained import StillExplained
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem

KNOWN = available_effects()
# A hand's breadth and more from every sensor.
AT = {"x_m": 0.68, "y_m": -0.79}
DAMPING = 1.2


@pytest.fixture(scope="module")
def damped(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A campaign with a damper to the ground between sensors."""
    scenario = roving_scenario()
    damper = KNOWN["nonproportional-damper"](damping_n_s_per_m=DAMPING, **AT)
    return make_problem(campaign_of(scenario, 3, damper), scenario, lines=120, cache=tmp_path_factory.mktemp("cache"))


def absorber(case: Problem, u: np.ndarray, *more: Hypothesis) -> Fit:
    """What a search would call it: an absorber that swings below the band, at the place."""
    low = Hypothesis(KNOWN["local-absorber"], {})
    values = {"mass_kg": 0.1, "frequency_hz": 2.5, "damping_ratio": 0.5, **AT}
    return fit(case, (low, *more), u, np.concatenate([low.scores(values), *(np.zeros(1) for _ in more)]), NEAR)


def test_it_is_between_sensors(damped: Problem) -> None:
    away = [np.hypot(p.position_m[0] - AT["x_m"], p.position_m[1] - AT["y_m"]) for p in damped.layouts.first.grid]
    assert min(away) > 0.1


def test_a_law_there_does_what_a_thing_there_does(damped: Problem) -> None:
    """Against a damper that is assembled with the structure; at its nearest sensor a law misses a tenth of that."""
    u, e = np.zeros(damped.size), np.zeros(0)
    here = anchor(damped, u, (), e)
    law = SmoothLaw((place_at(here, **AT),), np.ones(len(damped.measured.runs)))
    size = 2j * np.pi * damped.measured.frequency_hz * DAMPING
    found = law.on(here, size).predict(u, e)
    damper = Hypothesis(KNOWN["nonproportional-damper"], {})
    wanted = fit(damped, (damper,), u, damper.scores({"damping_n_s_per_m": DAMPING, **AT}), ()).predicted
    without = here.predict(u, e)
    change = np.linalg.norm(wanted - without)
    assert np.linalg.norm(found - wanted) < 0.01 * change
    places = free_places(damped, here, damped.split.train)
    far = [(np.hypot(p.position_m[0] - AT["x_m"], p.position_m[1] - AT["y_m"]), p) for p in places if p.position_m]
    near = min(far, key=lambda pair: pair[0])[1]
    elsewhere = SmoothLaw((near,), law.course).on(here, size).predict(u, e)
    assert np.linalg.norm(elsewhere - wanted) > 0.1 * change


def test_places_of_names_that_are_gone_are_asked_and_paid_for(damped: Problem) -> None:
    """As many places as its prior holds that are as sharp; not those of names that stay, or begin with a run."""
    gain = Hypothesis(KNOWN["channel-gain"], {"channels": "force"})
    found = absorber(damped, np.zeros(damped.size), gain)
    beside = StillExplained("force at 14+Z", "structure", 20.0, asked=90)
    there = place_of_name(found, 0, beside)
    assert there is not None
    assert there.point_m == pytest.approx(tuple(found.values(0)[n][0] for n in ("x_m", "y_m")))
    names = [p.name for p in found.hypotheses[0].parameters]
    sd = np.sqrt(np.diag(found.covariance))[damped.size :][[names.index(n) for n in ("x_m", "y_m")]]
    assert (sd < 0.5).all() and there.asked == pytest.approx(90 / sd.prod(), rel=0.01)
    assert place_of_name(found, 1, beside) is None
    late = replace(found.hypotheses[0], settings={"from_run": 2})
    assert place_of_name(replace(found, hypotheses=(late, gain)), 0, beside) is None
    alone = fit(damped, (gain,), found.u, found.e[-1:], ())
    asked = places_beside(found, alone)
    assert [s.point_m for s in asked if s.point_m] == [there.point_m]
    assert not any(s.point_m for s in places_beside(found, found))


@pytest.mark.slow
def test_the_thing_is_told_where_it_is_with_its_law(damped: Problem) -> None:
    """Where an absorber was put for the damper, a law does better than at any sensor, and reads as what it is."""
    null, low = calibrate(damped), Hypothesis(KNOWN["local-absorber"], AT)
    scores = low.scores({"mass_kg": 0.1, "frequency_hz": 2.5, "damping_ratio": 0.5})
    found = fit(damped, (low,), null.u, scores, NEAR)
    bare = fit(damped, (), found.u, np.zeros(0), NEAR)
    told = {s.point_m: with_nameless(damped, (), bare.u, bare.e, s) for s in places_beside(found, bare)}
    there, *others = (told.pop(point) for point in sorted(told, key=lambda point: point is None))
    assert there is not None and there.where.point_m == tuple(AT.values()) and others
    assert all(t is not None and t.evidence_nats < there.evidence_nats - 20 for t in others)
    assert there.held_out_chi2_per_dof is not None and there.held_out_chi2_per_dof < 0.8
    assert "reads as a damping of 1." in there.in_words
