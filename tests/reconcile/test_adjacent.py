"""What the fits and the screen use in place of assembling: slopes by the adjoint, and structures beside known ones."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, problem, small_scenario

from vgvt.effects import available_effects
from vgvt.reconcile.fitting.misfit import data_misfit, jacobian
from vgvt.reconcile.prediction import adjacent as adjacent_module
from vgvt.reconcile.prediction.adjacent import beside
from vgvt.reconcile.prediction.grouping import assembled
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.simulation.airframe import ROOT_JOINTS, elastic_joints
from vgvt.simulation.reduced import structure


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return problem(tmp_path_factory.mktemp("cache"), 1)


def scattered(case: Problem) -> np.ndarray:
    """Scores somewhere within the tolerances."""
    return np.asarray(0.3 * np.random.default_rng(2).standard_normal(case.size))


def fixed(name: str, values: dict[str, Any]) -> Hypothesis:
    """An effect with nothing left to fit."""
    cls = available_effects()[name]
    return Hypothesis(cls, values | {k: v for k, v in _defaults(cls).items() if k not in values})


def _defaults(cls: type) -> dict[str, Any]:
    made = cls()
    return {p.name: getattr(made, p.name) for p in Hypothesis(cls).parameters}


def test_the_adjoint_gives_the_slopes_that_differences_give(case: Problem) -> None:
    """Every unknown, gain and corner, and the parameters of a hung mass, with sensors that rove."""
    hypothesis = (Hypothesis(available_effects()["local-absorber"]),)
    u, e = scattered(case), np.array([0.3, -0.2, 0.1, 0.4, 0.2])[: len(hypothesis[0].parameters)]
    here = anchor(case, u, hypothesis, e)
    there = here.predict(u, e)
    slopes = jacobian(here, u, e, there)
    for k in range(u.size + e.size):
        sides = []
        for step in (1e-5, -1e-5):
            moved = np.concatenate([u, e])
            moved[k] += step
            sides.append(data_misfit(case, here.predict(moved[: u.size], moved[u.size :])))
        expected = (sides[0] - sides[1]) / 2e-5
        assert np.linalg.norm(slopes[:, k] - expected) <= 1e-4 * np.linalg.norm(expected) + 1e-6, k


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("added-mass", {"mass_kg": 0.01, "x_m": 0.7, "y_m": 0.9}),
        ("local-absorber", {"mass_kg": 0.002, "frequency_hz": 14.0, "x_m": 0.75, "y_m": 0.9}),
        ("stiffness-asymmetry", {"bending": 0.03}),
        ("sensor-position-error", {"node": 1, "dx_m": 0.02}),
        ("stinger-moment", {"rotational_stiffness_n_m_per_rad": 5.0}),
        ("base-strain", {"rotational_stiffness_n_m_per_rad": 5.0}),
        ("roving-sensor-mass", {"mass_kg": 0.008}),
        ("root-compliance", {"bending": 0.01}),
    ],
)
def test_beside_a_known_structure_is_what_assembling_gives(case: Problem, name: str, values: dict[str, Any]) -> None:
    """The change that an effect makes, at scores away from nominal, within what a screen needs."""
    u = scattered(case)
    hypothesis = (fixed(name, values),)
    bare = anchor(case, u, slopes=False)
    before = bare.predict(u, np.zeros(0))
    exact = anchor(case, u, hypothesis, np.zeros(0), slopes=False).predict(u, np.zeros(0))
    fast = anchor(case, u, hypothesis, np.zeros(0), slopes=False, beside=bare.assembled).predict(u, np.zeros(0))
    assert np.linalg.norm(exact - before) > 1e-6 * np.linalg.norm(before)
    assert np.linalg.norm(fast - exact) < 0.1 * np.linalg.norm(exact - before)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("swapped-sensors", {"node": 1, "other_node": 20}),
        ("sensor-position-error", {"node": 1, "dy_m": -0.3}),
    ],
)
def test_cables_are_carried_along_with_their_sensors(case: Problem, name: str, values: dict[str, Any]) -> None:
    """A sensor that turns out to sit elsewhere takes its cable there, which all other channels notice."""
    u, none = scattered(case), np.zeros(0)
    cable = fixed("cable-drag", {"stiffness_n_per_m": 30.0, "damping_n_s_per_m": 0.3, "sensors": "1+Z"})
    both = (cable, fixed(name, values))
    known = anchor(case, u, both[:1], none, slopes=False)
    exact = anchor(case, u, both, none, slopes=False).predict(u, none)
    fast = anchor(case, u, both, none, slopes=False, beside=known.assembled).predict(u, none)
    others = [k for k, c in enumerate(case.measured.channels) if c.dof.node not in values.values()]
    moved = exact[others] - known.predict(u, none)[others]
    assert np.linalg.norm(moved) > 1e-3 * np.linalg.norm(exact[others])
    assert np.linalg.norm((fast - exact)[others]) < 0.1 * np.linalg.norm(moved)


@pytest.mark.parametrize("shares", [{"bending": -0.15, "torsion": 0.0}, {"bending": 0.0, "torsion": 0.15}])
def test_a_share_of_the_stiffness_is_one_of_what_there_is(case: Problem, shares: dict[str, Any]) -> None:
    """Not of the stated wing's: 15 % of one that is far from it had been off by as much as a resonance is wide."""
    u = np.zeros(case.size)
    for k, unknown in enumerate(case.unknowns):
        u[k] = {"EI wing": -2.0, "GJ wing": 1.5}.get(
            unknown.name, -5.0 if unknown.name.startswith("EI wing-right") else 0
        )
    hypothesis = (fixed("stiffness-asymmetry", shares),)
    bare = anchor(case, u, slopes=False)
    before = bare.predict(u, np.zeros(0))
    exact = anchor(case, u, hypothesis, np.zeros(0), slopes=False).predict(u, np.zeros(0))
    fast = anchor(case, u, hypothesis, np.zeros(0), slopes=False, beside=bare.assembled).predict(u, np.zeros(0))
    assert np.linalg.norm(exact - before) > 0.01 * np.linalg.norm(before)
    assert np.linalg.norm(fast - exact) < 0.03 * np.linalg.norm(exact - before)


def test_a_channel_of_a_later_run_is_changed_too(tmp_path: Path) -> None:
    """Runs share a structure and differ in what is done to their channels."""
    whole = small_scenario()
    half = {"runs": (tuple(range(1, 11)), tuple(range(11, 21)))}
    roving = whole.model_copy(update={"acquisition": whole.acquisition.model_copy(update=half)})
    case = make_problem(campaign_of(roving, 1), roving, lines=60, cache=tmp_path)
    last = case.measured.channels[-1]
    assert last.run > 0
    bare = anchor(case, np.zeros(case.size), slopes=False)
    before = bare.predict(np.zeros(case.size), np.zeros(0))
    hypothesis = (fixed("channel-gain", {"channels": str(last.dof), "gain_error": 0.1}),)
    fast = anchor(case, np.zeros(case.size), hypothesis, np.zeros(0), slopes=False, beside=bare.assembled)
    changed = np.abs(fast.predict(np.zeros(case.size), np.zeros(0)) / before - 1).max(axis=1)
    np.testing.assert_allclose(changed[-1], 0.1, rtol=1e-6)
    assert changed[:-1].max() < 1e-9


@pytest.mark.parametrize("name", ["root-compliance", "carry-through-torsion"])
def test_another_hinge_is_seen_without_assembling_it(case: Problem, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Beside a structure it cannot be added, and to find that out by building the aircraft took most of its screen."""
    u, hypothesis = scattered(case), Hypothesis(available_effects()[name], {})
    known = assembled(case, u, (), np.zeros(0))
    assert known is not None
    e = np.full(len(hypothesis.parameters), 0.123)
    bare = available_effects()["added-mass"]
    assert beside(case, u, known, (Hypothesis(bare, {}),), np.zeros(3)) is not None

    def refused(*_: object) -> None:
        raise AssertionError("assembled")

    monkeypatch.setattr(adjacent_module, "structure", refused)
    assert beside(case, u, known, (hypothesis,), e) is None


def test_joints_are_known_by_name_before_they_are_built(case: Problem) -> None:
    stated = case.start.scenario
    for name in ("added-mass", "root-compliance", "carry-through-torsion", "stiffness-asymmetry"):
        effect = Hypothesis(available_effects()[name], {})
        made = effect.effect(effect.values(np.zeros(len(effect.parameters))))
        assert made is not None
        edited = made.act(stated, 0).scenario or stated
        layout = case.layouts.plan(edited)
        known = {*ROOT_JOINTS, *elastic_joints(layout.parts)}
        assert known == set(structure(layout, layout.grid).joints), name
        assert (known == set(case.nominal.joints)) == (name in ("added-mass", "stiffness-asymmetry"))
