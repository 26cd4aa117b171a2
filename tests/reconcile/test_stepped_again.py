"""A joint that depends on level is simulated again in time, each run as hard as it was measured."""

from __future__ import annotations

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
from vgvt.reconcile.outcome import resimulate, stepped_again
from vgvt.reconcile.outcome.augment import augment
from vgvt.reconcile.outcome.resimulate import resimulated
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS, Problem, make_problem
from vgvt.scenario import Scenario
from vgvt.simulation import simulated_campaign
from vgvt.simulation.campaign import stepping_work

ROOT: dict[str, Any] = {"root_stiffness_n_m_per_rad": 2000.0, "kind": "bending", "side": "both"}
CUBIC = Hypothesis(available_effects()["cubic-root-stiffness"], {"cubic_n_m_per_rad3": 2e7, **ROOT})


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    """A short sweep over the first bending mode, in a quiet run and a loud one."""
    quiet = without_instrument_noise(small_scenario())
    sweep = quiet.excitation.model_copy(update={"stop_hz": 12.0, "duration_s": 3.0, "ring_down_s": 2.0})
    acquisition = quiet.acquisition.model_copy(update={"runs": (quiet.acquisition.run_nodes[0],) * 2})
    return quiet.model_copy(update={"excitation": sweep, "acquisition": acquisition})


@pytest.fixture(scope="module")
def stiffening(scenario: Scenario) -> Campaign:
    """What a lab measures of such a root at a third of the stated drive, and at one and a half times of it."""
    stiff = with_effect(scenario, available_effects()["cubic-root-stiffness"](cubic_n_m_per_rad3=2e7, **ROOT))
    return simulated_campaign(stiff, engine="mujoco", levels=(0.3, 1.5))


@pytest.fixture(scope="module")
def case(scenario: Scenario, stiffening: Campaign, tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return make_problem(stiffening, scenario, lines=120, cache=tmp_path_factory.mktemp("cache"))


def named(case: Problem, *hypotheses: Hypothesis) -> Fit:
    """The names beside the aircraft as stated, cells included."""
    u = np.zeros(case.size)
    u[case.unknowns.index(CELLS)] = -10 / CELLS.sd
    return fit(case, hypotheses, u, np.zeros(0), ())


def test_runs_are_driven_as_hard_as_asked(scenario: Scenario) -> None:
    """The linear engine's records are so many times as large, commands too; the joint's are not."""
    once = simulated_campaign(scenario, engine="linear")
    driven = simulated_campaign(scenario, engine="linear", levels=(0.5, 2.0))
    for run, level in enumerate((0.5, 2.0)):
        one, other = once.runs[run].samples, driven.runs[run].samples
        scale = np.abs(one).max(axis=1, keepdims=True)
        assert np.abs(other - level * one).max() < 1e-3 * (level * scale).min()
    with pytest.raises(ValueError, match="shorter"):
        simulated_campaign(scenario, engine="linear", levels=(0.5,))


def test_what_stepping_takes_grows_with_the_record(scenario: Scenario) -> None:
    longer = scenario.excitation.model_copy(update={"duration_s": 2 * scenario.excitation.duration_s})
    work = stepping_work(scenario)
    assert stepping_work(scenario.model_copy(update={"excitation": longer})) > 1.5 * work > 0


def test_a_joint_is_simulated_at_the_levels_that_were_measured(
    scenario: Scenario, case: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The file's simulation does what was fitted; at the drive as stated, in either run, it is another aircraft's."""
    found = named(case, CUBIC)
    written = augment(scenario, SimpleNamespace(final=found))  # type: ignore[arg-type]
    told: list[float] = []
    again = resimulated(written, found, progress=lambda fraction, message: told.append(fraction))
    assert again.comparison is not None and again.apart is not None
    assert "stepped in time at 0.3 to 1.5 times the scenario's drive" in again.remark
    assert told and told == sorted(told)
    assert again.remark.endswith("as hard as it was measured")
    assert again.apart < 0.004
    assert again.comparison.train.chi2_per_dof < 0.01
    as_stated = stepped_again.simulated_campaign
    monkeypatch.setattr(
        stepped_again, "simulated_campaign",
        lambda *given, levels=None, **options: as_stated(*given, **options),
    )  # fmt: skip
    elsewhere = resimulated(written, found)
    assert elsewhere.apart is not None and elsewhere.apart > 4 * again.apart
    assert elsewhere.comparison is not None and elsewhere.comparison.train.chi2_per_dof > 1
    # The quiet run was shaken more than three times as hard.
    assert "which makes 3.3 times the force that was measured" in elsewhere.remark


def test_what_takes_too_long_or_blows_up_is_skipped(
    scenario: Scenario, case: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = named(case, CUBIC)
    written = augment(scenario, SimpleNamespace(final=found))  # type: ignore[arg-type]

    def blown_up(*_: object) -> None:
        raise FloatingPointError("run 1 diverges at 3 s")

    monkeypatch.setattr(resimulate, "stepped_again", blown_up)
    assert "it cannot be simulated: run 1 diverges" in resimulated(written, found).remark
    monkeypatch.setattr(stepped_again, "MOST_WORK", 1.0)
    assert "takes too long beside a verdict" in resimulated(written, found).remark
    assert resimulated(written, replace(found, hypotheses=())).comparison is not None
