"""What is bent to do what another effect does is no such thing any more, and has no name."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import pytest
from reconciled_case import campaign_of, small_scenario

from vgvt.effects import available_effects, make_effect, parameter
from vgvt.effects.conformance import with_effect
from vgvt.effects.places import require_on_aircraft
from vgvt.reconcile import Kind, reconcile
from vgvt.reconcile.decision import attribute as rounds
from vgvt.reconcile.decision.reasons import reasons_of
from vgvt.reconcile.evidence import plausible
from vgvt.reconcile.evidence.plausible import implausible, placed
from vgvt.reconcile.fitting.fit import fit
from vgvt.reconcile.outcome.account import _standing
from vgvt.reconcile.outcome.augment import augment
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import make_problem
from vgvt.reconcile.search.candidates import freed
from vgvt.scenario import load_scenario

# The package's lazy name of the same spelling is the function.


@dataclass(frozen=True)
class AlongTheBody:
    """A mass of which only the station is asked."""

    name: ClassVar[str] = "along-the-body"
    mass_kg: float = parameter("kg", 0.01, 0.5, "mass", neutral=0.0, scale="log")
    x_m: float = parameter("m", 0.0, 1.2, "station", default=0.5)


ABSORBER = freed(Hypothesis(available_effects()["local-absorber"], {"x_m": 0.5, "y_m": 0.5}))
LIKELY = {"mass_kg": 0.1, "frequency_hz": 20.0, "damping_ratio": 0.02, "x_m": 0.5, "y_m": 0.5}
HYPOTHESES = (ABSORBER, Hypothesis(available_effects()["channel-gain"], {"channels": "force"}))
HATI = load_scenario("hati-unsymmetric")


@pytest.fixture(autouse=True)
def as_stated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plausible, "honest", lambda fit: fit)


def fit_of(sd: float = 0.01, **changed: float) -> Any:
    """A fit of an absorber on Hati and, after it, a gain far off; values known to a standard deviation."""
    u = np.array([9.0, -9.0])
    values = LIKELY | changed
    e = np.concatenate([ABSORBER.scores(values), HYPOTHESES[1].scores({"gain_error": 5.0})])
    own: list[dict[str, Any]] = [{k: (v, sd, "") for k, v in values.items()}, {"gain_error": (5.0, sd, "")}]
    return SimpleNamespace(
        u=u, scores=np.concatenate([u, e]), hypotheses=HYPOTHESES, values=lambda index: own[index],
        problem=SimpleNamespace(scenario=HATI),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("changed", "sd", "what"),
    [
        ({}, 0.01, ()),
        ({"frequency_hz": 120.0}, 0.01, ("frequency_hz",)),
        # Where values stop to follow their scores.
        ({"frequency_hz": 146.1}, 0.0, ("frequency_hz",)),
        ({"frequency_hz": 60.0}, 0.01, ()),
        # A chord of Hati, 0.3 m, is near it; a body's chord is none.
        ({"x_m": 1.75}, 0.01, ("x_m",)),
        ({"x_m": 1.0}, 0.01, ()),
        ({"x_m": 0.1, "y_m": 1.0}, 0.01, ("x_m",)),
        ({"x_m": 1.3, "y_m": 0.0}, 0.01, ("x_m",)),
        ({"x_m": -0.35, "y_m": 2.35}, 0.01, ("x_m",)),
        ({"y_m": -2.35}, 0.01, ("x_m",)),
        # Not surely: within two deviations it may be on the wing.
        ({"x_m": 1.75}, 0.8, ()),
        ({"x_m": 0.1, "y_m": 1.0}, 0.2, ()),
        # How much there is of it, and how damped it is, is for the data to say.
        ({"mass_kg": 8.0, "damping_ratio": 0.6}, 0.01, ()),
    ],
)
def test_what_lies_surely_beyond_is_said(changed: dict[str, float], sd: float, what: tuple[str, ...]) -> None:
    found = implausible(fit_of(sd, **changed), 0)
    assert tuple(words.split(" of ")[0] for words in found) == what
    assert implausible(fit_of(sd, **changed)) == ()


@pytest.mark.slow
def test_what_is_called_a_place_can_be_stated_in_a_scenario() -> None:
    """A name is handed on as a file: no command may refuse the place in it."""
    kept = []
    for x_m, y_m in itertools.product(np.linspace(-0.6, 1.9, 14), np.linspace(-2.4, 2.4, 17)):
        place = {"x_m": float(x_m), "y_m": float(y_m)}
        at = placed(fit_of(**place), 0, ("x_m", "y_m"))
        assert (at is None) == bool(implausible(fit_of(**place), 0))
        if at is not None:
            # Two deviations of 1 cm to either side.
            assert max(abs(at[0] - x_m), abs(at[1] - y_m)) < 0.0201
            stated = {**LIKELY, "x_m": at[0], "y_m": at[1]}
            require_on_aircraft(with_effect(HATI, make_effect("local-absorber", "test", **stated)))
            kept.append(place)
    assert len(kept) > 20
    (wing,) = HATI.airframe.beam
    for x, y, _ in wing.stations.position_m:
        assert implausible(fit_of(x_m=x, y_m=y), 0) == ()


def test_what_is_hardly_placed_is_stated_where_it_may_be(tmp_path: Path) -> None:
    """Five grams half a metre off the wing, give or take a third: a file that runs has them within a chord of it."""
    scenario = small_scenario()
    case = make_problem(campaign_of(scenario, 1), scenario, lines=80, cache=tmp_path)
    case = replace(case, measured=replace(case.measured, sigma=50 * case.measured.sigma))
    mass = freed(Hypothesis(available_effects()["added-mass"], {"x_m": 0.5, "y_m": 0.5}))
    values = {"mass_kg": 0.005, "x_m": 0.05, "y_m": 1.1}
    found = fit(case, (mass,), np.zeros(case.size), mass.scores(values), ())
    assert found.values(0)["x_m"][1] > 0.15
    stated = augment(scenario, SimpleNamespace(final=found))  # type: ignore[arg-type]
    # Beside whole cells all else has moved a little, gains of nothing too.
    table, *gains = stated.effect
    assert {t.name for t in gains} <= {"channel-gain"}
    at = table.model_dump()
    assert at["mass_kg"] == pytest.approx(0.005, rel=0.02)
    assert (at["x_m"], at["y_m"]) != pytest.approx((0.05, 1.1))
    assert implausible(found) == ()
    require_on_aircraft(stated)


def test_a_place_that_no_scenario_may_state_is_said_with_the_nearest_part() -> None:
    assert implausible(fit_of(x_m=0.1, y_m=1.0), 0) == (
        "x_m of 0.1 m and y_m of 1 m, farther from 'wing-right', the nearest part, than a scenario may say",
    )


def test_an_end_of_a_tie_is_asked_too_and_a_place_that_was_not_fitted_is_not() -> None:
    bundle = available_effects()["cable-bundle"]
    values = {"stiffness_n_per_m": 20.0, "damping_n_s_per_m": 0.1, "x_m": 0.5, "y_m": 0.5}
    values |= {"other_x_m": 0.4, "other_y_m": 2.6}

    def fit_with(settings: dict[str, float]) -> Any:
        tie = Hypothesis(bundle, settings)
        free = {p.name: values[p.name] for p in tie.parameters}
        return SimpleNamespace(
            u=np.zeros(0), scores=tie.scores(free), hypotheses=(tie,),
            values=lambda index: {k: (v, 0.01, "") for k, v in free.items()}, problem=SimpleNamespace(scenario=HATI),
        )  # fmt: skip

    (words,) = implausible(fit_with({}))
    assert words.startswith("other_x_m of 0.4 m and other_y_m of 2.6 m")
    assert implausible(fit_with({"other_x_m": 0.4, "other_y_m": 2.6})) == ()


def test_half_a_place_is_asked_of_the_aircraft_s_box() -> None:
    """An effect of somebody's own that is somewhere along the body: surely off it, by a quarter of its length."""
    along = Hypothesis(AlongTheBody)

    def fit_at(x_m: float, sd: float) -> Any:
        return SimpleNamespace(
            u=np.zeros(0), scores=along.scores({"mass_kg": 0.1, "x_m": x_m}), hypotheses=(along,),
            values=lambda index: {"mass_kg": (0.1, sd, "kg"), "x_m": (x_m, sd, "m")},
            problem=SimpleNamespace(scenario=HATI),
        )  # fmt: skip

    (words,) = implausible(fit_at(1.75, 0.01))
    assert words.startswith("x_m of 1.75")
    assert implausible(fit_at(1.75, 0.2)) == implausible(fit_at(1.4, 0.01)) == ()


def test_it_is_asked_of_the_effect_that_was_added_last() -> None:
    fit = fit_of(frequency_hz=120.0)
    split = fit.u.size + len(ABSORBER.parameters)
    fit.scores = np.concatenate([fit.u, fit.scores[split:], fit.scores[fit.u.size : split]])
    turned_round: Any = SimpleNamespace(
        u=fit.u, scores=fit.scores, hypotheses=HYPOTHESES[::-1], values=lambda index: fit.values(1 - index),
        problem=fit.problem,
    )  # fmt: skip
    assert len(implausible(turned_round)) == 1
    assert implausible(turned_round, 0) == ()


def test_a_frequency_that_data_may_set_to_any_size_is_not_asked() -> None:
    """The corner of a high-pass is how much of it there is."""
    corner = Hypothesis(available_effects()["high-pass-mismatch"], {"channels": "response"})
    fit: Any = SimpleNamespace(
        u=np.zeros(0), scores=corner.scores({"corner_hz": 30.0}), hypotheses=(corner,),
        values=lambda index: {"corner_hz": (30.0, 0.1, "Hz")}, problem=SimpleNamespace(scenario=HATI),
    )  # fmt: skip
    assert fit.scores[0] > 3
    assert implausible(fit) == ()


def test_it_is_said_with_what_would_be_plausible() -> None:
    assert implausible(fit_of(frequency_hz=120.0), 0) == ("frequency_hz of 120 Hz, where 3 to 40 Hz is plausible",)


@pytest.mark.parametrize(
    ("left", "plausible_one", "first"),
    [
        # Gain of evidence and what held-out data are missed by, of the plausible one; the other has 90 nats and 9.0.
        (0.8, (87.0, 9.9), "mass"),
        (0.8, (60.0, 8.0), "absorber"),
        # Where much is left, evidence weighs wrong unknowns: held-out data say what is as good.
        (20.0, (40.0, 9.4), "mass"),
        (20.0, (87.0, 18.0), "absorber"),
    ],
)
def test_a_plausible_rival_goes_first_where_it_does_as_well(
    monkeypatch: pytest.MonkeyPatch, left: float, plausible_one: tuple[float, float], first: str
) -> None:
    """One far behind does not: what is far ahead of all that could be says that something else is there."""

    def strange(rival_fit: Any) -> tuple[str, ...]:
        return ("far above the band",) if rival_fit.number == 0 else ()

    monkeypatch.setattr(plausible, "implausible", strange)
    monkeypatch.setattr(rounds, "implausible", strange)
    rows = (("absorber", 90.0, 9.0), ("mass", *plausible_one))
    rivals: Any = [
        SimpleNamespace(
            name=name,
            gain_nats=nats,
            held_out=held,
            fit=SimpleNamespace(number=k, chi2_per_dof=left),
            convinces=lambda limits: True,
        )
        for k, (name, nats, held) in enumerate(rows)
    ]
    limits: Any = SimpleNamespace(evidence_nats=9.0, set_nats=5.0)
    before: Any = SimpleNamespace(
        adequate=False,
        held_out_chi2_per_dof=None,
        train_chi2_per_dof=30.0,
        limits=SimpleNamespace(held_out_per_dof=1.0),
    )
    monkeypatch.setattr(rounds, "residual", lambda fit, thresholds: before)
    monkeypatch.setattr(rounds, "linear_first", lambda problem, hypotheses: (list(hypotheses), []))
    monkeypatch.setattr(rounds, "tried", lambda *given: tuple(rivals))
    monkeypatch.setattr(rounds, "_restart", lambda null, winner: null)
    monkeypatch.setattr(rounds, "against", lambda current, fits: tuple(rivals))
    monkeypatch.setattr(rounds, "_passed", lambda *given: True)
    monkeypatch.setattr(rounds, "takes_enough", lambda *given: True)
    monkeypatch.setattr(rounds, "ended", lambda current, found, *given: found)
    monkeypatch.setattr(rounds, "straightened", lambda confirmed, set_nats: list(confirmed))
    monkeypatch.setattr(rounds, "held_out_nats", lambda *given: 0.0)
    monkeypatch.setattr(rounds, "controlled", lambda addition, *given: addition)
    monkeypatch.setattr(rounds, "plain_likenesses", lambda *given: ())
    monkeypatch.setattr(rounds, "needed", lambda found, current, thresholds: (found, current))
    monkeypatch.setattr(rounds, "reconsidered", lambda found, *asked, met: found)
    monkeypatch.setattr(rounds, "nowhere", lambda addition: False)
    null: Any = SimpleNamespace(problem=None, chi2_per_dof=30.0)
    found = rounds.attribute(null, (), limits, most=1)
    assert found.rounds[0].winner.name == first
    assert {r.name for r in found.rounds[0].equivalent} == {first}


@pytest.mark.slow
def test_a_mass_is_no_absorber_far_above_the_band(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where masses are not in the catalogue: below its resonance an absorber is one."""
    monkeypatch.undo()
    scenario, known = small_scenario(), available_effects()
    campaign = campaign_of(scenario, 14, known["added-mass"](mass_kg=0.15, x_m=0.75, y_m=0.9))
    found = reconcile(
        campaign, scenario, effects={"local-absorber": known["local-absorber"]}, lines=150, folder=tmp_path
    )
    assert found.kind is Kind.UNKNOWN, found.reasons
    (lead,) = found.leads
    assert lead.parameters["mass_kg"][0] == pytest.approx(0.15, rel=0.1)
    assert any(
        "; local-absorber with frequency_hz of" in reason and "is no plausible thing, and" in reason
        for reason in found.reasons
    )
    # Beside an earlier name that stays, or a rival that could be, it is told as refused.
    (addition,) = found.attribution.leads
    beside = replace(found.attribution, leads=(), led=None, vetoed=(addition.winner,))
    said = reasons_of(found.kind, beside, found.thresholds, None)
    assert sum("but it is no plausible thing (frequency_hz of" in reason for reason in said) == 1
    assert not any("speak against it" in reason for reason in said)
    assert _standing(addition.winner, None, beside, found.thresholds, "lead") == "no plausible thing"
