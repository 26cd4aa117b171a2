"""Where a screen begins: what resonates is scanned over the band, what acts either way is begun either way."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, drawn_scores, problem, small_scenario

from vgvt.effects.base_strain import BaseStrain
from vgvt.effects.control_surface import ControlSurface
from vgvt.effects.lateral_force import LateralForce
from vgvt.effects.sensor_tilt import SensorTilt
from vgvt.reconcile import reconcile
from vgvt.reconcile.decision.kinds import Kind
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search import scan
from vgvt.reconcile.search.candidates import candidates
from vgvt.reconcile.search.scan import scan_of
from vgvt.reconcile.search.screen import at_sizes
from vgvt.reconcile.search.stand import Stand

FLAP: dict[str, Any] = {"item": "winglet", "side": "both"}


def all_else_known(folder: Path, effect: Any) -> Fit:
    """The scenario with all that was drawn from its tolerances, against a campaign with an effect besides."""
    case = problem(folder, 1, effect)
    return fit(case, (), drawn_scores(case, 1), np.zeros(0), ())


def flap_hz(item: Any, compliance: float, arm: float) -> float:
    """Of a flap on a fixed wing; its own inertia about a spanwise hinge is Iyy, or nearly."""
    return math.sqrt(1 / (compliance * (item.mass_kg * arm**2 + item.inertia_kg_m2[1]))) / (2 * math.pi)


@pytest.mark.slow
def test_a_loose_flap_is_named(tmp_path: Path) -> None:
    """The slope of a rigid hinge says nothing of one that lets a winglet resonate in the band: hinges are tried."""
    scenario = small_scenario()
    campaign = campaign_of(scenario, 1, ControlSurface(compliance_rad_per_n_m=2.0, damping_ratio=0.02, **FLAP))
    verdict = reconcile(campaign, scenario, effects={"control-surface": ControlSurface}, lines=200)
    assert [e.name for e in verdict.effects] == ["control-surface"]
    assert verdict.effects[0].parameters["compliance_rad_per_n_m"][0] == pytest.approx(2.0, rel=0.1)
    assert verdict.kind is Kind.EXPLAINED


def test_where_the_stiffest_hinge_ends_the_scan_goes_on_with_the_arm(tmp_path: Path) -> None:
    """To the end of the band, in steps no wider than the resonance is taken to be, to both sides."""
    null = all_else_known(tmp_path, ControlSurface(compliance_rad_per_n_m=2.0, **FLAP))
    variants = candidates(null.problem, {"control-surface": ControlSurface})
    (hypothesis,) = (h for h in variants if h.settings == {"item": "flap-outer", "side": "right"})
    (item,) = (i for i in null.problem.scenario.airframe.item if i.name == "flap-outer")
    found = scan_of(null.problem, hypothesis)
    (damping,) = {s["damping_ratio"] for s in found.starts}
    hz = sorted(flap_hz(item, s[found.tuned], s["arm_m"]) for s in found.starts)
    stiffest = flap_hz(item, 1.0, ControlSurface().arm_m)
    band = null.problem.measured.frequency_hz
    assert stiffest < band[-1], "the arm must be needed in this test"
    assert hz[0] < 1.1 * band[0] and hz[-1] == pytest.approx(1.15 * band[-1], rel=0.05)
    assert np.diff(np.log(hz)).max() < 2 * damping
    assert all(s["arm_m"] == ControlSurface().arm_m or s[found.tuned] in (1.0, 100.0) for s in found.starts)


@pytest.mark.parametrize(
    ("effect", "settings", "either_way"),
    [
        (BaseStrain(-10.0, 3.0, axis="pitch"), {"axis": "pitch"}, "apparent_force_per_moment_per_m"),
        (SensorTilt(angle_rad=0.3, azimuth_rad=2.6, sensors="6+Z"), {"sensors": "6+Z"}, "azimuth_rad"),
    ],
    ids=["base-strain", "sensor-tilt"],
)
def test_what_acts_the_opposite_way_is_met(
    tmp_path: Path, effect: Any, settings: dict[str, str], either_way: str
) -> None:
    """Sizes are never negative: begun at one sign or azimuth alone, half of all that there can be promises nothing.

    By quarter turns the nearest azimuth is 31 degrees off.
    """
    stand = Stand.of(all_else_known(tmp_path, effect))
    told = {**settings, either_way: getattr(effect, either_way)}
    known, best = (at_sizes(stand, Hypothesis(type(effect), s))[0].gain_nats for s in (told, settings))
    assert best > 0.4 * known > 4.0


def test_an_angle_is_begun_by_quarter_turns(tmp_path: Path) -> None:
    """Within its range, the default first."""
    case = problem(tmp_path, 1)
    (hypothesis,) = candidates(case, {"lateral-force": LateralForce})
    turns = [s["azimuth_rad"] / (math.pi / 2) for s in scan_of(case, hypothesis).starts]
    assert turns == pytest.approx([1.0, 2.0, -1.0, 0.0])


def test_an_angle_of_a_small_range_leans_to_either_side() -> None:
    """A quarter of a turn would be far outside it."""
    lean = SimpleNamespace(name="lean_rad", neutral=None, low=-0.2, high=0.2, unit="rad")
    assert scan._turned(SimpleNamespace(parameters=(lean,)), {"lean_rad": 0.1}) == [  # type: ignore[arg-type]
        {"lean_rad": 0.1}, {"lean_rad": -0.1},
    ]  # fmt: skip


def test_values_that_an_effect_refuses_have_no_resonance_to_go_on_from(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As a user's own effect may: the scan goes as far as there is one."""
    case = problem(tmp_path, 1)
    (hypothesis,) = (
        h for h in candidates(case, {"control-surface": ControlSurface})
        if h.settings == {"item": "flap-outer", "side": "right"}
    )  # fmt: skip
    known = scan._resonance

    def refusing(problem: Any, asked: Any, values: dict[str, float]) -> tuple[float, float]:
        return (0.0, 0.0) if values.get("arm_m", 1.0) < 0.02 else known(problem, asked, values)

    monkeypatch.setattr(scan, "_resonance", refusing)
    found = scan_of(case, hypothesis)
    assert found.tuned == "compliance_rad_per_n_m"
    assert {s["arm_m"] for s in found.starts if s["compliance_rad_per_n_m"] == 1.0} == {ControlSurface().arm_m}
