"""A joint that depends on level is written back and simulated again with each run as hard as it was measured."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import small_scenario, without_instrument_noise

from vgvt.data import Campaign
from vgvt.effects import available_effects
from vgvt.effects.conformance import with_effect
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.outcome import resimulate
from vgvt.reconcile.outcome.augment import augment
from vgvt.reconcile.outcome.measured_levels import with_measured_levels
from vgvt.reconcile.outcome.resimulate import resimulated
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS, Problem, make_problem
from vgvt.scenario import Scenario
from vgvt.scenario.generator import Generator
from vgvt.scenario.write import to_toml
from vgvt.simulation import simulated_campaign

ROOT: dict[str, Any] = {"root_stiffness_n_m_per_rad": 2000.0, "kind": "bending", "side": "both"}
CUBIC = Hypothesis(available_effects()["cubic-root-stiffness"], {"cubic_n_m_per_rad3": 2e7, **ROOT})


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    """A short sweep over the first bending mode, in a quiet run and a loud one."""
    quiet = without_instrument_noise(small_scenario())
    sweep = quiet.excitation.model_copy(update={"stop_hz": 12.0, "duration_s": 3.0, "ring_down_s": 2.0})
    acquisition = quiet.acquisition.with_runs((quiet.acquisition.run_nodes[0],) * 2)
    return quiet.model_copy(update={"excitation": sweep, "acquisition": acquisition})


def at(scenario: Scenario, *levels: float) -> Scenario:
    """The scenario with its runs at these levels."""
    acquisition = scenario.acquisition
    return scenario.model_copy(update={"acquisition": acquisition.with_runs(acquisition.run_nodes, levels)})


@pytest.fixture(scope="module")
def stiffening(scenario: Scenario) -> Campaign:
    """What a lab measures of such a root at a third of the stated drive, and at one and a half times of it."""
    stiff = with_effect(scenario, available_effects()["cubic-root-stiffness"](cubic_n_m_per_rad3=2e7, **ROOT))
    return simulated_campaign(at(stiff, 0.3, 1.5), engine="mujoco")


@pytest.fixture(scope="module")
def case(scenario: Scenario, stiffening: Campaign, tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return make_problem(stiffening, scenario, lines=120, cache=tmp_path_factory.mktemp("cache"))


@pytest.fixture(scope="module")
def found(case: Problem) -> Fit:
    """The joint beside the aircraft as stated, cells included."""
    u = np.zeros(case.size)
    u[case.unknowns.index(CELLS)] = -10 / CELLS.sd
    return fit(case, (CUBIC,), u, np.zeros(0), ())


@pytest.fixture(scope="module")
def written(scenario: Scenario, found: Fit) -> Scenario:
    return augment(scenario, SimpleNamespace(final=found))  # type: ignore[arg-type]


def test_the_levels_of_the_runs_are_written_with_a_joint_that_depends_on_them(
    scenario: Scenario, found: Fit, written: Scenario
) -> None:
    """The joint changes the force that a drive makes, by a little; what is linear needs no level: none is written."""
    assert written.acquisition.levels == pytest.approx((0.3, 1.5), rel=0.05)
    assert Scenario.model_validate(tomllib.loads(to_toml(written))).acquisition == written.acquisition
    linear = replace(found, hypotheses=(), e=np.zeros(0))
    bare = augment(scenario, SimpleNamespace(final=linear))  # type: ignore[arg-type]
    assert bare.acquisition == scenario.acquisition


def test_a_joint_is_simulated_at_the_levels_that_were_measured(
    scenario: Scenario, found: Fit, written: Scenario
) -> None:
    """The file's simulation does what was fitted; at the drive as stated, in either run, it is another aircraft's."""
    told: list[float] = []
    again = resimulated(written, found, progress=lambda fraction, message: told.append(fraction))
    assert again.comparison is not None and again.apart is not None
    assert again.remark == "It was stepped in time at 0.3 to 1.5 times the scenario's drive, as hard as it was measured"
    assert told and told == sorted(told)
    assert again.apart < 0.004
    assert again.comparison.train.chi2_per_dof < 0.01
    elsewhere = resimulated(at(written, 1.0, 1.0), found)
    assert elsewhere.apart is not None and elsewhere.apart > 4 * again.apart
    assert elsewhere.comparison is not None and elsewhere.comparison.train.chi2_per_dof > 1
    # The quiet run is shaken more than three times as hard.
    assert "at 1 times the scenario's drive, which makes 3.3 times the measured force" in elsewhere.remark


def test_what_takes_too_long_or_blows_up_is_skipped(
    found: Fit, written: Scenario, monkeypatch: pytest.MonkeyPatch
) -> None:
    def blown_up(*_: object, **__: object) -> None:
        raise FloatingPointError("run 1 diverges at 3 s")

    monkeypatch.setattr(resimulate, "simulated_campaign", blown_up)
    assert "it cannot be simulated: run 1 diverges" in resimulated(written, found).remark
    monkeypatch.setattr(resimulate, "MOST_WORK", 1.0)
    assert "takes too long beside a verdict" in resimulated(written, found).remark


def test_no_level_is_written_that_the_generator_does_not_give(scenario: Scenario, found: Fit) -> None:
    """No command would take such a file; that it is not the measured force is said when it is simulated."""
    for range_v, levels in ((1.4, None), (1.6, (0.3, 1.5))):
        limited = scenario.model_copy(update={"generator": Generator(range_v=range_v)})
        there = with_measured_levels(limited, found.problem.measured).acquisition.levels
        assert there == (None if levels is None else pytest.approx(levels, rel=0.05))


def test_a_scenario_that_cannot_be_simulated_keeps_its_levels(scenario: Scenario, found: Fit) -> None:
    broken = Scenario.model_validate(scenario.model_dump() | {"effect": [{"name": "no-such-effect"}]})
    assert with_measured_levels(broken, found.problem.measured) is broken
