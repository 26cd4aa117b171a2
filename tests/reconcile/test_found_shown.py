"""What a reconciliation's nouns show at a prompt: a few lines with sizes, units and what is left."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from account_by_hand import account
from reconciled_case import claimed, problem

from vgvt.data.shown import brief
from vgvt.effects import available_effects
from vgvt.reconcile import (
    Attribution,
    Fit,
    Hypothesis,
    Kind,
    Localisation,
    ModelModes,
    NamedEffect,
    Place,
    Power,
    Residual,
    Resimulation,
    Rival,
    Suggestion,
    Verdict,
    compare,
    fit,
    power_rows,
    residual,
    stored_thresholds,
)
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.verdict import named_effects
from vgvt.reconcile.question.holdout import Split
from vgvt.reconcile.search.screened import Screened

LONGEST_LINE, MOST_LINES = 250, 15
CASE = dict[str, Any]


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> CASE:
    """A channel's gain as if it had been named, without any search."""
    at = problem(tmp_path_factory.mktemp("shown"), 3)
    null = fit(at, (), 0.1 * np.arange(at.size) % 1.7, np.zeros(0), ())
    final = claimed(at, "channel-gain", {"gain_error": 0.08}, channels="7+Z")
    limits = stored_thresholds()
    left = (residual(null, limits), residual(final, limits))
    winner = Rival(final, 21.94, 25.0, 20.0, 1.25)
    addition = Addition(winner, (winner, Rival(null_with(at), 20.0, 20.0, 20.0, None)), (winner,), 2.5)
    found = Attribution(null, left[0], (addition,), final, left[1], (), ())
    figures = [compare(f.foretold, at.measured, at.split) for f in (null, final)]
    place = Place("vertical force at the tip", "structure", None, 0.456, "stiffness", 1234.0, "N/m", None)
    places = Localisation((place, *(replace(place, explained=-0.0001, type=""),) * 9), at.measured.frequency_hz, 2.5)
    test = Suggestion("moving the shaker", ("channel-gain", "channel-delay"), 12.3, 20.0)
    simulated = Resimulation(figures[1], 0.00012, 0.004, "")
    verdict = Verdict(
        Kind.AMBIGUOUS, ("one", "two"), named_effects(found), (), (), *figures, (test,), found, places, limits,
        at.scenario, simulated,
    )  # fmt: skip
    return {
        "problem": at, "null": null, "final": final, "residual": left[0], "rival": winner, "addition": addition,
        "attribution": found, "comparison": figures[1], "place": place, "places": places, "test": test,
        "simulated": simulated, "verdict": verdict, "limits": limits, "account": account(),
        "measured": at.measured, "split": at.split, "channel": at.measured.channels[0], "hypothesis": winner.hypothesis,
        "effect": verdict.effects[0], "merit": figures[1].train, "nuisance": at.nuisances[0],
    }  # fmt: skip


def null_with(at: Any) -> Fit:
    delay = Hypothesis(available_effects()["channel-delay"], {"channels": "7+Z"})
    return fit(at, (delay,), np.zeros(at.size), delay.scores({}), ())


def test_everything_is_a_few_lines(case: CASE) -> None:
    for name, thing in case.items():
        lines = repr(thing).splitlines()
        assert lines[0].startswith("<"), name
        assert len(lines) <= MOST_LINES and max(map(len, lines)) <= LONGEST_LINE, name


FIRST = {
    "account": "<Account of ",
    "effect": "<NamedEffect channel-gain: gain_error = ",
    "problem": "<Problem quick: 30 unknowns of the scenario, 23 of the instruments>",
    "measured": "<Measured: A/F in (m/s^2)/N of 1 run, 20 channels at 20 points, 200 lines from 3.",
    "split": "<Split: 17 channels to fit, 0 held out by run, 3 alone>",
    "channel": "<run 1, 1+Z>",
    "nuisance": "<Nuisance gain force: ± 1 %, of 20 channels>",
    "hypothesis": "<Hypothesis channel-gain (channels = 7+Z); gain_error -0.15 to 0.15>",
    "rival": "<Rival channel-gain (channels = 7+Z): 21.9 nats, 20.0 where errors last, 1.25 per held-out degree of",
    "addition": "<Addition of channel-gain (channels = 7+Z): 21.9 nats, held out 2.5 → 1.25; 1 tried; as well: ",
    "place": "<Place 45.6 %: vertical force at the tip; it looks like a stiffness of 1.23e+03 N/m>",
    "places": "<Localisation: 10 places for χ² per degree of freedom 2.5>",
    "test": "<Suggestion: 12 nats between channel-gain and channel-delay in 20 min by moving the shaker>",
    "simulated": "<Resimulation: 0.012 % from what was fitted (model form 0.4 %)>",
    "limits": "<Thresholds: χ² per degree of freedom 0.",
    "verdict": "<Verdict: ambiguous; what was found is scenario quick>",
    "attribution": "<Attribution: 1 name, χ² per degree of freedom ",
}


@pytest.mark.parametrize("name", FIRST)
def test_each_says_what_it_is(case: CASE, name: str) -> None:
    assert brief(case[name]).startswith(FIRST[name])


def test_a_verdict_says_what_is_named_and_what_it_is_worth(case: CASE) -> None:
    verdict: Verdict = case["verdict"]
    _, named, fitted, held, place, test, counts = repr(verdict).splitlines()
    value, std, _ = verdict.effects[0].parameters["gain_error"]
    assert (
        named == f"channel-gain: gain_error = {value:.3f} ± {std:.3f}, channels = 7+Z, 22 nats; as well: channel-delay"
    )
    before, after = verdict.before.held_out, verdict.after.held_out
    assert before is not None and after is not None
    assert f"{before.chi2_per_dof:.3g} → {after.chi2_per_dof:.3g}, NRMSE fit {before.nrmse_percent:.1f} → " in held
    assert fitted.startswith("fitted: χ² per degree of freedom ") and fitted.endswith(" %")
    assert place.startswith("A free vertical force at the tip would explain 46 % of the residual")
    assert test == "next test: 12 nats between channel-gain and channel-delay in 20 min by moving the shaker"
    assert counts == "2 reasons, 1 suggested test; .document() has all"


def test_a_verdict_without_a_name_or_held_out_data(case: CASE) -> None:
    verdict: Verdict = case["verdict"]
    alone = replace(verdict.after, held_out=None)
    lead = NamedEffect("rattling-mass", "", {}, {}, 3.0, ("a", "b", "c", "d", "e"), None, None)
    bare = replace(
        verdict, kind=Kind.UNKNOWN, reasons=(), effects=(), leads=(lead,), before=alone, after=alone,
        suggested_tests=(), localisation=None, resimulated=Resimulation.skipped("it cannot be"),
    )  # fmt: skip
    head, nearest, fitted, simulated, counts = repr(bare).splitlines()
    assert head.startswith("<Verdict: unknown; ")
    assert nearest == "a lead, no name: rattling-mass: 3 nats; as well: a, b, c … and 2 more"
    assert "→" not in fitted
    assert simulated == "reconciled.toml was not simulated: it cannot be"
    assert counts == "no reasons, no suggested tests; .document() has all"
    many = replace(verdict, effects=verdict.effects * 40)
    assert len(repr(many).splitlines()) <= MOST_LINES + 1 and "more" in repr(many)


def test_a_fit_says_how_far_it_went(case: CASE) -> None:
    head, effect, *_ = repr(case["final"]).splitlines()
    assert head.startswith("<Fit of quick: χ² per degree of freedom ") and ", not converged" in head
    assert effect.startswith("channel-gain (channels = 7+Z): gain_error = 0.08")
    null: Fit = case["null"]
    furthest = max(zip(np.abs(null.u), null.problem.names, strict=True))
    assert f"in stated deviations: {furthest[1]} {furthest[0]:+.2g}" in repr(null)
    kept = replace(null.problem.split, held_channels=null.problem.split.held_channels & False)
    assert "held out" not in repr(replace(null, problem=replace(null.problem, split=kept), converged=True))


def test_a_residual_has_its_limits_and_reasons(case: CASE) -> None:
    left: Residual = case["residual"]
    head, figures, *reasons = repr(left).splitlines()
    assert head == f"<Residual, {'adequate' if left.adequate else 'not adequate'}: 20 channels, 200 lines>"
    assert f"{left.train_chi2_per_dof:.3g} (limit {left.limits.chi2_per_dof:.3g})" in figures and "held out" in figures
    assert len(reasons) == len(left.reasons)
    assert "held out" not in repr(replace(left, held_out_chi2_per_dof=None, reasons=()))


def test_places_are_cut_and_a_share_of_nothing_has_no_sign(case: CASE) -> None:
    _, first, second, *_, last = repr(case["places"]).splitlines()
    assert first.startswith("45.6 %: vertical force at the tip; it looks like a stiffness of")
    assert second == "0.0 %: vertical force at the tip" and last == "… and 5 more"
    assert repr(Localisation((), np.empty(0), float("nan"))).startswith("<Localisation: no places")


def test_figures_of_merit_are_a_table(case: CASE) -> None:
    whole, alone = case["comparison"], replace(case["comparison"], held_out=None, held_runs=None, held_channels=None)
    assert [line.split("  ")[0] for line in repr(whole).splitlines()] == [
        "<Comparison>", "data", "fitted", "held out, all", "held out, single channels",
    ]  # fmt: skip
    assert len(repr(alone).splitlines()) == 3
    assert repr(case["simulated"]).endswith(repr(whole))
    assert repr(Resimulation.skipped("too long")) == "<Resimulation: reconciled.toml was not simulated: too long>"
    assert repr(whole.train).startswith("<Merit: χ² per degree of freedom ")


def test_what_a_test_would_see() -> None:
    mass = Power("added-mass", "added-mass (side = left)", "mass_kg", "kg", 0.0123, np.inf, 0.0, 1.0, ())
    assert repr(mass) == (
        "<Power added-mass (side = left): mass_kg, just visible: 0.012 kg, named from: never, plausible 0 to 1 kg>"
    )
    alike = replace(mass, smallest=np.nan, alike=(("a", 0.9), ("b", 0.8), ("c", 0.7)))
    assert "just visible: not known" in repr(alike) and "; like a 0.90, b 0.80 … and 1 more>" in repr(alike)
    (row,) = power_rows((mass,))
    assert repr(row) == repr(mass).replace("Power added-mass (side = left):", "PowerRow added-mass:")


def test_what_is_open_and_what_is_screened(case: CASE) -> None:
    known = {u.name: repr(u) for u in case["problem"].unknowns}
    assert known["EI wing"] == "<Unknown EI wing: EI of the wing ± 10 %>"
    assert known["cg body"].endswith("aft, 0.4833 m ± 0.003 m>")
    assert repr(Screened(case["hypothesis"], {}, 3.21)) == "<Screened channel-gain (channels = 7+Z): 3.2 nats at best>"
    assert repr(Screened(case["hypothesis"], {"gain_error": 0.1}, 3.21)).endswith("at best, from gain_error = 0.1>")
    assert repr(Split(*np.zeros((3, 4), bool))) == "<Split: no channels to fit, 0 held out by run, 0 alone>"


def test_modes_of_a_model_are_a_table() -> None:
    hz, damping = np.array([3.0, 5.5]), np.array([0.01, np.nan])
    modes = ModelModes(hz, damping, np.ones((2, 4), complex), hz, damping)
    assert [line.split() for line in repr(modes).splitlines()[2:]] == [["1", "3.000", "1.00"], ["2", "5.500", "nan"]]
    none = np.empty(0)
    assert repr(ModelModes(none, none, np.empty((0, 4), complex), none, none)) == "<ModelModes: no modes>"


def test_an_unused_channel_is_counted(case: CASE) -> None:
    lost = np.arange(20) == 3
    assert repr(replace(case["measured"], lost=lost, remarks=())).endswith("; not used: 1>")
    assert repr(replace(case["measured"], remarks=("a",) * 9)).endswith("a\n… and 6 more")
