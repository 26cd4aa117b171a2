"""An effect is also tried where it is not: what does as well there leaves its place open, what does not settles it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, claimed, drawn_scores, problem, roving_scenario

from vgvt.cli.reconcile_tables import effects_table
from vgvt.effects import available_effects
from vgvt.reconcile.decision import place_control
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.place_control import (
    APART_M,
    as_good,
    distinct_places,
    elsewhere,
    ends_of,
    members_elsewhere,
    open_places,
    place_of,
)
from vgvt.reconcile.decision.verdict import _effect_document, named_effects
from vgvt.reconcile.evidence.rivals import Rival
from vgvt.reconcile.fitting.fit import NEAR, fit
from vgvt.reconcile.outcome import augment
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import make_problem
from vgvt.reconcile.search.candidates import freed

CHANNELS, LINES = 8, 100


def leaving(residual: np.ndarray, share: float = 1.0) -> Any:
    """A fit that leaves (C, L) standard deviations, noise a ``share`` of them; the first two channels are held out."""
    shape = (CHANNELS, LINES)
    held = np.arange(CHANNELS) < 2
    ones = np.ones(shape)
    measured = SimpleNamespace(values=ones + 0j, sigma=ones, noise=share * ones, of_force=None)
    parts = SimpleNamespace(held=held, train=~held)
    return SimpleNamespace(problem=SimpleNamespace(measured=measured, split=parts), foretold=1 + residual)


def noise(seed: int) -> np.ndarray:
    """White complex residuals of unit variance, (C, L)."""
    g = np.random.default_rng(seed)
    return (g.standard_normal((CHANNELS, LINES)) + 1j * g.standard_normal((CHANNELS, LINES))) / np.sqrt(2)


def test_held_out_data_decide_and_fitted_ones_do_not() -> None:
    winner, other = noise(0), noise(0)
    other[2:] *= 3.0
    assert as_good(leaving(other), leaving(winner), 5.0)
    other[:2] += 0.5
    # 200 held-out values missed by half a standard deviation more: 50 nats.
    assert not as_good(leaving(other), leaving(winner), 5.0)
    assert as_good(leaving(other), leaving(winner), 100.0)
    assert as_good(leaving(winner), leaving(other), 5.0)


def test_another_place_is_judged_as_names_are() -> None:
    """An error of the model's form counts once for some lines: 50 nats are ten where there is hardly any noise."""
    other = noise(0)
    other[:2] += 0.5
    alike = [as_good(leaving(other, share), leaving(noise(0), share), 15.0) for share in (1.0, 0.05)]
    assert alike == [False, True]


def test_where_nothing_is_held_out_all_data_judge() -> None:
    winner, other = leaving(noise(0)), leaving(noise(0) + 0.5)
    for fitted in (winner, other):
        fitted.problem.split.held[:], fitted.problem.split.train[:] = False, True
    assert not as_good(other, winner, 5.0)
    assert as_good(winner, other, 5.0)


def at(x_m: float, y_m: float, *other: float) -> Any:
    """A fit of something that sits there, or goes from there to another point."""
    to = dict(zip(("other_x_m", "other_y_m"), other, strict=False))
    hypothesis = SimpleNamespace(settings={"x_m": x_m, **to}, parameters=())
    return SimpleNamespace(hypotheses=(hypothesis,), values=lambda k: {"y_m": (y_m, 0.01, "m")})


def test_a_thing_with_two_ends_is_elsewhere_where_either_is() -> None:
    """Which of them is called the first says nothing."""
    cable, turned = at(0.5, 1.0, 0.4, 0.1), at(0.4, 0.1, 0.5, 1.0)
    longer = at(0.5, 1.0, 0.4, -0.6)
    assert ends_of(cable) == ((0.5, 1.0), (0.4, 0.1))
    assert distinct_places([cable, turned]) == (((0.5, 1.0), (0.4, 0.1)),)
    assert distinct_places([cable, longer]) == (ends_of(cable), ends_of(longer))
    assert distinct_places([cable, at(0.5, 1.0)]) == (ends_of(cable), ((0.5, 1.0),))


def test_the_mirror_image_of_two_ends_mirrors_both(monkeypatch: pytest.MonkeyPatch) -> None:
    """And what is its own mirror image is not offered there."""
    monkeypatch.setattr(place_control, "places", lambda problem: ())
    hypothesis = Hypothesis(available_effects()["cable-bundle"], {})

    def offered(*ends: float) -> list[dict[str, float]]:
        values = dict(zip(("x_m", "y_m", "other_x_m", "other_y_m"), ends, strict=True)) | {"stiffness_n_per_m": 50.0}
        told = {name: (value, 0.01, "") for name, value in values.items()}
        found: Any = SimpleNamespace(problem=None, hypotheses=(hypothesis,), values=lambda k: told)
        return [start for where, _, start in place_control._offers(found) if where == "at the mirror image"]

    (there,) = offered(0.5, 1.0, 0.4, -0.2)
    assert there == {"x_m": 0.5, "y_m": -1.0, "other_x_m": 0.4, "other_y_m": 0.2, "stiffness_n_per_m": 50.0}
    assert offered(0.5, 1.0, 0.5, -1.0) == []


def test_a_place_that_is_held_is_one_of_all_places(monkeypatch: pytest.MonkeyPatch) -> None:
    """It costs that choice; the mirror image, whose place is fitted, costs what the winner's does."""
    stations = tuple((0.1 * k, 0.5) for k in range(8))
    monkeypatch.setattr(place_control, "places", lambda problem: stations)
    mass = Hypothesis(available_effects()["added-mass"], {}, share=0.5)
    told = {"mass_kg": (0.05, 0.01, "kg"), "x_m": (0.1, 0.01, "m"), "y_m": (0.5, 0.01, "m")}
    found: Any = SimpleNamespace(problem=None, hypotheses=(mass,), values=lambda k: told)
    mirror, *held = (h for _, h, _ in place_control._offers(found))
    assert (mirror.share, mirror.settings) == (0.5, {})
    assert [h.share for h in held] == [0.5 / 8] * 2 and all(freed(h).share == 0.5 for h in held)


def test_places_nearer_than_a_station_are_one_place() -> None:
    near, far = at(0.5 + 0.9 * APART_M, 1.0), at(0.5, -1.0)
    assert distinct_places([at(0.5, 1.0), near, far, at(0.5, 1.0)]) == (((0.5, 1.0),), ((0.5, -1.0),))


def test_what_does_as_well_elsewhere_joins_the_round_among_its_rivals(monkeypatch: pytest.MonkeyPatch) -> None:
    """A checkpoint finds every member of the set among the rivals."""
    own, elsewhere_fit = leaving(noise(0)), leaving(noise(0))
    own.chi2_per_dof = 1.0
    trial = place_control.ElsewhereTrial("there", elsewhere_fit)
    monkeypatch.setattr(place_control, "elsewhere", lambda *_: (trial,))
    winner, other = (Rival(f, 20.0, 20.0, 20.0, 1.0) for f in (own, elsewhere_fit))
    found = place_control.controlled(Addition(winner, (winner,), (winner,), 2.0), lambda f: other, 5.0)
    assert found.equivalent == (winner, other)
    assert set(found.equivalent) <= set(found.rivals)


@pytest.mark.parametrize(("gain", "left", "open_there"), [(16.0, 0.1, True), (-6.5, 0.1, False), (-6.5, 4.0, True)])
def test_elsewhere_has_to_explain_what_was_fitted_too(
    monkeypatch: pytest.MonkeyPatch, gain: float, left: float, open_there: bool
) -> None:
    """Twelve grams that held-out channels hardly feel were "as good" where they cost 26 nats; a bent model is none."""
    own, there = leaving(noise(0)), leaving(noise(0))
    own.chi2_per_dof = left
    trial = place_control.ElsewhereTrial("there", there)
    monkeypatch.setattr(place_control, "elsewhere", lambda *_: (trial,))
    winner, other = Rival(own, 20.2, 20.2, 20.2, 1.0), Rival(there, gain, gain, gain, 1.0)
    found = place_control.controlled(Addition(winner, (winner,), (winner,), 2.0), lambda f: other, 5.0)
    assert (other in found.equivalent) == open_there


@pytest.mark.slow
def test_a_strong_absorber_does_worse_everywhere_else(tmp_path: Path) -> None:
    known = available_effects()
    values = {"mass_kg": 0.04, "frequency_hz": 8.0, "x_m": 0.9, "y_m": -1.2}
    case = problem(tmp_path, 13, known["local-absorber"](**values))
    hypothesis = Hypothesis(known["local-absorber"])
    winner = fit(case, (hypothesis,), drawn_scores(case, 13), hypothesis.scores(values), NEAR)
    place = place_of(winner)
    assert place is not None
    assert np.hypot(place[0] - 0.9, place[1] + 1.2) < 0.1
    trials = elsewhere(winner)
    assert len(trials) >= 2
    assert not any(as_good(t.fit, winner, 5.0) for t in trials)
    assert as_good(winner, winner, 5.0)


def test_where_else_is_said_by_points_or_by_the_settings_that_say_where(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not by how it came about: another course, another order of a filter, is no other place."""
    monkeypatch.setattr(place_control, "_touched", lambda fit: None)
    known = available_effects()

    def rival(name: str, **settings: Any) -> Any:
        hypothesis = Hypothesis(known[name], settings)
        fitted = SimpleNamespace(hypotheses=(hypothesis,), values=lambda k: {})
        return SimpleNamespace(name=name, hypothesis=hypothesis, fit=fitted)

    soft, other = rival("root-compliance", side="left"), rival("root-compliance", side="right")
    filtered = [rival("anti-alias-delay", channels="7+Z", order=order) for order in (4, 6)]
    mass = [rival("added-mass", x_m=0.5, y_m=y) for y in (1.0, -1.0)]
    for round_of, words in (
        ((soft, other), ("with side = right",)),
        ((soft, rival("carry-through-torsion")), ()),
        (filtered, ()),
        (mass, ("at x = 0.50 m, y = -1.00 m",)),
    ):
        addition: Any = Addition(round_of[0], tuple(round_of), tuple(round_of), None)
        assert open_places(addition) == words


def test_the_winner_elsewhere_is_told_with_its_parameters_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Other names alone were: of a mass that does as well on the other wing nothing was told but a sentence."""
    case = problem(tmp_path, 3)
    size, sides = {"mass_kg": 0.05, "x_m": 0.75}, (-0.9, 0.9)
    rivals = tuple(
        Rival(claimed(case, "added-mass", size | {"y_m": y}), 50.0 - k, 50.0, 50.0, 1.0) for k, y in enumerate(sides)
    )
    addition = Addition(rivals[0], rivals, rivals, 9.0)
    found: Any = SimpleNamespace(rounds=(addition,), final=rivals[0].fit)
    (effect,) = named_effects(found)
    (there,) = effect.elsewhere
    assert (there.not_there, there.where) == ("at x = 0.75 m, y = -0.90 m", "at x = 0.75 m, y = 0.90 m")
    assert (effect.parameters["y_m"][0], there.parameters["y_m"][0]) == pytest.approx(sides)
    assert there.parameters["y_m"][1] > 0 and set(there.ranges) == set(there.parameters)
    assert effect.equivalent == () and "; as well: the same at x = 0.75 m, y = 0.90 m" in effect.in_words
    document: Any = _effect_document(effect)
    (told,) = document["elsewhere"]
    assert told["where"] == there.where and told["parameters"]["y_m"]["value"] == pytest.approx(0.9)
    (row,) = effects_table([document]).rows
    assert row[-1] == "the same at x = 0.75 m, y = 0.90 m"
    for name, stub in {"posterior_of": [], "gain_tables": (), "unwritten": ()}.items():
        monkeypatch.setattr(augment, name, lambda *_, stub=stub: stub)
    monkeypatch.setattr(augment, "at_whole_cells", lambda fit: fit)
    verdict: Any = SimpleNamespace(
        kind=SimpleNamespace(value="ambiguous"), reasons=(), effects=(effect,), leads=(), scenario=case.scenario,
        attribution=SimpleNamespace(final=None), resimulated=SimpleNamespace(remark=""),
    )  # fmt: skip
    augment.write_reconciled(tmp_path / "reconciled.toml", verdict, {})
    lines = (tmp_path / "reconciled.toml").read_text("utf-8").splitlines()
    assert "# added-mass: 50.0 nats, equivalent: the same at x = 0.75 m, y = 0.90 m" in lines
    second = lines.index("# the same at x = 0.75 m, y = 0.90 m, not switched on here:")
    assert [any(line.startswith("#   y_m = 0.9 ") for line in part) for part in (lines[:second], lines[second:])] == [
        False, True,
    ]  # fmt: skip
    (alone,) = named_effects(SimpleNamespace(rounds=(replace(addition, equivalent=rivals[:1]),), final=rivals[0].fit))  # type: ignore[arg-type]
    assert alone.elsewhere == ()


def test_of_settings_it_is_said_where_the_winner_has_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(place_control, "_touched", lambda fit: None)
    sides = []
    for side in ("left", "right"):
        hypothesis = Hypothesis(available_effects()["root-compliance"], {"side": side})
        fitted = SimpleNamespace(hypotheses=(hypothesis,), values=lambda k: {})
        sides.append(SimpleNamespace(name=hypothesis.name, hypothesis=hypothesis, fit=fitted))
    addition: Any = Addition(sides[0], tuple(sides), tuple(sides), None)  # type: ignore[arg-type]
    (there,) = members_elsewhere(addition)
    assert (there.where, there.not_there, there.rival) == ("with side = right", "with side = left", sides[1])


def test_the_same_channels_in_other_words_are_one_place(tmp_path: Path) -> None:
    """A sensor's number in the last run is the point where it sits there; of A/F nobody knows which of both it was."""
    scenario = roving_scenario()
    case = make_problem(campaign_of(scenario, 1), scenario, lines=60, cache=tmp_path)
    last = {"shape": "step", "from_run": 4}

    def elsewhere_said(one: dict[str, Any], other: dict[str, Any], name: str = "gain-drift") -> tuple[str, ...]:
        size = {"gain-drift": {"drift": 0.05}, "channel-delay": {"delay_s": 1e-4}}[name]
        fits = [claimed(case, name, size, **settings) for settings in (one, other)]
        rivals = tuple(Rival(f, 9.0, 9.0, 9.0, 1.0) for f in fits)
        return open_places(Addition(rivals[0], rivals, rivals, None))

    assert elsewhere_said(last | {"channels": "sensor-3"}, last | {"channels": "12+Z"}) == ()
    assert elsewhere_said(last | {"channels": "sensor-3"}, last | {"channels": "16+Z"}) == ("with channels = 16+Z",)
    assert elsewhere_said({"channels": "sensor-3"}, {"channels": "12+Z"}) == ("with channels = 12+Z",)
    assert elsewhere_said({"channels": "response"}, {"channels": "force"}, "channel-delay") == ()
    assert elsewhere_said({"channels": "7+Z"}, {"channels": "3+Z"}, "channel-delay") == ("with channels = 3+Z",)
