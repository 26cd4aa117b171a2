"""A joint that is nearly rigid is as good as none: the aircraft is damped as without it, and can be stepped."""

from __future__ import annotations

import numpy as np
import pytest
from bare_poles import poles
from numpy.typing import NDArray
from small_rig import band_spectra

from vgvt.effects import available_effects
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.airframe import Airframe
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import simulated_campaign
from vgvt.simulation.assembly import driven_rig, plan
from vgvt.simulation.once import damping_once
from vgvt.simulation.state_space import state_space
from vgvt.simulation.stepping import amplification, substeps

DECADES = 10.0 ** np.arange(-9, -2)
JOINTED = [("quick", side, kind) for side in ("left", "both") for kind in ("bending", "torsion")]
JOINTED += [("hati-unsymmetric", "both", "bending")]


def jointed(name: str, side: str, **compliance: float) -> Airframe:
    """A bundled aircraft whose wing roots give way."""
    softer = available_effects()["root-compliance"](side=side, **compliance).act(load_scenario(name), 0).scenario
    assert softer is not None
    return softer.airframe


def ratios(found: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Damping ratios of the first ten."""
    return -found[:10].real / np.abs(found[:10])


@pytest.mark.parametrize(("name", "side", "kind"), JOINTED)
def test_damping_tends_to_that_of_a_rigid_root(name: str, side: str, kind: str) -> None:
    """Above the limit as below it, over seven decades: in proportion to the compliance."""
    rigid = ratios(poles(load_scenario(name).airframe))
    assert np.abs(rigid - load_scenario(name).airframe.damping.damping_ratio).max() > 0.02
    for compliance in DECADES:
        apart = np.abs(ratios(poles(jointed(name, side, **{kind: float(compliance)}))) / rigid - 1)
        # Rounding: a joint that swings at 5 MHz, a mode at 8 Hz.
        assert apart.max() < 10 * compliance + 1e-4


@pytest.mark.parametrize("compliance", [0.002, 0.02, 0.1])
def test_plausible_roots_keep_the_structure_s_damping(compliance: float) -> None:
    """The 46 Hz mode of an aircraft that is soft on both sides loses what its root takes of it, not most."""
    rigid, soft = (ratios(poles(a))[3] for a in (
        load_scenario("hati-unsymmetric").airframe, jointed("hati-unsymmetric", "both", bending=compliance)
    ))  # fmt: skip
    assert soft == pytest.approx(rigid, rel=0.05)


@pytest.mark.parametrize(("name", "side", "kind"), JOINTED)
def test_stiff_joints_swing_and_nothing_grows(name: str, side: str, kind: str) -> None:
    """A stiff joint's own motion is damped, and not so much that an explicit step has to be shorter for it."""
    for compliance in [*DECADES, 0.01, 0.1]:
        found = poles(jointed(name, side, **{kind: float(compliance)}))
        assert found.real.max() < 0
        fastest = found[-1]
        assert 0.4 < -fastest.real / abs(fastest) < 1.0
        rate = float(abs(fastest))
        count = substeps(found, rate / 10, 1.0)
        # An undamped motion needs 10 / 2.83 of them, one that is damped critically hardly more.
        assert count <= 4
        assert np.abs(amplification(found, 10 / rate / count)).max() <= 1.0


def test_an_aircraft_without_joints_has_one_law() -> None:
    for name in ("quick", "hati-unsymmetric"):
        airframe = load_scenario(name).airframe
        found = damping_once(airframe)
        assert (found.own_s == found.per_stiffness_s).all()
        omega = 2 * np.pi * found.natural_frequency_hz[: found.coefficients.size]
        given = np.full(omega.size, airframe.damping.damping_ratio)
        given[: len(airframe.damping.modal)] = airframe.damping.modal[: omega.size]
        np.testing.assert_allclose(found.coefficients, 2 * given * omega - found.per_stiffness_s * omega**2, atol=1e-12)


def test_ratios_below_the_limit_are_met_exactly_beside_a_stiff_joint() -> None:
    damping = load_scenario("quick").airframe.damping
    for compliance in (1e-6, 1e-3, 0.1):
        found = ratios(poles(jointed("quick", "both", bending=compliance)))
        np.testing.assert_allclose(found[: len(damping.modal)], damping.modal, rtol=1e-4)


def test_both_engines_answer_alike_with_a_stiff_root(small: Scenario) -> None:
    """MuJoCo steps a root a thousandth as soft as the wing, and finds what the exact solution finds."""
    table = EffectTable(name="root-compliance", bending=1e-3, side="left")
    excitation = small.excitation.model_copy(update={"duration_s": 2.0, "ring_down_s": 2.0})
    soft = small.model_copy(update={"effect": (table,), "excitation": excitation})
    layout = plan(soft)
    found = np.linalg.eigvals(state_space(layout, driven_rig(layout, 0), layout.points).state_matrix)
    assert 2 * np.pi * 2e3 < np.abs(found).max()
    assert substeps(found, 1000.0, soft.simulation.step_s) < 40
    stepped, solved = (band_spectra(simulated_campaign(soft, engine=e).runs[0]) for e in ("mujoco", "linear"))
    for response in (2, 3):
        wanted, got = solved[response] / solved[1], stepped[response] / stepped[1]
        clear = np.abs(wanted) > 0.05 * np.median(np.abs(wanted))
        assert np.abs(got / wanted - 1)[clear].max() < 0.005
