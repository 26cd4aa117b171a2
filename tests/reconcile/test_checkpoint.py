"""A reconciliation that was broken off goes on with the same answer; another question does not get that answer."""

from __future__ import annotations

import os
import subprocess
import sys
from copy import deepcopy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from reconciled_case import campaign_of, problem, small_scenario

from vgvt.effects import Action, available_effects, parameter
from vgvt.effects.conformance import with_effect
from vgvt.reconcile.checkpoint import Checkpoint, provenance_of
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.evidence.rivals import Rival
from vgvt.reconcile.fitting.fit import fit
from vgvt.reconcile.next_test.suggest import suggest
from vgvt.reconcile.prediction.local_slopes import Origin
from vgvt.reconcile.question import effect_code
from vgvt.reconcile.question.effect_code import code_of
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import stored_thresholds
from vgvt.scenario import load_scenario


def test_rounds_survive_their_file_and_belong_to_one_question(tmp_path: Path) -> None:
    case = problem(tmp_path, 3)
    known = available_effects()
    delay = Hypothesis(known["channel-delay"], {"channels": "response"}, 0.5)
    gain = Hypothesis(known["channel-gain"], {"channels": "7+Z"}, 0.25, {"gain_error": (-0.7, 0.7)}, 3)
    u = 0.3 * np.random.default_rng(0).standard_normal(case.size)
    start = fit(case, (), u, np.zeros(0), ())
    rivals = tuple(Rival(fit(case, (h,), u, np.array([0.2]), ()), 9.5, 11.0, 9.7, 0.7) for h in (delay, gain))
    kept = Checkpoint(tmp_path / "rounds.json", "this question")
    start = replace(start, converged=True)
    # What structures assembled anew would say in the fifth digit is not asked again.
    reached = replace(rivals[0].fit, evidence_nats=rivals[0].fit.evidence_nats + 1e-4, chi2=rivals[0].fit.chi2 + 1e-4)
    rivals = (replace(rivals[0], fit=reached), rivals[1])
    rounds = [Addition(rivals[1], rivals, rivals, None, rivals[::-1], exchanged=True)]
    kept.keep(start, [*rounds, Addition(rivals[1], rivals[1:], rivals[1:], None)], [rivals[0]])
    begun = kept.begun(case, (delay, gain))
    assert begun is not None
    again, (addition, other), refused = begun
    assert addition.exchanged and not other.exchanged
    restored = addition.rivals[0].fit
    assert (restored.evidence_nats, restored.chi2) == (reached.evidence_nats, reached.chi2)
    np.testing.assert_array_equal(again.predicted, start.predicted)
    assert again.converged
    assert refused == (addition.rivals[0],)
    np.testing.assert_array_equal(addition.winner.fit.predicted, rivals[1].fit.predicted)
    assert addition.winner.hypothesis.label == gain.label
    assert addition.winner.hypothesis.numbers == case.measured.run_numbers == (1,)
    assert addition.winner.hypothesis.spans == gain.spans and addition.winner.hypothesis.places == 3
    assert [r.name for r in addition.equivalent] == ["channel-delay", "channel-gain"]
    assert [(r.name, r.gain_nats) for r in addition.in_its_place] == [("channel-gain", 9.5), ("channel-delay", 9.5)]
    assert addition.winner.fit.evidence_nats == rivals[1].fit.evidence_nats
    assert Checkpoint(tmp_path / "rounds.json", "another question").begun(case, (delay, gain)) is None


@pytest.mark.parametrize("far", [8.0, 2.0])
def test_a_round_has_the_slopes_that_it_ended_with(tmp_path: Path, far: float) -> None:
    """Evidence hangs on them: what is found next to it after a break must be judged as it would have been.

    Within the tolerances, too, where slopes were taken anew because those of the stated values had misled.
    """
    case = problem(tmp_path, 3)
    delay = Hypothesis(available_effects()["channel-delay"], {"channels": "response"})
    u, e = np.zeros(case.size), np.array([0.2])
    u[0] = far
    taken = u.copy()
    taken[0] -= 0.3
    ended = fit(case, (delay,), u, e, (), origin=Origin(taken, e))
    rough = fit(case, (delay,), u, e, ())
    assert abs(ended.evidence_nats - rough.evidence_nats) > 1e-3
    rival = Rival(ended, 9.5, 11.0, 9.7, 0.7)
    kept = Checkpoint(tmp_path / "rounds.json", "this question")
    kept.keep(fit(case, (), u, np.zeros(0), ()), [Addition(rival, (rival,), (rival,), None)])
    begun = kept.begun(case, (delay,))
    assert begun is not None
    again = begun[1][0].winner
    assert again.lasting_nats == rival.lasting_nats
    # Evidence is kept as it was; the tangent says which slopes are there.
    assert again.fit.evidence_nats == ended.evidence_nats
    np.testing.assert_allclose(again.fit.tangent, ended.tangent, atol=1e-9 * np.abs(ended.tangent).max())
    # Elsewhere they are others.
    moved = fit(case, (delay,), u, e, (), origin=Origin(u, e))
    for other in (moved, rough):
        assert abs(other.evidence_nats - ended.evidence_nats) > 1e-6
        assert np.abs(other.tangent - ended.tangent).max() > 1e-6 * np.abs(ended.tangent).max()


@pytest.mark.slow
def test_tests_that_tell_two_rivals_apart_are_ranked_by_nats_a_minute(tmp_path: Path) -> None:
    case = problem(tmp_path, 3)
    known = available_effects()
    mass = Hypothesis(known["added-mass"], {"x_m": 0.8, "y_m": 0.9}, 0.5)
    gain = Hypothesis(known["channel-gain"], {"channels": "7+Z"}, 0.25)
    tests = suggest([fit(case, (h,), np.zeros(case.size), np.array([0.2]), ()) for h in (mass, gain)])
    assert tests
    assert set(tests[0].rivals) == {"added-mass", "channel-gain"}
    pace = [t.nats / t.minutes for t in tests]
    assert pace == sorted(pace, reverse=True)
    assert all(t.nats > 0 for t in tests)


def test_other_samples_or_another_catalogue_are_another_question(tmp_path: Path) -> None:
    scenario, limits = small_scenario(), stored_thresholds()
    campaign = campaign_of(scenario, 4)
    first = provenance_of(campaign, scenario, ["added-mass"], limits, 100)
    stricter = provenance_of(campaign, scenario, ["added-mass"], replace(limits, set_nats=limits.set_nats + 1), 100)
    assert Checkpoint.of(tmp_path / "a", first).key != Checkpoint.of(tmp_path / "a", stricter).key
    run = campaign.runs[0]
    other = replace(campaign, runs=(replace(run, samples=run.samples * 1.001), *campaign.runs[1:]))
    keys = {
        Checkpoint.of(tmp_path / "rounds.json", found).key
        for found in (
            first,
            provenance_of(other, scenario, ["added-mass"], limits, 100),
            provenance_of(campaign, scenario, ["added-mass", "mains-hum"], limits, 100),
            provenance_of(campaign, scenario, ["added-mass"], limits, 120),
        )
    }
    assert len(keys) == 4


def _written(version: int, limit: float = 0.5) -> type:
    """An effect as somebody has it at some time of writing it."""

    @dataclass(frozen=True)
    class Mine:
        name: ClassVar[str] = "mine"
        size: float = parameter("", 0.0, limit, "size", neutral=0.0)

        def act(self, scenario: object, run: int) -> Action:
            return Action(warming_k=self.size * version)

    return Mine


def test_an_effect_that_was_edited_is_another_question(tmp_path: Path) -> None:
    """Under the name that it had: it is what it does that was tried."""
    scenario, limits = small_scenario(), stored_thresholds()
    campaign = campaign_of(scenario, 4)
    keys = [
        Checkpoint.of(tmp_path, provenance_of(campaign, scenario, {"mine": mine}, limits, 100)).key
        for mine in (_written(1), _written(1), _written(2), _written(1, limit=0.7))
    ]
    assert keys[0] == keys[1]
    assert len(set(keys)) == 3


def test_a_name_stands_for_the_installed_effect() -> None:
    scenario, limits, known = small_scenario(), stored_thresholds(), available_effects()
    campaign = campaign_of(scenario, 4)
    named, given, other = (
        provenance_of(campaign, scenario, effects, limits, 100)
        for effects in (["added-mass"], {"added-mass": known["added-mass"]}, {"added-mass": _written(1)})
    )
    assert named == given != other


def test_what_effects_are_is_the_same_in_every_process() -> None:
    """Or no call would go on from what another one has kept."""
    program = (
        "from vgvt.effects import available_effects; from vgvt.scenario import load_scenario\n"
        "from vgvt.reconcile.question.effect_code import code_of\n"
        "print(code_of(available_effects(), load_scenario('quick')))"
    )
    told = {
        subprocess.run(
            [sys.executable, "-c", program], env={**os.environ, "PYTHONHASHSEED": seed}, check=True, text=True,
            capture_output=True,
        ).stdout.strip()
        for seed in ("1", "2")
    }  # fmt: skip
    assert told == {code_of(available_effects(), load_scenario("quick"))}


def test_an_effect_of_the_scenario_itself_belongs_to_the_question(monkeypatch: pytest.MonkeyPatch) -> None:
    scenario = with_effect(load_scenario("quick"), available_effects()["added-mass"](mass_kg=0.1))
    before = code_of({}, scenario)
    monkeypatch.setattr(effect_code, "available_effects", lambda: {"added-mass": _written(1)})
    assert code_of({}, scenario) != before


@dataclass(frozen=True, eq=False)
class Thing:
    """Says nothing of what it holds."""

    values: np.ndarray

    def __repr__(self) -> str:
        return "<Thing>"


def _holding(value: object) -> type:
    class Held:
        name = "held"

        def act(self) -> object:
            return value

    return Held


def test_what_an_effect_holds_counts_where_its_text_leaves_it_out() -> None:
    quick = load_scenario("quick")
    heavier = quick.model_copy(update={"shaker": quick.shaker.model_copy(update={"armature_mass_kg": 0.0123})})
    long, other = np.zeros(5000), np.eye(1, 5000, 2500)[0]
    pairs = [(quick, heavier), (long, other), (Thing(long), Thing(other))]
    for one, two in pairs:
        assert repr(one) == repr(two)
        first, again, second = (code_of({"held": _holding(v)}, quick) for v in (one, deepcopy(one), two))
        assert first == again != second
