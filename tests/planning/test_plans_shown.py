"""What plans show at a prompt: minutes, runs and how well the worst mode's damping would be known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vgvt.planning.budget import AS_DESCRIBED
from vgvt.planning.confirmation import Confirmation
from vgvt.planning.prediction import ModePrediction, Prediction
from vgvt.planning.proposal import Proposal
from vgvt.planning.result import PlanningResult

TARGET = ("1st bending", 8.0)


def plan(light, name: str, damping_std: float) -> Proposal:
    mode = ModePrediction(*TARGET, 0.01, 1e-4, damping_std, 0.5)
    return Proposal(name, light, AS_DESCRIBED, 8.0, Prediction((mode,), 2.0, 3.0, 4.0), (TARGET,))


def test_a_result_has_a_line_a_plan(light) -> None:
    plans = tuple(plan(light, f"plan-{k}", 1e-5) for k in range(1, 12))
    seen = {name: Confirmation("auto", np.full((2, 1), 8.0), np.array([[0.01], [0.011]])) for name in ("now", "plan-1")}
    head, first, *_, last = repr(PlanningResult(plan(light, "now", 2e-5), None, plans, seen)).splitlines()
    assert head == (
        "<PlanningResult: 11 plans, better; the worst mode's damping 2 times as well known, "
        "1 times in simulated campaigns>"
    )
    x, y, z = light.shaker.position_m
    assert first == f"now: 8 min, 1 run, shaker at ({x:.3f}, {y:.3f}, {z:.3f}) m, std(ζ)/ζ of the worst mode 0.2 %"
    assert last == "… and 6 more"
    assert repr(plan(light, "now", 2e-5)) == f"<Proposal {first}>"


def test_repeats_are_no_runs_of_their_own(light) -> None:
    """As in the table, on the card and in JSON: of a run that is swept three times the sensors are placed once."""
    thrice = light.model_copy(update={"acquisition": light.acquisition.model_copy(update={"repeats": 3})})
    once, often = (plan(s, "p", 2e-5) for s in (light, thrice))
    assert ", 1 run, shaker at" in once.in_words
    assert ", 1 run, 3 times each, shaker at" in often.in_words
    assert len(often.as_dict()["runs"]) == 1


def test_a_prediction_is_a_table(light) -> None:
    found = plan(light, "now", 2e-5).prediction
    assert repr(found.modes[0]) == (
        "<ModePrediction 1st bending: 8.000 ± 0.0001 Hz, damping 1.00 ± 0.002 %, moved by +0.50 % by the instruments>"
    )
    head, names, row = repr(found).splitlines()
    assert head == "<Prediction: 1 mode; at most 3 N, 2 m/s^2, 4 mm>"
    assert names.endswith("name") and row.split() == ["8.000", "0.0001", "1.00", "0.002", "+0.50", "1st", "bending"]


def test_what_is_not_seen_and_what_is_not_there_are_said(light) -> None:
    unseen = plan(light, "now", float("inf"))
    assert repr(unseen).endswith("not all modes are seen>")
    assert "± unseen %" in repr(replace(unseen.prediction.modes[0], loading_percent=float("nan")))
    aimless = replace(unseen, targets=())
    assert repr(PlanningResult(aimless, None, (), {})).startswith("<PlanningResult: no plans>\nnow: 8 min")
    assert repr(PlanningResult(aimless, None, (aimless,), {})).startswith("<PlanningResult: 1 plan>")
    assert repr(PlanningResult(unseen, unseen, (unseen,), {})).startswith("<PlanningResult: 1 plan, nothing to gain")
    assert repr(Prediction((), 1.0, 1.0, 1.0)) == "<Prediction: no modes; at most 1 N, 1 m/s^2, 1 mm>"


def test_a_confirmation_says_how_often_each_mode_was_found() -> None:
    missed = Confirmation("era", np.array([[8.0, np.nan], [8.1, np.nan]]), np.array([[0.01, np.nan], [0.02, np.nan]]))
    assert repr(missed) == "<Confirmation by era: 2 campaigns; modes found in 2, 0>"
    found = Confirmation("era", missed.frequency_hz[:, :1], missed.damping_ratio[:, :1])
    assert repr(found).endswith("modes found in 2; std(ζ)/ζ of the worst mode 47 %>")
    assert repr(Confirmation("era", np.empty((0, 0)), np.empty((0, 0)))) == "<Confirmation by era: no campaigns>"
