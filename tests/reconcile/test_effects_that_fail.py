"""Somebody else's effect that fails: the search leaves out what fails of it, with its name, and goes on."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar, Literal

import numpy as np
import pytest
from reconciled_case import problem, small_scenario

from vgvt.data import InputError
from vgvt.effects import Action, ChannelFilter, Family, parameter
from vgvt.effects.action import NOTHING
from vgvt.effects.registry import EffectPluginWarning
from vgvt.reconcile.fitting.fit import fit
from vgvt.reconcile.prediction.grouping import NoStructureError, assembled, run_actions
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.candidates import candidates
from vgvt.reconcile.search.stand import Stand
from vgvt.scenario import Scenario


@dataclass(frozen=True)
class Failing:
    """Does nothing, refuses, or fails, by its kind; beyond its plausible range it fails whatever that is."""

    name: ClassVar[str] = "failing"
    family: ClassVar[Family] = Family.SENSORS
    linear: ClassVar[bool] = True
    size: float = parameter("", 0.1, 1.0, "size", neutral=0.0)
    kind: Literal["works", "refuses", "looks up", "divides"] = field(default="works", metadata={"doc": "how"})

    def act(self, scenario: Scenario, run: int) -> Action:
        if self.kind == "refuses":
            raise InputError("effect failing", "no such sensor")
        if self.kind == "looks up" and run > 0:
            return {}["k"]
        if self.kind == "divides" or self.size > 1.0:
            raise ZeroDivisionError("float division by zero")
        return NOTHING


def about(runs: int) -> Any:
    """What candidates ask of a problem."""
    return SimpleNamespace(scenario=small_scenario(), measured=SimpleNamespace(runs=((1, 2),) * runs, run_numbers=()))


def test_variants_that_fail_are_left_out_with_a_warning_that_names_the_effect() -> None:
    """In any run; what is refused is offered, and refused where it is tried."""
    told = r"^effect 'failing' failed in act\(run 1\): KeyError: 'k'; 2 of 4 variants left out$"
    with pytest.warns(EffectPluginWarning, match=told) as caught:
        found = candidates(about(2), {"failing": Failing})
    assert len(caught) == 1
    assert [h.settings["kind"] for h in found] == ["works", "refuses"]
    assert sum(h.share for h in found) == pytest.approx(1.0)


def test_of_one_that_always_fails_nothing_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Failing, "act", lambda *_: None)
    with pytest.warns(EffectPluginWarning, match="it gave NoneType, not an Action; 4 of 4 variants left out"):
        assert candidates(about(1), {"failing": Failing}) == ()


def test_bundled_ones_are_not_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    """They have tests of their own, and a fault of theirs is to be seen where it happens."""
    monkeypatch.setattr("vgvt.data.plugin._BUNDLED", frozenset({Failing.__module__.partition(".")[0]}))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(candidates(about(2), {"failing": Failing})) == 4
    with pytest.raises(ZeroDivisionError):
        run_actions(small_scenario(), (Failing(kind="divides"),), 1)


def test_one_that_fails_only_where_a_fit_leads_is_refused_there(tmp_path: Path) -> None:
    case = problem(tmp_path, 1)
    hypothesis = Hypothesis(Failing, {"kind": "works"})
    at = [hypothesis.scores({"size": size}) for size in (0.5, 1.2)]
    assert assembled(case, np.zeros(case.size), (hypothesis,), at[0]) is not None
    told = r"^effect 'failing' failed in act\(run 0\): ZeroDivisionError: .*; the search goes on without it there$"
    for _ in range(2):  # told each time: what fails is not remembered
        with pytest.warns(EffectPluginWarning, match=told):
            assert assembled(case, np.zeros(case.size), (hypothesis,), at[1]) is None
    with pytest.warns(EffectPluginWarning, match=told), pytest.raises(NoStructureError, match="effect 'failing'"):
        run_actions(small_scenario(), (Failing(size=1.2),), 1)


@dataclass(frozen=True)
class Bounded(Failing):
    """Refuses sizes beyond its plausible range as it is made."""

    def __post_init__(self) -> None:
        if self.size > 1.0:
            raise InputError("effect bounded", "size is larger than 1")


def test_one_that_refuses_its_values_is_no_aircraft_there(tmp_path: Path) -> None:
    """Without a warning: a fit may ask for anything."""
    case = problem(tmp_path, 1)
    hypothesis = Hypothesis(Bounded, {"kind": "works"})
    inside, beyond = (hypothesis.scores({"size": size}) for size in (0.5, 1.2))
    assert assembled(case, np.zeros(case.size), (hypothesis,), inside) is not None
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert assembled(case, np.zeros(case.size), (hypothesis,), beyond) is None


@dataclass(frozen=True)
class Filtering:
    """A gain whose filter has no number at some lines, and from some size on nowhere."""

    name: ClassVar[str] = "filtering"
    family: ClassVar[Family] = Family.ACQUISITION
    linear: ClassVar[bool] = True
    size: float = parameter("", 0.1, 1.0, "size", neutral=0.0)
    kind: Literal["works", "short"] = field(default="works", metadata={"doc": "how"})

    def act(self, scenario: Scenario, run: int) -> Action:
        return Action(channels=(ChannelFilter("response", self._response),))

    def _response(self, frequency_hz: Any) -> Any:
        return (1 + self.size + 0 * frequency_hz)[self.kind == "short" :] / (self.size <= 1.0)


def test_a_filter_that_fails_at_the_campaigns_lines_is_left_out(tmp_path: Path) -> None:
    told = r"^effect 'filtering' failed in the ChannelFilter on 'response' .*: TypeError: .*; 1 of 2 variants left out$"
    with pytest.warns(EffectPluginWarning, match=told):
        found = candidates(problem(tmp_path, 1), {"filtering": Filtering})
    assert [h.settings["kind"] for h in found] == ["works"]


@pytest.mark.filterwarnings("ignore:divide by zero")
def test_a_filter_that_fails_only_where_a_fit_leads_is_refused_there(tmp_path: Path) -> None:
    case = problem(tmp_path, 1)
    hypothesis = Hypothesis(Filtering, {"kind": "works"})
    u = np.zeros(case.size)
    inside, beyond = (hypothesis.scores({"size": size}) for size in (0.5, 1.2))
    there = anchor(case, u, (hypothesis,), inside)
    stand = Stand.of(fit(case, (), u, np.zeros(0), ()))
    assert stand.change(hypothesis, {"size": 0.5}) is not None
    with pytest.warns(EffectPluginWarning, match="the search goes on without it there"):
        assert stand.change(hypothesis, {"size": 1.2}) is None
    with pytest.warns(EffectPluginWarning, match="the search goes on without it there"):
        assert stand._linear_change(hypothesis, {"size": 1.2}) is None
    assert np.isfinite(there.predict(u, inside)).all()
    told = r"^effect 'filtering' failed in the ChannelFilter on 'response' .*; the search goes on without it there$"
    with pytest.warns(EffectPluginWarning, match=told), pytest.raises(NoStructureError, match="effect 'filtering'"):
        there.predict(u, beyond)
