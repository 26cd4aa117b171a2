"""What swings at the place and frequency that a residual shows comes on the short list, whatever tunes it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.reconcile.evidence.localise import Place
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.search.scan import tuned_to
from vgvt.reconcile.search.screened import Screened
from vgvt.reconcile.search.shortlist import _swinging

SURGE = Hypothesis(available_effects()["suspension-surge"])
SOFT_ROOT = Hypothesis(available_effects()["root-compliance"], {"side": "both"})


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """The small scenario and its campaign."""
    return problem(tmp_path_factory.mktemp("cache"), 1)


def test_a_surge_is_tuned_by_the_springs_mass(case: Problem) -> None:
    """f = ½ sqrt(k/m), at the hook (Wahl, Mechanical Springs)."""
    found = tuned_to(case, SURGE, 9.0)
    assert found is not None
    spring = case.scenario.suspension
    assert found[0]["mass_kg"] == pytest.approx(spring.stiffness_n_per_m / (2 * 9.0) ** 2, rel=1e-6)
    assert found[1] == (spring.hook_m[:2],)


def test_nothing_swings_where_nothing_can(case: Problem) -> None:
    assert tuned_to(case, SURGE, 300.0) is None
    assert tuned_to(case, SOFT_ROOT, 9.0) is None
    assert tuned_to(case, Hypothesis(available_effects()["loose-sensor-mount"]), 30.0) is None


@pytest.mark.parametrize(
    ("away_m", "kind", "names"),
    [
        (0.1, "resonant", ["local-absorber", "suspension-surge"]),
        (0.5, "resonant", ["local-absorber"]),
        (0.1, "mass", []),
    ],
)
def test_it_is_offered_where_it_sits(case: Problem, away_m: float, kind: str, names: list[str]) -> None:
    """A placed effect goes to the place; a surge stays at its hook, and is asked for near there alone."""
    x, y, z = case.scenario.suspension.hook_m
    place: Any = SimpleNamespace(type=kind, position_m=(x + away_m, y, z), size=9.0)
    assert Place.__dataclass_fields__.keys() >= vars(place).keys()
    absorber = Hypothesis(available_effects()["local-absorber"], {"x_m": 0.5, "y_m": 0.5})
    screened = [Screened(h, {}, 1.0) for h in (SURGE, SURGE, absorber, SOFT_ROOT)]
    current: Any = SimpleNamespace(problem=case, u=np.zeros(3), e=np.zeros(0))
    found = _swinging(current, screened, place)
    assert [s.hypothesis.name for s in found] == names
    assert all(s.start is not None and not s.start.any() for s in found)
