"""First-order changes of A/F against differences of whole predictions, for what is added, edited, moved or weighed."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, problem, small_scenario

from vgvt.effects import available_effects, parameters_of
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.fitting.misfit import standardised
from vgvt.reconcile.prediction.first_order import FirstOrder
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.reconcile.search.stand import Stand

NOTHING = np.zeros(0)


@pytest.fixture(scope="module")
def null(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """The calibrated scenario."""
    return calibrate(problem(tmp_path_factory.mktemp("cache"), 1))


@pytest.fixture(scope="module", params=["at once", "roving"])
def case(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """All sensors at once, whose weight is the structure's; or four at a time, each run under its own load."""
    scenario = small_scenario()
    (nodes,) = scenario.acquisition.runs
    runs = (nodes,) if request.param == "at once" else tuple(nodes[k::5] for k in range(5))
    acquisition = scenario.acquisition.model_copy(update={"runs": runs})
    scenario = scenario.model_copy(update={"acquisition": acquisition})
    made = make_problem(campaign_of(scenario, 1), scenario, lines=200, cache=tmp_path_factory.mktemp("cache"))
    # Motions know nothing of how records end.
    return replace(made, measured=replace(made.measured, endings=()))


def differenced(case: Problem, name: str, settings: dict[str, Any], size: str, step: float) -> tuple[Any, Any]:
    """A change by the motions and by differences, extrapolated from two steps, at the scenario as stated."""
    stated = np.zeros(case.size)
    here = anchor(case, stated, slopes=False)

    def there(value: float) -> Any:
        cls = available_effects()[name]
        others = {p.name: getattr(cls(), p.name) for p in parameters_of(cls)}
        hypothesis = Hypothesis(cls, {**others, **settings, size: value})
        return anchor(case, stated, (hypothesis,), NOTHING, slopes=False, beside=here.assembled)

    motions = FirstOrder.of(here)
    assert motions is not None
    plain = here.mechanical(stated, NOTHING)
    near, twice = (there(k * step).mechanical(stated, NOTHING) - plain for k in (1, 2))
    return motions.change(there(step).assembled), (4 * near - twice) / 2


@pytest.mark.parametrize(
    ("name", "settings", "size", "step"),
    [
        ("added-mass", {"x_m": 0.9, "y_m": 1.1}, "mass_kg", 1e-3),
        ("local-absorber", {"x_m": 0.9, "y_m": 1.1, "frequency_hz": 12.0}, "mass_kg", 1e-4),
        ("roving-sensor-mass", {}, "mass_kg", 1e-4),
        ("stiffness-asymmetry", {"torsion": 0.0}, "bending", 1e-3),
        ("drive-point-offset", {"dy_m": 0.0}, "dx_m", 2e-4),
        ("suspension-damping", {}, "damping_n_s_per_m", 0.05),
        ("stinger-moment", {}, "rotational_stiffness_n_m_per_rad", 1e-3),
        ("suspension-stiffness", {}, "stiffness_change", 0.01),
        ("sensor-position-error", {"dy_m": 0.0}, "dx_m", 1e-3),
        # Held so stiffly that its own mode is far above all others: what it does is inertia on a flexibility.
        ("mount-compliance", {"loss_factor": 0.2}, "compliance_m_per_n", 2e-7),
    ],
)
def test_agrees_with_differences(case: Problem, name: str, settings: dict[str, Any], size: str, step: float) -> None:
    """Within what two steps leave of curvature: less than what the modes left out do, or a moved sensor's weight."""
    change, wanted = differenced(case, name, settings, size, step)
    assert np.linalg.norm(wanted) > 0
    assert np.linalg.norm(change - wanted) < 2e-3 * np.linalg.norm(wanted)


def test_nothing_changed_changes_nothing(null: Fit) -> None:
    here = anchor(null.problem, null.u, slopes=False)
    motions = FirstOrder.of(here)
    assert motions is not None
    change = motions.change(here.assembled)
    assert change is not None and not change.any()


def test_other_coordinates_are_no_small_change(null: Fit) -> None:
    here = anchor(null.problem, null.u, slopes=False)
    motions = FirstOrder.of(here)
    assert motions is not None
    group = here.assembled[0]
    fewer = replace(group, structure=replace(group.structure, joints=("other", *group.structure.joints[1:])))
    assert motions.change((fewer,)) is None


def test_a_filtered_channel_is_part_of_the_slope(null: Fit) -> None:
    """A gain error multiplies what the channel shows: the slope of one is the prediction itself."""
    stand = Stand.of(null)
    gain = Hypothesis(available_effects()["channel-gain"], {"channels": "response"})
    (size,) = gain.parameters
    slope = stand.slope(gain, {}, size)
    assert slope is not None
    problem_ = null.problem
    shown = standardised(problem_, null.predicted[problem_.split.train])
    wanted = np.sqrt(2) * np.concatenate([shown.real.ravel(), shown.imag.ravel()])
    assert np.linalg.norm(slope[: wanted.size] - wanted) < 0.05 * np.linalg.norm(wanted)


def test_what_a_scan_shares_is_not_taken_for_what_it_does_not(case: Problem) -> None:
    """Products of the last change are used again where a block is the same, and made anew where it is another."""
    stated = np.zeros(case.size)
    here = anchor(case, stated, slopes=False)
    kept = FirstOrder.of(here)
    assert kept is not None
    for mass_kg, place, frequency_hz in ((1e-4, 1.1, 9.0), (1e-4, 1.1, 12.0), (2e-4, 1.1, 12.0), (2e-4, -0.6, 12.0)):
        settings = {"x_m": 0.9, "y_m": place, "frequency_hz": frequency_hz, "mass_kg": mass_kg, "damping_ratio": 0.02}
        added = (Hypothesis(available_effects()["local-absorber"], settings),)
        there = anchor(case, stated, added, NOTHING, slopes=False, beside=here.assembled).assembled
        alone = FirstOrder.of(here)
        assert alone is not None
        found, wanted = kept.change(there), alone.change(there)
        assert found is not None and wanted is not None
        assert np.array_equal(found, wanted)
        assert np.abs(found).max() > 0
