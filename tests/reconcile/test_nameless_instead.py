"""Names set against a thing that has none: relatives of what no catalogue has give way to it, right names do not."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, roving_scenario

from vgvt.effects import available_effects
from vgvt.reconcile.decision import nameless_instead
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.kinds import Kind, kind_of
from vgvt.reconcile.decision.leads import why_no_name
from vgvt.reconcile.decision.nameless_instead import set_against_nameless
from vgvt.reconcile.decision.reasons import reasons_of
from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.evidence.rivals import against
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import FAR, NEAR, TO_THE_END, Fit, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.reconcile.question.thresholds import Thresholds, noise_share, stored_thresholds

PLACE = {"x_m": 0.82, "y_m": 1.05}
KNOWN = available_effects()
DAMPER = ("nonproportional-damper", {"damping_n_s_per_m": 0.8, **PLACE}, {})
ABSORBER = ("local-absorber", {"mass_kg": 0.07, "frequency_hz": 2.5, "damping_ratio": 0.5, **PLACE}, {})
MASS = ("added-mass", {"mass_kg": 0.02, **PLACE}, {})
GAIN = ("channel-gain", {"gain_error": 0.05}, {"channels": "18+Z"})


@pytest.fixture(scope="module")
def damped(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A campaign with a damper to the ground on a wing, and a sensor that reads a tenth too much."""
    scenario = roving_scenario()
    damper = KNOWN["nonproportional-damper"](damping_n_s_per_m=1.0, **PLACE)
    gain = KNOWN["channel-gain"](gain_error=0.1, channels="18+Z")
    cache = tmp_path_factory.mktemp("cache")
    return make_problem(campaign_of(scenario, 3, damper, gain), scenario, lines=160, cache=cache)


@pytest.fixture(scope="module")
def null(damped: Problem) -> Fit:
    return calibrate(damped)


def limits(case: Problem) -> Thresholds:
    return stored_thresholds().at(noise_share(case.measured, case.split.train))


def named(null: Fit, *names: tuple[str, dict[str, float], dict[str, Any]]) -> Attribution:
    """What a search holds that named these one after the other."""
    case, rounds, current = null.problem, list[Addition](), null
    for name, values, settings in names:
        hypothesis = Hypothesis(KNOWN[name], settings)
        start = np.concatenate([current.e, hypothesis.scores(values)])
        begun = fit(case, (*current.hypotheses, hypothesis), current.u, start, FAR)
        there = fit(case, begun.hypotheses, begun.u, begun.e, (*NEAR, *TO_THE_END))
        (rival,) = against(current, [there])
        rounds.append(Addition(rival, (rival,), (rival,), 2.0))
        current = there
    before, after = residual(null, limits(case)), residual(current, limits(case))
    return Attribution(null, before, tuple(rounds), current, after, (), ())


def kept(found: Attribution) -> list[str]:
    return [a.winner.name for a in found.rounds]


@pytest.mark.slow
def test_right_names_stay(damped: Problem, null: Fit) -> None:
    found = named(null, DAMPER, GAIN)
    assert set_against_nameless(found, limits(damped)) is found


@pytest.mark.slow
def test_a_relative_gives_way_and_the_right_name_beside_it_stays(damped: Problem, null: Fit) -> None:
    """An absorber that swings below the band, and a mass for what it misses, stand for a damper that has no name."""
    found = set_against_nameless(named(null, ABSORBER, GAIN, MASS), limits(damped))
    assert kept(found) == ["channel-gain"]
    assert [h.name for h in found.final.hypotheses] == ["channel-gain"]
    assert found.final_residual.train_chi2_per_dof == pytest.approx(found.final.chi2_per_dof)
    assert found.nameless is not None
    assert found.nameless.instead_of == ("local-absorber", "added-mass")
    assert found.nameless.where.kind == "structure"
    at = next(p.position_m for p in damped.layouts.first.grid if f"force at {p.dof}" == found.nameless.where.label)
    assert np.hypot(at[0] - PLACE["x_m"], at[1] - PLACE["y_m"]) < 0.3
    assert kind_of(found) is Kind.PARTLY_EXPLAINED
    assert {r.name for r in found.vetoed} == {"local-absorber", "added-mass"}
    said = " ".join(reasons_of(Kind.PARTLY_EXPLAINED, found, limits(damped), None))
    assert f"Not alone: one thing that has no name, {found.nameless.in_words}" in said


@pytest.mark.slow
def test_a_relative_alone_is_a_lead(damped: Problem, null: Fit, tmp_path_factory: pytest.TempPathFactory) -> None:
    scenario = roving_scenario()
    damper = KNOWN["nonproportional-damper"](damping_n_s_per_m=1.0, **PLACE)
    case = make_problem(campaign_of(scenario, 3, damper), scenario, lines=160, cache=tmp_path_factory.mktemp("cache"))
    found = set_against_nameless(named(calibrate(case), ABSORBER, MASS), limits(case))
    assert kept(found) == []
    assert [a.winner.name for a in found.leads] == ["local-absorber", "added-mass"]
    assert found.nameless is not None
    assert found.nameless.chi2_per_dof <= found.null_residual.limits.chi2_per_dof
    assert kind_of(found) is Kind.UNKNOWN
    assert "no name" in why_no_name(found)
    document = found.nameless.document()
    assert document["instead_of"] == ["local-absorber", "added-mass"]
    assert float(str(document["ahead_nats"])) > 0
    said = reasons_of(Kind.UNKNOWN, found, limits(case), None)
    assert f"One thing that has no name, {found.nameless.in_words}" in said


def test_without_names_and_beside_what_waits_for_a_level_nothing_is_asked(
    damped: Problem, null: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    def unasked(*_: Any) -> None:
        raise AssertionError("asked")

    monkeypatch.setattr(nameless_instead, "still_explained", unasked)
    before = residual(null, limits(damped))
    none = Attribution(null, before, (), null, before, (), ())
    assert set_against_nameless(none, limits(damped)) is none
    found = named(null, GAIN)
    monkeypatch.setattr(nameless_instead, "bends_at_one_level", lambda found: True)
    assert set_against_nameless(found, limits(damped)) is found


EACH = 9.0


@pytest.mark.parametrize(
    ("still", "beside", "none", "one", "answer"),
    [
        # Nothing is left beside two names, which gain 100. One thing instead of both must be ahead.
        (0.0, 0.0, 99.9, 0.0, None),
        (0.0, 0.0, 100.1, 0.0, (0, 0.1)),
        # One thing instead of one of them must be ahead by what a name needs.
        (0.0, 0.0, 0.0, 108.0, None),
        (0.0, 0.0, 0.0, 110.0, (1, 10.0)),
        # A thing beside both gains 50: each of them must be worth a name beside it.
        (20.0, 150.0, 133.0, 0.0, (0, 33.0)),
        (20.0, 150.0, 131.0, 142.0, (1, 42.0)),
        (20.0, 150.0, 131.0, 140.5, None),
        # To first order one showed, and fitted it gains less than a name needs: nothing is known to be there.
        (20.0, 105.0, 100.0, 100.0, None),
    ],
)
def test_what_each_has_to_gain(
    monkeypatch: pytest.MonkeyPatch, still: float, beside: float, none: float, one: float, answer: Any
) -> None:
    names = SimpleNamespace(gain_nats=100.0, lasting_nats=100.0)
    linear = SimpleNamespace(linear=True)
    found: Any = SimpleNamespace(
        rounds=(None, None), null=None, final=SimpleNamespace(hypotheses=(linear, linear), problem=None)
    )

    def gains(count: int, nats: float, lasting: float | None = None) -> Any:
        both = np.array([nats, nats if lasting is None else lasting])
        return SimpleNamespace(kept=tuple(range(count)), nats=both, nameless=count)

    def judged(lasting: float | None = None, against_it: bool = False) -> Any:
        monkeypatch.setattr(nameless_instead, "bends_at_one_level", lambda found: False)
        monkeypatch.setattr(nameless_instead, "places_differ", lambda problem: True)
        monkeypatch.setattr(nameless_instead, "still_explained", lambda fit: SimpleNamespace(nats=still))
        monkeypatch.setattr(nameless_instead, "against", lambda *_: (names,))
        monkeypatch.setattr(nameless_instead, "best_beside", lambda *_: gains(2, beside))
        monkeypatch.setattr(
            nameless_instead,
            "each_beside",
            lambda found, count, *_: [gains(count, (none, one)[count], lasting)],
        )
        monkeypatch.setattr(nameless_instead, "not_spoken_against", lambda *_: not against_it)
        monkeypatch.setattr(nameless_instead, "_instead", lambda found, b, ahead, limits: (len(b.kept), ahead))
        limits: Any = SimpleNamespace(evidence_nats=EACH)
        result: Any = set_against_nameless(found, limits)
        return None if result is found else result

    assert judged() == (None if answer is None else (answer[0], pytest.approx(answer[1])))
    # Where errors of the model last it has to gain as much, and held-out data may not speak for the names.
    assert judged(lasting=0.0) is None
    assert judged(against_it=True) is None


@pytest.mark.parametrize(
    ("none", "one", "two", "kept"),
    [
        (99.9, 99.9, 108.9, None),
        (100.1, 99.0, 99.0, 0),
        (99.0, 109.0, 99.0, 1),
        (99.0, 99.0, 109.1, 2),
    ],
)
def test_of_three_names_what_is_fewer_things_need_only_be_ahead(
    monkeypatch: pytest.MonkeyPatch, none: float, one: float, two: float, kept: int | None
) -> None:
    """A bend of one root in one run was another payload, another suspension and another drive point, by 3 nats less."""
    names = SimpleNamespace(gain_nats=100.0, lasting_nats=100.0)
    linear = SimpleNamespace(linear=True)
    found: Any = SimpleNamespace(
        rounds=(None, None, None), null=None, final=SimpleNamespace(hypotheses=(linear,) * 3, problem=None)
    )
    reached = (none, one, two)

    def beside(found: Any, count: int, *_: Any) -> Any:
        return [SimpleNamespace(kept=tuple(range(count)), nats=np.full(2, reached[count]), nameless=count)]

    monkeypatch.setattr(nameless_instead, "bends_at_one_level", lambda found: False)
    monkeypatch.setattr(nameless_instead, "places_differ", lambda problem: True)
    monkeypatch.setattr(nameless_instead, "still_explained", lambda fit: SimpleNamespace(nats=0.0))
    monkeypatch.setattr(nameless_instead, "against", lambda *_: (names,))
    monkeypatch.setattr(nameless_instead, "each_beside", beside)
    monkeypatch.setattr(nameless_instead, "not_spoken_against", lambda *_: True)
    monkeypatch.setattr(nameless_instead, "_instead", lambda found, b, ahead, limits: len(b.kept))
    limits: Any = SimpleNamespace(evidence_nats=EACH)
    result: Any = set_against_nameless(found, limits)
    assert (None if result is found else result) == kept
