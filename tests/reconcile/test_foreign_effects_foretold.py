"""Somebody else's effects that relax, or are at an exciter: the loop foretells what the simulator makes of them.

They hold elements as no effect of the catalogue does: one branch, several laws at once, a run of its own, two springs
that one gauge feels, mounts in series.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray
from reconciled_case import roving_scenario, without_instrument_noise

from vgvt.data import Campaign
from vgvt.effects import Action, Family, available_effects, parameter
from vgvt.effects.elements import Element, MountCompliance, Relaxation, RotationSpring
from vgvt.effects.registry import EffectPluginWarning
from vgvt.reconcile.fitting.misfit import data_misfit, jacobian
from vgvt.reconcile.prediction.grouping import assembled
from vgvt.reconcile.prediction.surrogate import Anchor, anchor
from vgvt.reconcile.question import data
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS, Problem, problem_of
from vgvt.scenario import Scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import simulated_campaign

LINES = 60
# Of what an effect does, and of A/F: at the end of a sweep records are worth three ten-thousandths.
OF_THE_CHANGE, OF_THE_WHOLE = 0.01, 4e-4


@dataclass(frozen=True)
class Foreign:
    """An effect of a size; its kinds differ in what they add."""

    name: ClassVar[str] = "foreign"
    summary: ClassVar[str] = "What no effect of the catalogue adds"
    family: ClassVar[Family] = Family.AIRFRAME
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "none"
    confused_with: ClassVar[tuple[str, ...]] = ()
    separating_test: ClassVar[str] = "none"
    reference: ClassVar[str] = "none"

    size: float = parameter("", 0.01, 0.3, "size", neutral=0.0, scale="log")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add the elements of this kind."""
        return Action(elements=self.elements(2 * scenario.excitation.band_hz[1], run)) if self.size else Action()

    def elements(self, limit_hz: float, run: int) -> tuple[Element, ...]:
        """What a kind adds in a run."""
        raise NotImplementedError


class OneBranch(Foreign):
    """A material with one corner."""

    def elements(self, limit_hz: float, run: int) -> tuple[Element, ...]:
        return (Relaxation(limit_hz, ((self.size, 8.0),)),)


class OneRunRelaxes(Foreign):
    """The same from the third run on: runs differ in their coordinates."""

    def elements(self, limit_hz: float, run: int) -> tuple[Element, ...]:
        return (Relaxation(limit_hz, ((self.size, 8.0),)),) if run >= 2 else ()


class TwoMaterials(Foreign):
    """One by each mode's own frequency, with a spring and a dashpot beside it, and one below 20 Hz alone."""

    def elements(self, limit_hz: float, run: int) -> tuple[Element, ...]:
        own = ((self.size, 0.5), (self.size / 2, 2.0))
        return (
            Relaxation(limit_hz, own, relative=True, spring_share=-self.size / 4, dashpot_share=self.size / 10),
            Relaxation(20.0, ((self.size, 8.0),), owner="rig"),
        )


class TwoSpringsOneGauge(Foreign):
    """Moments about two axes, of which the gauge reads one with the other sign."""

    def elements(self, limit_hz: float, run: int) -> tuple[Element, ...]:
        springs = (("pitch", 10.0), ("roll", -5.0))
        return tuple(
            RotationSpring(axis, 20 * self.size, 0.2 * self.size, felt, exciter=0)  # type: ignore[arg-type]
            for axis, felt in springs
        )


class MountsInSeries(Foreign):
    """Two soft mounts of one transducer, in every other run."""

    def elements(self, limit_hz: float, run: int) -> tuple[Element, ...]:
        soft = tuple(MountCompliance(n_per_m / self.size, 0.05, exciter=0) for n_per_m in (40.0, 20.0))
        return soft if run % 2 else ()


class AllAtOnce(Foreign):
    """Branches, a spring that the gauge feels, and a mount."""

    def elements(self, limit_hz: float, run: int) -> tuple[Element, ...]:
        return (
            MountCompliance(100 / self.size, 0.05, exciter=0),
            Relaxation(limit_hz, ((self.size, 8.0),)),
            RotationSpring("pitch", 20 * self.size, 0.2 * self.size, 10.0, exciter=0),
        )


class AnotherShaker(Foreign):
    """A spring at a shaker that there is not, and that an index from behind finds."""

    def elements(self, limit_hz: float, run: int) -> tuple[Element, ...]:
        return (RotationSpring("pitch", 20 * self.size, 0.2 * self.size, 10.0, exciter=-1),)


KINDS = (OneBranch, OneRunRelaxes, TwoMaterials, TwoSpringsOneGauge, MountsInSeries, AllAtOnce)


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return without_instrument_noise(roving_scenario())


@pytest.fixture(scope="module")
def measured(scenario: Scenario) -> data.Measured:
    return data.measured_frfs(simulated_campaign(scenario, engine="linear"), lines=LINES)


@pytest.fixture(scope="module")
def case(scenario: Scenario, measured: data.Measured) -> Problem:
    return problem_of(measured, scenario)


def stated(case: Problem) -> NDArray[np.float64]:
    """The stated values, with as coarse a chain as the scenario says."""
    u = np.zeros(case.size)
    u[case.unknowns.index(CELLS)] = -100.0
    return u


def simulated(scenario: Scenario, kind: type[Foreign], monkeypatch: pytest.MonkeyPatch) -> Campaign:
    known = available_effects() | {kind.name: kind}
    monkeypatch.setattr("vgvt.effects.registry.available_effects", lambda: known)
    table = EffectTable(name=kind.name, size=0.1)
    return simulated_campaign(scenario.model_copy(update={"effect": (table,)}), engine="linear")


def foretold(case: Problem, kind: type[Foreign], e: NDArray[np.float64], **how: object) -> Anchor:
    return anchor(case, stated(case), (Hypothesis(kind, {}),), e, **how)  # type: ignore[arg-type]


def rms(values: NDArray[np.complex128]) -> float:
    return float(np.sqrt(np.mean(np.abs(values) ** 2)))


@pytest.mark.parametrize("kind", KINDS)
def test_it_does_what_the_simulator_makes_it_do(
    scenario: Scenario, measured: data.Measured, case: Problem, kind: type[Foreign], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Assembled, and beside the bare aircraft as a screen has it."""
    monkeypatch.setattr(data, "_chosen", lambda *given: measured.lines)
    u, none, size = stated(case), np.zeros(0), np.abs(measured.values)
    bare = anchor(case, u, (), none, slopes=False)
    there = data.measured_frfs(simulated(scenario, kind, monkeypatch), lines=LINES)
    change = (there.values - measured.values) / size
    assert rms(change) > 10 * OF_THE_WHOLE
    with_it = replace(case, measured=there)
    e = Hypothesis(kind, {}).scores({"size": 0.1})
    for beside in (None, bare.assembled):
        found = foretold(with_it, kind, e, slopes=False, beside=beside).predict(u, e)
        missed = (found - bare.predict(u, none)) / size - change
        assert rms(missed) < OF_THE_CHANGE * rms(change) + OF_THE_WHOLE


@pytest.mark.parametrize("kind", KINDS)
def test_its_slope_is_that_of_differences(case: Problem, kind: type[Foreign]) -> None:
    """A fit steps by it."""
    u, e = stated(case), Hypothesis(kind, {}).scores({"size": 0.1})
    here = foretold(case, kind, e)
    slope = jacobian(here, u, e, here.predict(u, e))[:, -1]
    up, down = (
        data_misfit(case, foretold(case, kind, e + by, slopes=False).predict(u, e + by)) for by in (1e-3, -1e-3)
    )
    expected = (up - down) / 2e-3
    assert np.linalg.norm(slope - expected) < 0.01 * np.linalg.norm(expected)


def test_one_at_a_shaker_that_there_is_not_is_left_out(case: Problem) -> None:
    """It had been foretold as if it were at the last one, which is not what the simulator made of it."""
    told = r"^effect 'foreign' failed in act\(run 0\): RotationSpring.exciter is -1: .*goes on without it there$"
    with pytest.warns(EffectPluginWarning, match=told):
        assert assembled(case, stated(case), (Hypothesis(AnotherShaker, {}),), np.zeros(1)) is None
