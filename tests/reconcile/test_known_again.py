"""What is kept or shared for speed is what the straightforward computation gives."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from reconciled_case import roving_problem

from vgvt.effects import available_effects
from vgvt.effects.acting import acted, action_of
from vgvt.effects.action import NOTHING
from vgvt.effects.control_surface import ControlSurface
from vgvt.effects.section_cg_offset import SectionCgOffset
from vgvt.reconcile.mechanics.ending import left_out
from vgvt.reconcile.mechanics.response import accelerances, poles_of
from vgvt.reconcile.prediction import acts_known, grouping
from vgvt.reconcile.prediction.plain import plain_of
from vgvt.reconcile.prediction.riding import Riders
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """Four runs of five roving sensors."""
    return roving_problem(tmp_path_factory.mktemp("cache"), 80)


def _forget() -> None:
    grouping._assembled.cache_clear()
    plain_of.cache_clear()
    acts_known._action.cache_clear()


@pytest.mark.parametrize("name", ["local-absorber", "root-creep", "section-cg-offset"])
def test_an_anchor_at_known_groups_is_one_that_is_made_anew(case: Problem, name: str) -> None:
    """Prediction and slopes to the last bit, whatever was asked for before."""
    hypothesis = (Hypothesis(available_effects()[name]),)
    u = 0.3 * np.random.default_rng(3).standard_normal(case.size)
    e = np.full(len(hypothesis[0].parameters), 0.2)

    def answers() -> tuple[Any, Any]:
        looked = anchor(case, u, hypothesis, e, slopes=False)
        sloped = anchor(case, u, hypothesis, e, groups=looked.assembled)
        return looked.predict(u, e), sloped.slopes()

    _forget()
    fresh = answers()
    groups = grouping.assembled(case, u, hypothesis, e)
    assert groups is grouping.assembled(case, u.copy(), hypothesis, e.copy())
    again = answers()
    _forget()
    anew = grouping.assembled(case, u, hypothesis, e)
    assert anew is not groups and anew is not None and groups is not None
    for one, other in zip(groups, anew, strict=True):
        assert np.array_equal(one.structure.stiffness, other.structure.stiffness)
    for found, known in zip(fresh, again, strict=True):
        assert np.array_equal(found, known)
    _forget()
    whole = anchor(case, u, hypothesis, e)
    assert np.array_equal(whole.slopes(), fresh[1])


def test_a_group_is_reduced_beside_its_own_chain(case: Problem) -> None:
    """What its highest modes lack goes with the cells: a group known at others has another flexibility."""
    groups = grouping.assembled(case, np.zeros(case.size), (), np.zeros(0))
    assert groups is not None
    group = groups[0]
    continuum, stated = (plain_of(case, cells, group).matrices.spare for cells in (0.0, -1.0))
    lacking = grouping.spare_by_cells(case, group.structure, group.rows)
    assert np.abs(lacking).max() > 1e-3 * np.abs(continuum).max()
    # A difference of what is nearly the same: entries that hardly lack anything are round-off.
    np.testing.assert_allclose(continuum - stated, lacking, rtol=1e-9, atol=1e-12 * np.abs(lacking).max())


def test_elsewhere_groups_are_others(case: Problem) -> None:
    hypothesis = (Hypothesis(available_effects()["local-absorber"]),)
    u, e = np.zeros(case.size), np.zeros(len(hypothesis[0].parameters))
    here = grouping.assembled(case, u, hypothesis, e)
    assert here is not grouping.assembled(case, u + 0.1, hypothesis, e)
    assert here is not grouping.assembled(case, u, hypothesis, e + 0.1)
    assert here is not grouping.assembled(case, u, (replace(hypothesis[0]),), e)


def test_known_poles_give_the_same_answers(case: Problem) -> None:
    u, omega = np.zeros(case.size), 2 * np.pi * case.measured.frequency_hz
    here = anchor(case, u, slopes=False)
    (group,) = here.groups
    masses = tuple(group.masses_kg[rows] for rows in group.runs)
    of, poles = (group.matrices, omega, group.runs, masses), poles_of(group.matrices, omega)
    assert np.array_equal(accelerances(*of, poles), accelerances(*of))
    ends = here._endings(group)
    assert np.array_equal(left_out(*of, ends, poles), left_out(*of, ends))


@pytest.mark.parametrize("roving", [False, True])
def test_what_sensors_weigh_is_the_sum_over_them(case: Problem, roving: bool) -> None:
    (group,) = anchor(case, np.zeros(case.size), slopes=False).assembled
    (reduced,) = anchor(case, np.zeros(case.size), slopes=False).groups
    s, total = group.structure, np.zeros_like(group.structure.mass)
    masses = 0.01 + 0.001 * np.arange(group.rows.size)
    for run in reduced.runs if roving else reduced.runs[:1]:
        for k in run:
            moved, axis = s.jacobian[group.rows[k]], s.axis[group.rows[k]]
            total += masses[k] * (moved.T @ moved - roving * np.outer(axis, axis))
    total /= len(reduced.runs) if roving else 1
    first = slice(None) if roving else reduced.runs[0]
    found = Riders(group.rows[first], masses[first], len(reduced.runs) if roving else 1, roving).inertia(s)
    assert np.abs(found - total).max() < 1e-13 * np.abs(total).max()


def test_effects_that_stay_are_asked_once(case: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    """And what all do together is what it is without any memory."""
    asked: list[str] = []

    def counting(effect: Any, scenario: Any, run: int) -> Any:
        asked.append(effect.name)
        return action_of(effect, scenario, run)

    _forget()
    monkeypatch.setattr(acts_known, "action_of", counting)
    stays, scenario = SectionCgOffset(offset_m=0.004), case.start.scenario
    for compliance in (2.0, 3.0, 4.0):
        effects = (stays, ControlSurface(compliance_rad_per_n_m=compliance))
        for run in range(4):
            found, plain = (acted(effects, scenario, run, act) for act in (acts_known.action_known, action_of))
            assert found[0] == plain[0]
            assert [(a.scenario, a.elements, a.points) for a in found[1]] == [
                (a.scenario, a.elements, a.points) for a in plain[1]
            ]
    assert asked.count("section-cg-offset") == 4 and asked.count("control-surface") == 12
    equal = scenario.model_copy()
    acts_known.action_known(stays, equal, 0)
    assert asked.count("section-cg-offset") == 5
    _forget()


def test_an_effect_that_cannot_be_hashed_is_asked_each_time(case: Problem) -> None:
    asked: list[int] = []

    class Listed:
        name = "listed"
        __hash__ = None  # type: ignore[assignment]

        def act(self, scenario: Any, run: int) -> Any:
            del scenario
            asked.append(run)
            return NOTHING

    effect: Any = Listed()
    for _ in range(2):
        assert acts_known.action_known(effect, case.start.scenario, 3).same_rig(NOTHING)
    assert asked == [3, 3]
