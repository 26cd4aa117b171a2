"""A name is asked again beside all that was found: what does as well or better stands beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import drawn_scores, problem

from vgvt.effects import available_effects
from vgvt.reconcile.decision import in_its_place as asked_again
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.backward import without_last
from vgvt.reconcile.decision.in_its_place import in_its_place, reconsidered
from vgvt.reconcile.decision.reasons import _how_well
from vgvt.reconcile.decision.undecided import undecided
from vgvt.reconcile.decision.verdict import named_effects
from vgvt.reconcile.evidence.rivals import against
from vgvt.reconcile.fitting import fit as fits
from vgvt.reconcile.fitting.fit import TO_THE_END, Fit, fit
from vgvt.reconcile.outcome import account
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.question.thresholds import stored_thresholds
from vgvt.reconcile.search.candidates import candidates

NAMES = ("channel-delay", "mount-compliance", "channel-gain", "added-mass", "root-compliance")
DELAY_S, GAIN = 7e-5, -0.1
MOUNT = Hypothesis(available_effects()["mount-compliance"], {})
LOW = Hypothesis(available_effects()["channel-gain"], {"channels": "6+Z"})
ODD = Hypothesis(available_effects()["channel-delay"], {"channels": "odd"})
SOFT = {"compliance_m_per_n": 2.6e-4, "loss_factor": 0.47, "frequency_hz": 2.06}
SETTLED = stored_thresholds()


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """Responses that arrive late, one of which reads low."""
    late = available_effects()["channel-delay"](channels="response", delay_s=DELAY_S)
    low = available_effects()["channel-gain"](channels="6+Z", gain_error=GAIN)
    return problem(tmp_path_factory.mktemp("cache"), 1, late, low)


@pytest.fixture(scope="module")
def offered(case: Problem) -> tuple[Hypothesis, ...]:
    return candidates(case, {n: available_effects()[n] for n in NAMES})


def model(case: Problem, *effects: tuple[Hypothesis, dict[str, float]]) -> Fit:
    """The bottom of a fit with some effects beside the true unknowns."""
    e = np.concatenate([h.scores(v) for h, v in effects])
    return fit(case, tuple(h for h, _ in effects), drawn_scores(case, 1), e, TO_THE_END)


def rounds_of(found: Fit) -> list[Addition]:
    """Rounds that named the effects of a fit."""
    null = fit(found.problem, (), found.u, np.zeros(0), ())
    (whole,) = against(null, [found])
    winners = [
        replace(whole, fit=replace(found, hypotheses=found.hypotheses[: k + 1])) for k in range(len(found.hypotheses))
    ]
    return [Addition(w, (w,), (w,), null.held_out_chi2_per_dof) for w in winners]


@pytest.fixture(scope="module")
def mounted(case: Problem) -> Fit:
    return model(case, (MOUNT, SOFT), (LOW, {"gain_error": GAIN}))


def test_a_delay_that_was_taken_for_a_mount_stands_beside_it(mounted: Fit, offered: Sequence[Hypothesis]) -> None:
    """As no data of one campaign tell the two; the gain of one channel has no such double."""
    rounds = rounds_of(mounted)
    final, found = mounted, reconsidered(rounds, mounted, offered, SETTLED.set_nats)
    assert [a.winner.name for a in found] == [MOUNT.name, LOW.name]
    assert {r.name for r in found[0].alike} == {MOUNT.name, "channel-delay"}
    assert found[1].alike == rounds[1].alike
    own, late = found[0].in_its_place
    assert own.name == MOUNT.name
    # Both are judged by slopes that were taken where they are: evidence hangs on them.
    for r in (own, late):
        assert r.fit.origin is not None
        assert np.array_equal(r.fit.origin.u, r.fit.u) and np.array_equal(r.fit.origin.e, r.fit.e)
    assert own.gain_nats == pytest.approx(found[0].winner.gain_nats)
    assert own.lasting_nats == pytest.approx(found[0].winner.lasting_nats)
    assert abs(late.gain_nats - own.gain_nats) < SETTLED.set_nats
    assert [h.name for h in late.fit.hypotheses] == [LOW.name, "channel-delay"]
    assert late.fit.values(1)["delay_s"][0] == pytest.approx(DELAY_S, rel=0.05)
    # The table of candidates has it beside the name, by what that had gained.
    about: Any = SimpleNamespace(
        rounds=tuple(found), leads=(), led=None, final=final, last_rivals=(), vetoed=(),
        null_residual=SimpleNamespace(held_out_chi2_per_dof=1.0),
    )  # fmt: skip
    rows = {r.label: r for r in account._candidates(about, SETTLED)}
    assert rows[late.hypothesis.label].standing == "equivalent"
    assert rows[late.hypothesis.label].gain_nats == late.gain_nats
    # What a next test has to tell apart has the gain in either, and the name says both.
    said: Any = SimpleNamespace(rounds=tuple(found), final=final)
    assert [f.hypotheses for f in undecided(said)] == [own.fit.hypotheses, late.fit.hypotheses]
    # A twin of its round counts too where it stands beside the same others.
    twins = [replace(late, fit=replace(late.fit, hypotheses=(h, ODD))) for h in (LOW, ODD)]
    twin: Any = SimpleNamespace(name="twin", fit=twins[0].fit)
    other: Any = SimpleNamespace(name="other", fit=twins[1].fit)
    more: Any = SimpleNamespace(rounds=(replace(found[0], equivalent=(twin, other)),), final=final)
    assert undecided(more) == (own.fit, late.fit, twin.fit)
    assert [(e.name, e.equivalent) for e in named_effects(said)] == [(MOUNT.name, ("channel-delay",)), (LOW.name, ())]


@pytest.mark.slow
def test_what_is_known_to_do_as_well_is_asked_whatever_it_promises(
    mounted: Fit, offered: Sequence[Hypothesis], monkeypatch: pytest.MonkeyPatch
) -> None:
    """And is there no more where it does so no more."""
    first, second = rounds_of(mounted)
    delay = Hypothesis(available_effects()["channel-delay"], {"channels": "response"})
    (late,) = against(mounted, [model(mounted.problem, (LOW, {"gain_error": GAIN}), (delay, {"delay_s": DELAY_S}))])
    rounds = [replace(first, in_its_place=(first.winner, replace(late, gain_nats=0.0))), second]
    monkeypatch.setattr(asked_again, "_promising", lambda *given: [])
    assert reconsidered([first, second], mounted, offered, SETTLED.set_nats)[0].in_its_place == ()
    found, _ = reconsidered(rounds, mounted, offered, SETTLED.set_nats)
    assert [r.name for r in found.in_its_place] == [MOUNT.name, "channel-delay"]
    assert found.in_its_place[1].fit.values(1)["delay_s"][0] == pytest.approx(DELAY_S, rel=0.05)
    # By what the name gained in its round, not by what it had been judged against before.
    assert found.in_its_place[1].gain_nats > found.winner.gain_nats
    assert [r.name for r in found.alike].count("channel-delay") == 1
    monkeypatch.setattr(asked_again, "as_good", lambda *given: False)
    assert reconsidered(rounds, mounted, offered, SETTLED.set_nats)[0].in_its_place == ()


@pytest.mark.parametrize("met", [True, False])
def test_beside_names_that_leave_something_whatever_promises_most_is_fitted(
    mounted: Fit, offered: Sequence[Hypothesis], monkeypatch: pytest.MonkeyPatch, met: bool
) -> None:
    """Strain of a gauge's base promised 16 % of what an absorber had bought, and was 400 nats ahead once fitted."""
    least = list[float]()
    monkeypatch.setattr(asked_again, "_promising", lambda start, asked, at_least, tell: least.append(at_least) or [])
    reconsidered(rounds_of(mounted), mounted, offered, SETTLED.set_nats, met=met)
    assert len(least) == 2
    assert all((value > 0) is met for value in least)


def test_what_does_better_is_said_to(mounted: Fit, offered: Sequence[Hypothesis]) -> None:
    """A mount that does not quite do what the data show."""
    stiffer = {**SOFT, "compliance_m_per_n": 0.9 * mounted.values(0)["compliance_m_per_n"][0]}
    scores = np.concatenate([MOUNT.scores(stiffer), mounted.e[-1:]])
    wrong = fit(mounted.problem, mounted.hypotheses, mounted.u, scores, ())
    assert mounted.evidence_nats - wrong.evidence_nats > 2 * SETTLED.set_nats
    told = list[float]()
    found = reconsidered(
        rounds_of(wrong), wrong, offered, SETTLED.set_nats, lambda fraction, message: told.append(fraction)
    )
    assert told == sorted(told)
    late = found[0].in_its_place[1]
    assert late.name == "channel-delay"
    ahead = late.gain_nats - found[0].winner.gain_nats
    assert ahead > SETTLED.set_nats
    assert _how_well(late, found[0].winner, SETTLED.set_nats) == f"better, by {ahead:.0f} nats"
    assert _how_well(late, late, 5.0) == "as well, within 5 nats"
    # Without what came last nothing is known to do as well beside it.
    (kept,), _, _ = without_last(found, mounted)
    assert kept.winner is found[0].winner
    assert kept.in_its_place == ()


@pytest.mark.slow
def test_nothing_else_does_what_a_mass_does(tmp_path: Path) -> None:
    mass = Hypothesis(available_effects()["added-mass"], {"x_m": 0.7, "y_m": 1.0})
    case = problem(tmp_path, 1, available_effects()["added-mass"](x_m=0.7, y_m=1.0, mass_kg=0.2))
    found = model(case, (mass, {"mass_kg": 0.2}))
    known = candidates(case, {n: available_effects()[n] for n in NAMES if n != mass.name})
    own, rivals = in_its_place(found, 0, known, SETTLED.set_nats)
    assert own is not None
    assert own.gain_nats > 100
    assert rivals == []


@pytest.mark.parametrize(("name", "says"), [("as_good", False), ("implausible", ("far off",))])
def test_what_held_out_data_speak_against_or_could_not_be_does_not_count(
    mounted: Fit, offered: Sequence[Hypothesis], monkeypatch: pytest.MonkeyPatch, name: str, says: object
) -> None:
    late = [h for h in offered if h.name == "channel-delay"]
    own, rivals = in_its_place(mounted, 0, late, SETTLED.set_nats)
    assert own is not None
    assert [r.name for r in rivals] == ["channel-delay"]
    monkeypatch.setattr(asked_again, name, lambda *given: says)
    own, rivals = in_its_place(mounted, 0, late, SETTLED.set_nats)
    assert own is not None
    assert rivals == []


def test_joints_that_depend_on_level_are_not_asked(mounted: Fit, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor is anything fitted where nothing is asked."""
    slipping = Hypothesis(available_effects()["root-friction"], {"kind": "bending", "side": "both"})
    monkeypatch.setattr(asked_again, "at_sizes", lambda start, hypothesis: pytest.fail(hypothesis.name))
    assert in_its_place(mounted, 0, [slipping], SETTLED.set_nats) == (None, [])


def test_a_name_that_is_another_model_when_it_comes_last_is_not_asked(
    mounted: Fit, offered: Sequence[Hypothesis], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Effects act on what earlier ones made: such a model is no measure for what is in its place."""

    def turned(case: Problem, hypotheses: tuple[Hypothesis, ...], *given: Any) -> Fit:
        found = fit(case, hypotheses, *given)
        return replace(found, chi2=found.chi2 + 10.0) if hypotheses == (LOW, MOUNT) else found

    monkeypatch.setattr(asked_again, "fit", turned)
    assert in_its_place(mounted, 0, offered, SETTLED.set_nats) == (None, [])


def test_an_effect_without_which_the_aircraft_falls_is_not_asked(
    mounted: Fit, offered: Sequence[Hypothesis], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nor one that would let it fall if it came last."""
    for none in ((LOW,), (LOW, MOUNT)):

        def falling(case: Problem, hypotheses: tuple[Hypothesis, ...], *given: Any, _none: Any = none) -> Fit:
            if hypotheses == _none:
                raise NoStructureError("it falls")
            return fit(case, hypotheses, *given)

        monkeypatch.setattr(asked_again, "fit", falling)
        assert in_its_place(mounted, 0, offered, SETTLED.set_nats) == (None, [])


def test_a_response_that_is_no_number_costs_without_end(mounted: Fit, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nothing comes through a march: of several starts it must not be the cheapest."""
    nowhere = SimpleNamespace(predict=lambda u, e: np.full_like(mounted.predicted, np.nan))
    monkeypatch.setattr(fits, "anchor", lambda *given, **more: nowhere)
    assert fits.cost_at(mounted.problem, mounted.hypotheses, mounted.u, mounted.e) == np.inf


def test_of_a_model_that_misses_much_nothing_is_asked(
    mounted: Fit, offered: Sequence[Hypothesis], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(asked_again, "in_its_place", lambda *given: pytest.fail("asked"))
    missing = replace(mounted, predicted=mounted.predicted + 1.5 * mounted.problem.measured.sigma)
    rounds = rounds_of(missing)
    known = [replace(a, in_its_place=(a.winner, a.winner)) for a in rounds]
    found = reconsidered(known, missing, offered, SETTLED.set_nats)
    assert [a.winner for a in found] == [a.winner for a in rounds]
    assert [a.in_its_place for a in found] == [(), ()]
