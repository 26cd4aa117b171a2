"""Where one point alone is fitted, in however many runs, something may be left, and could be anywhere."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, roving_problem, small_scenario

from vgvt.effects import available_effects
from vgvt.reconcile.decision import beyond_names, nameless_instead
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.beside_nameless import places_beside
from vgvt.reconcile.decision.beyond_names import asked_beyond_names
from vgvt.reconcile.decision.nameless_instead import set_against_nameless
from vgvt.reconcile.evidence.free_places import places_differ
from vgvt.reconcile.evidence.localise import localise
from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.evidence.rivals import against
from vgvt.reconcile.evidence.still_explained import still_explained
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import FAR, NEAR, Fit, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.reconcile.question.thresholds import Thresholds, noise_share, stored_thresholds

KNOWN = available_effects()
NO_PLACE = "thing somewhere (the one point that was fitted tells no place)"


@pytest.fixture(scope="module")
def delayed(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """One sensor at point 13 in four runs, whose force comes late."""
    whole = small_scenario()
    runs = {"acquisition": whole.acquisition.model_copy(update={"runs": ((13,),) * 4})}
    scenario, late = whole.model_copy(update=runs), KNOWN["channel-delay"](delay_s=0.003, channels="force")
    cache = tmp_path_factory.mktemp("cache")
    return make_problem(campaign_of(scenario, 3, late), scenario, lines=60, cache=cache)


def limits(case: Problem) -> Thresholds:
    return stored_thresholds().at(noise_share(case.measured, case.split.train))


def stated(case: Problem) -> Fit:
    """What the stated values leave."""
    return fit(case, (), np.zeros(case.size), np.zeros(0), ())


def test_something_is_left_and_no_place_is_told(delayed: Problem) -> None:
    """A factor on the force and one on the only sensor are one and the same: the first of a list was told."""
    left = stated(delayed)
    still = still_explained(left)
    assert not places_differ(delayed) and still is not None and still.nats > 9
    assert (still.words, still.label, still.kind, still.course, still.or_on) == (NO_PLACE, "", "", (), ())
    assert places_beside(left, left) == [] and not localise(left).places


def test_two_points_tell_places(tmp_path: Path) -> None:
    case = roving_problem(tmp_path, 40)
    assert places_differ(case)
    still = still_explained(stated(case))
    assert still is not None and still.label and len(still.course) == 4


def test_no_name_is_set_against_what_could_be_anywhere(delayed: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    def unasked(*_: Any) -> None:
        raise AssertionError("asked")

    left = stated(delayed)
    found: Any = SimpleNamespace(rounds=(None,), null=left, final=left)
    monkeypatch.setattr(nameless_instead, "bends_at_one_level", lambda found: False)
    monkeypatch.setattr(nameless_instead, "still_explained", unasked)
    monkeypatch.setattr(nameless_instead, "against", unasked)
    assert set_against_nameless(found, limits(delayed)) is found


def test_that_something_is_left_beside_a_name_is_told_without_a_place(
    delayed: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(beyond_names, "bends_at_one_level", lambda found: False)
    monkeypatch.setattr(beyond_names, "replace", lambda found, still: SimpleNamespace(**vars(found) | {"still": still}))
    found: Any = SimpleNamespace(
        rounds=(None,), final=stated(delayed), still=None, null_residual=SimpleNamespace(adequate=True)
    )
    told = asked_beyond_names(found, limits(delayed)).still
    assert told is not None and told.words == NO_PLACE


@pytest.mark.slow
def test_a_wrong_name_is_a_lead_and_no_place_takes_it(delayed: Problem) -> None:
    """A factor on the force channel had been told as the place, 942 nats ahead of a mass."""
    null, mass = calibrate(delayed), Hypothesis(KNOWN["added-mass"], {})
    begun = fit(delayed, (mass,), null.u, mass.scores({"mass_kg": 0.02, "x_m": 0.82, "y_m": 1.05}), FAR)
    there = fit(delayed, begun.hypotheses, begun.u, begun.e, NEAR)
    (rival,) = against(null, [there])
    left, after = residual(null, limits(delayed)), residual(there, limits(delayed))
    named = Attribution(null, left, (Addition(rival, (rival,), (rival,), 2.0),), there, after, (), ())
    assert set_against_nameless(named, limits(delayed)) is named
    judged = asked_beyond_names(named, limits(delayed))
    assert not judged.rounds and len(judged.leads) == 1 and judged.nameless is None
