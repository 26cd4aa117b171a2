"""Laws of one rigid root among hypotheses: each has a stiffness to be fitted, and the first one's stands."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, problem, small_scenario

from vgvt.data import InputError
from vgvt.effects import available_effects, make_effect
from vgvt.effects.beams import with_beams
from vgvt.effects.conformance import table_of
from vgvt.reconcile.decision.verdict import named_effects
from vgvt.reconcile.evidence.shared_roots import agreed, idle_parameters
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.outcome.augment import augment
from vgvt.reconcile.prediction.grouping import assembled
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.write import to_toml
from vgvt.simulation.assembly import plans
from vgvt.simulation.reduced import structure

GIVEN = "root_stiffness_n_m_per_rad"
SIZES = {"root-friction": ("friction_n_m", 0.2), "cubic-root-stiffness": ("cubic_n_m_per_rad3", 1e6)}


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """The root slips, and is stiffer beyond that than a fit begins with."""
    slipping = make_effect("root-friction", "test", friction_n_m=0.2, root_stiffness_n_m_per_rad=2600.0)
    return problem(tmp_path_factory.mktemp("slopes"), 1, slipping)


def law(name: str, stiffness: float, side: str = "both") -> tuple[Hypothesis, np.ndarray]:
    """A law of the bending root with the scores of its size and stiffness."""
    hypothesis = Hypothesis(available_effects()[name], {"kind": "bending", "side": side, "beam": ""})
    size, value = SIZES[name]
    return hypothesis, hypothesis.scores({size: value, GIVEN: stiffness})


def fitted(case: Problem, *laws: tuple[Hypothesis, np.ndarray], steps: int = 0) -> Fit:
    stages = ((0.05, steps),) if steps else ()
    return fit(case, tuple(h for h, _ in laws), np.zeros(case.size), np.concatenate([e for _, e in laws]), stages)


def written(found: Fit, folder: Path, scenario: Scenario | None = None) -> Scenario:
    """The scenario of a fit as a file has it."""
    stated = augment(scenario or small_scenario(), SimpleNamespace(final=found))  # type: ignore[arg-type]
    file = folder / "reconciled.toml"
    file.write_text(to_toml(stated), encoding="utf-8")
    return load_scenario(file)


def joint_stiffness(scenario: Scenario) -> list[float]:
    """Stiffness that the laws of the right and the left root have in the scenario's plan, effect by effect."""
    (layout, *_) = plans(scenario)
    assert structure(layout, layout.grid).drive.size > 0
    laws: list[Any] = [e for a in layout.actions for e in a.elements]
    return [e.stiffness_n_m_per_rad for side in ("right", "left") for e in laws if e.beam.endswith(side)]


@pytest.mark.parametrize(
    "names", [("root-friction", "cubic-root-stiffness"), ("cubic-root-stiffness", "root-friction")]
)
def test_the_first_law_of_a_rigid_root_says_how_stiff_it_is(case: Problem, names: tuple[str, str]) -> None:
    """Two scores that differ were no aircraft: no second law could be fitted beside the first, nor even tried."""

    def at(*stiffness: float) -> np.ndarray:
        laws = [law(name, k) for name, k in zip(names, stiffness, strict=True)]
        groups = assembled(case, np.zeros(case.size), tuple(h for h, _ in laws), np.concatenate([e for _, e in laws]))
        assert groups is not None
        s = groups[0].structure
        root = s.joints.index("wing-right-root/bending")
        return s.stiffness[root : root + 1, root]

    alike = at(2300.0, 2300.0)
    np.testing.assert_array_equal(at(2300.0, 900.0), alike)
    # The cubic share gives a little way: the weight turns a stiffer root less.
    assert at(2400.0, 2300.0) - alike == pytest.approx(100.0, rel=0.1)


@pytest.mark.slow
def test_two_laws_are_fitted_and_what_they_come_to_can_be_simulated(case: Problem, tmp_path: Path) -> None:
    found = fitted(case, law("root-friction", 2300.0), law("cubic-root-stiffness", 2000.0), steps=4)
    first, second = found.values(0)[GIVEN], found.values(1)[GIVEN]
    # It moves, and the data tell it; what they tell of the other is nothing.
    assert abs(first[0] - 2300.0) > 2 * first[1]
    assert first[1] < 20.0 < 1000.0 < second[1]
    # Behind them are the gains that the fit found.
    tables = [t.parameters for t in written(found, tmp_path).effect if t.name in SIZES]
    assert [t[GIVEN] for t in tables] == [first[0], first[0]]
    assert tables[1]["cubic_n_m_per_rad3"] == found.values(1)["cubic_n_m_per_rad3"][0]
    assert joint_stiffness(written(found, tmp_path)) == [first[0]] * 4


@pytest.mark.parametrize(
    ("laws", "tables", "stiffness"),
    [
        # One side of what the other has on both, and the other way round: then one table says two things.
        (
            (law("root-friction", 500.0), law("cubic-root-stiffness", 900.0, "left")),
            [("both", 500.0), ("left", 500.0)],
            [500.0, 500.0, 500.0],
        ),
        (
            (law("root-friction", 500.0, "right"), law("cubic-root-stiffness", 900.0)),
            [("right", 500.0), ("right", 500.0), ("left", 900.0)],
            [500.0, 500.0, 900.0],
        ),
        (
            (law("root-friction", 500.0, "right"), law("cubic-root-stiffness", 900.0, "left")),
            [("right", 500.0), ("left", 900.0)],
            [500.0, 900.0],
        ),
    ],
)
def test_every_side_is_stated_as_it_was_fitted(
    case: Problem, laws: Any, tables: list[tuple[str, float]], stiffness: list[float], tmp_path: Path
) -> None:
    stated = written(fitted(case, *laws), tmp_path)
    # Beside whole cells all else is a little aside of the fit, in valleys of the data: gains behind them, and per mille
    # of a stiffness.
    found = [t.parameters for t in stated.effect if t.name in SIZES]
    assert [t["side"] for t in found] == [side for side, _ in tables]
    assert [t[GIVEN] for t in found] == pytest.approx([k for _, k in tables], rel=5e-3)
    assert joint_stiffness(stated) == pytest.approx(stiffness, rel=5e-3)
    shared = {t[GIVEN] for t in found if t["side"] in (found[0]["side"], "both")}
    assert len(shared) == 1, "one root, one stiffness"


def test_a_law_that_the_scenario_states_comes_first(case: Problem, tmp_path: Path) -> None:
    stated = make_effect("root-friction", "test", friction_n_m=0.1, root_stiffness_n_m_per_rad=700.0)
    own = small_scenario().model_copy(update={"effect": (table_of(stated),)})
    beside = replace(case, scenario=case.scenario.model_copy(update={"effect": own.effect}))
    found = fitted(beside, law("cubic-root-stiffness", 900.0))
    assert joint_stiffness(written(found, tmp_path, own)) == [700.0] * 4


def test_a_stiffness_that_does_nothing_is_not_told(case: Problem) -> None:
    """It was told as the middle of its prior give or take half of it, as if the data had said so."""
    found = fitted(case, law("root-friction", 500.0, "right"), law("cubic-root-stiffness", 900.0, "right"))
    rounds = tuple(_addition(h, found) for h in found.hypotheses)
    first, second = named_effects(SimpleNamespace(rounds=rounds, final=found))  # type: ignore[arg-type]
    assert set(first.parameters) == set(first.ranges) == {"friction_n_m", GIVEN}
    assert set(second.parameters) == set(second.ranges) == {"cubic_n_m_per_rad3"}
    # On the left it is the one that makes the joint.
    both = fitted(case, law("root-friction", 500.0, "right"), law("cubic-root-stiffness", 900.0))
    assert idle_parameters(both, 1) == frozenset()


def _addition(hypothesis: Hypothesis, found: Fit) -> Any:
    winner = SimpleNamespace(name=hypothesis.name, hypothesis=hypothesis, gain_nats=9.0, held_out=None, fit=found)
    return SimpleNamespace(winner=winner, alike=(), equivalent=(), held_out_before=None)


def test_a_joint_that_the_scenario_has_leaves_tables_as_they_are(case: Problem) -> None:
    jointed = with_beams(
        case.scenario, ("wing",), lambda b: b.model_copy(update={"root_bending_stiffness_n_m_per_rad": 1500.0})
    )
    found = replace(
        fitted(case, law("root-friction", 500.0), law("cubic-root-stiffness", 900.0)),
        problem=replace(case, scenario=jointed),
    )
    for k in range(2):
        (stated,) = agreed(found, k, {GIVEN: 900.0})
        assert stated == {**found.hypotheses[k].settings, GIVEN: 900.0}
        assert idle_parameters(found, k) == {GIVEN}


def test_two_stiffnesses_that_a_scenario_states_are_refused_before_a_fit(tmp_path: Path) -> None:
    """It had been no structure, in no user's words, once the fit began."""
    scenario = small_scenario()
    tables = tuple(
        table_of(make_effect(name, "test", **{SIZES[name][0]: SIZES[name][1], GIVEN: k}))
        for name, k in (("root-friction", 500.0), ("cubic-root-stiffness", 900.0))
    )
    own = scenario.model_copy(update={"effect": tables})
    with pytest.raises(InputError, match="500 and 900"):
        make_problem(campaign_of(scenario, 1), own, lines=80, cache=tmp_path)
