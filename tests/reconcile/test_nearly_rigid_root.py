"""A root that is nearly rigid is as good as rigid to the loop; from there what is seen grows like its compliance."""

from __future__ import annotations

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.next_test.at_size import Sight, least
from vgvt.reconcile.next_test.power import power
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import noise_share
from vgvt.reconcile.search.stand import Stand


@pytest.fixture(scope="module")
def stated(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """The scenario as stated."""
    case = problem(tmp_path_factory.mktemp("cache"), 1)
    return fit(case, (), np.zeros(case.size), np.zeros(0), ())


def softer(**settings: object) -> Hypothesis:
    return Hypothesis(available_effects()["root-compliance"], settings)


@pytest.mark.parametrize("settings", [{"side": "left", "torsion": 0.0}, {"side": "both", "torsion": 0.0}])
def test_what_shows_of_a_root_tends_to_nothing_with_its_compliance(stated: Fit, settings: dict[str, object]) -> None:
    """At ten millionths of the plausible it does what the slope says: there is no step at no size."""
    stand, hypothesis = Stand.of(stated), softer(**settings)
    slope = stand.slope(hypothesis, {"bending": 0.0}, hypothesis.parameters[0])
    assert slope is not None
    for compliance in (1e-7, 1e-6, 1e-5):
        change = stand.change(hypothesis, {"bending": compliance})
        assert change is not None
        # A joint 1/compliance times as stiff as the whole beam takes as many digits from doubles, and what is left of
        # them hangs on the machine: 0.2e-9 to 2.7e-9 deviations by that, from compliances of 1e-9 to 1e-7.
        rounding = 3e-9 / compliance
        assert np.linalg.norm(change - compliance * slope) < 0.012 * compliance * np.linalg.norm(slope) + rounding


@pytest.mark.parametrize("kind", ["bending", "torsion"])
def test_a_root_of_the_size_that_is_just_visible_shows_by_five_deviations(stated: Fit, kind: str) -> None:
    """The unknowns follow, free of noise: what they leave is what was promised, there and at the size of a name."""
    other = {"bending": "torsion", "torsion": "bending"}[kind]
    hypothesis = softer(side="left", **{other: 0.0})
    (found,) = power(stated, [hypothesis])
    stand = Stand.of(stated)
    sight = Sight.of(stand, noise_share(stated.problem.measured, stated.problem.split.train).worth)
    for size in (found.smallest, found.named):
        shown = stand.shown(hypothesis, {kind: size}, {kind: 0.0})
        assert shown is not None
        assert least(sight.views(shown, shown)) == pytest.approx(5.0 * size / found.smallest, rel=0.12)
    assert found.reason == ""


def test_what_the_unknowns_could_make_up_for_is_not_seen(stated: Fit) -> None:
    """A mass on the body bends the frequencies as stiffness does: a straight tangent takes the bend for something."""
    mass = Hypothesis(available_effects()["added-mass"], {"x_m": 0.0426, "y_m": 0.0})
    (found,) = power(stated, [mass])
    stand, values = Stand.of(stated), {"mass_kg": found.named}
    change, shown = stand.change(mass, values), stand.shown(mass, values, {"mass_kg": 0.0})
    assert change is not None
    assert shown is not None
    seen = np.linalg.norm(stand.projected(change))
    assert seen > 2 * np.linalg.norm(shown)
    sight = Sight.of(stand, noise_share(stated.problem.measured, stated.problem.split.train).worth)
    assert least(sight.views(shown, shown)) == pytest.approx(5.0 * found.named / found.smallest, rel=0.12)
