"""Stiffness with a memory against its own law: Maxwell branches in the frequency domain, warming in time."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
import scipy.linalg
from hung_hati import UP, hung_hati, made, with_effect
from numpy.typing import NDArray

from vgvt.effects.elements import Relaxation
from vgvt.scenario import Scenario
from vgvt.simulation.assembly import bare_rig, plans
from vgvt.simulation.damping import RIGID_MODES
from vgvt.simulation.linear import LinearModel, joint_force, linearise, mass_matrix, stiffness_matrix
from vgvt.simulation.relaxation_elements import NODE_RATE_RAD_PER_S

FREQUENCY_HZ = np.linspace(2.0, 40.0, 1500)
OMEGA = 2 * np.pi * FREQUENCY_HZ


@pytest.fixture(scope="module")
def hati() -> Scenario:
    """Hati with four cells a wing: few enough modes that all of them can have branches."""
    whole = hung_hati()
    wing = whole.airframe.beam[0].model_copy(update={"cells": 4})
    return whole.model_copy(update={"airframe": whole.airframe.model_copy(update={"beam": (wing,)})})


def bare(scenario: Scenario) -> LinearModel:
    """The bare airframe, with the displacement of the drive point and of a tip."""
    layout = plans(scenario)[0]
    return linearise(
        bare_rig(layout).model, np.zeros(bare_rig(layout).model.nq), (("drive-point", UP), ("node-10", UP))
    )


def receptance(model: LinearModel, factor: NDArray[np.complex128] | float = 1.0) -> NDArray[np.complex128]:
    """Tip over drive point by direct solution, the stiffness times a complex factor a line."""
    s = 1j * OMEGA[:, None, None]
    rows, scale = model.displacement, np.broadcast_to(factor, OMEGA.shape)[:, None, None]
    dynamic = s**2 * model.mass + s * model.damping + scale * model.stiffness
    return np.asarray(rows[1] @ np.linalg.solve(dynamic, rows[0][None, :, None])[..., 0].T)


@pytest.mark.parametrize("coupling", [0.0, 0.2])
def test_branches_beside_every_mode_are_a_material_with_that_modulus(hati: Scenario, coupling: float) -> None:
    """K times 1 + Σ k jωτ/(1 + jωτ), solved line by line without any mode, is what the nodes make of it.

    That stiffness is all of it: also what a coupling adds that the scenario lists behind the material.
    """
    effect = made("viscoelastic-stiffness", rise=0.2, low_hz=1.0, high_hz=60.0)
    (element,) = effect.act(hati, 0).elements
    assert isinstance(element, Relaxation)
    s = 1j * OMEGA
    modulus = 1 + sum(share * s / (s + 2 * np.pi * corner) for share, corner in element.branches)
    spoiled = bare(
        with_effect(
            with_effect(hati, effect.name, rise=0.2, low_hz=1.0, high_hz=60.0),
            "bend-twist-coupling",
            coupling=coupling,
        )
    )
    hati = with_effect(hati, "bend-twist-coupling", coupling=coupling)
    wanted, got = receptance(bare(hati), modulus), receptance(spoiled)
    # A node's mass takes at most half of ω/p of a branch's share of the stiffness, over 2ζ at a resonance.
    loss = float(np.abs(modulus.imag / modulus.real).max())
    allowed = 0.5 * OMEGA[-1] / NODE_RATE_RAD_PER_S * element.branches[-1][0] / (2 * 0.011 + loss)
    assert np.abs(got - wanted).max() / np.abs(wanted).max() < allowed < 0.05
    plain = receptance(bare(hati))
    assert np.abs(plain - wanted).max() / np.abs(plain).max() > 0.5


def test_a_material_at_rest_has_its_stated_stiffness(hati: Scenario) -> None:
    """Condensed statically, nodes leave the stiffness matrix as it was."""
    effect = with_effect(hati, "viscoelastic-stiffness", rise=0.3)
    soft, plain = bare(effect), bare(hati)
    n = plain.freedoms
    k = soft.stiffness
    condensed = k[:n, :n] - k[:n, n:] @ np.linalg.solve(k[n:, n:], k[n:, :n])
    np.testing.assert_allclose(condensed, plain.stiffness, atol=1e-6 * np.abs(plain.stiffness).max())
    assert k.shape[0] > n + 3


def modal_law(element: Relaxation, ratio: NDArray[np.float64]) -> NDArray[np.complex128]:
    """What the branches of a mode add to its stiffness, over that, at multiples of its own frequency."""
    s = 1j * ratio
    return np.asarray(
        element.spring_share
        + element.dashpot_share * s
        + sum(share * s / (s + corner) for share, corner in element.branches)
    )


def test_hysteretic_branches_keep_their_loss_over_a_decade_and_a_half(hati: Scenario) -> None:
    """Loss within 15 % from a tenth of the mode's frequency to three times it; stiffness unmoved at the mode."""
    (element,) = made("hysteretic-damping", loss_factor=0.02).act(hati, 0).elements
    law = modal_law(element, np.geomspace(0.1, 3.0, 400))
    np.testing.assert_allclose(law.imag, 0.02, rtol=0.15)
    at_resonance = modal_law(element, np.array([1.0]))[0]
    assert at_resonance == pytest.approx(0.02j, abs=1e-12)
    # Causality: a constant loss factor stiffens with frequency, by (2/π) η a neper (Kramers and Kronig).
    slope = float(np.diff(modal_law(element, np.array([1 / 3, 3.0])).real)[0]) / np.log(9.0)
    assert slope == pytest.approx(2 / np.pi * 0.02, rel=0.25)


def test_the_kind_of_damping_is_hardly_identifiable(hati: Scenario) -> None:
    """η/2 more of viscous ratio instead: receptances differ by less than η/2 of the peak.

    Of one mode with complex stiffness it would be η/4: on the flanks, where ω differs by ζ, so does viscous damping.
    """
    eta = 0.01
    hysteretic = receptance(bare(with_effect(hati, "hysteretic-damping", loss_factor=eta)))
    damping = hati.airframe.damping
    more = damping.model_copy(
        update={
            "damping_ratio": damping.damping_ratio + eta / 2,
            "modal": tuple(ratio + eta / 2 for ratio in damping.modal),
        }
    )
    airframe = hati.airframe.model_copy(update={"damping": more})
    viscous = receptance(bare(hati.model_copy(update={"airframe": airframe})))
    plain = receptance(bare(hati))
    elastic = FREQUENCY_HZ > 5
    peak = np.abs(viscous[elastic]).max()
    assert np.abs(hysteretic - viscous)[elastic].max() / peak < eta / 2
    assert np.abs(plain - viscous)[elastic].max() / peak > 30 * eta


def test_warming_leaves_truth_and_rest_as_they_were(hati: Scenario) -> None:
    """At the start of a record the airframe is cold: linearised, nothing differs."""
    cold, plain = bare(with_effect(hati, "warm-up", softening=0.1)), bare(hati)
    for name in ("mass", "damping", "stiffness"):
        there, here = getattr(cold, name), getattr(plain, name)
        # To rounding: dampers that are zero at rest are more terms of the same sums.
        np.testing.assert_allclose(there, here, rtol=0, atol=1e-14 * np.abs(here).max())
    assert replace(cold, mass=plain.mass).freedoms == plain.freedoms


BESIDE_WARMTH: list[tuple[str, dict[str, object]]] = [
    ("bend-twist-coupling", {"coupling": 0.3}),
    ("bend-twist-coupling", {"coupling": -0.3, "side": "left"}),
    ("root-freeplay", {"gap_rad": 0.004}),
    ("root-freeplay", {"gap_rad": 0.004, "kind": "bending"}),
    ("carry-through-torsion", {"compliance_rad_per_n_m": 1e-3}),
    ("viscoelastic-stiffness", {"rise": 0.2}),
]
"""What else lays springs across the airframe's joints, or takes some of theirs."""


@pytest.mark.parametrize("softening", [0.1, -0.1])
@pytest.mark.parametrize("warm_first", [False, True])
@pytest.mark.parametrize(("name", "parameters"), BESIDE_WARMTH)
def test_every_spring_of_the_airframe_warms_up_alike(
    hati: Scenario, name: str, parameters: dict[str, object], warm_first: bool, softening: float
) -> None:
    """Fully warm, all torques at any shape and the squares of all frequencies are 1 - softening of the cold ones.

    Whichever table comes first. Joints are bent by far more than the gap of any play, to both sides.
    """
    warm: tuple[str, dict[str, object]] = ("warm-up", {"softening": softening})
    scenario = hati
    for effect, values in [warm, (name, parameters)] if warm_first else [(name, parameters), warm]:
        scenario = with_effect(scenario, effect, **values)
    model = bare_rig(plans(scenario)[0]).model
    bent = np.zeros(model.nq)
    bent[RIGID_MODES:] = 0.02 * np.random.default_rng(1).standard_normal(model.nq - RIGID_MODES)
    torques, squares = [], []
    for warmth in (0.0, 1.0):
        data = mujoco.MjData(model)
        data.act[:] = warmth
        mass, stiffness = mass_matrix(model, data), stiffness_matrix(model, data, np.zeros(model.nq))
        squares.append(scipy.linalg.eigh(stiffness, mass, eigvals_only=True))
        data.qpos[:] = bent
        torques.append(joint_force(model, data).copy())
    assert np.abs(torques[0]).max() > 0.1
    np.testing.assert_allclose(torques[1], (1 - softening) * torques[0], atol=1e-9 * np.abs(torques[0]).max())
    # Inside its gap a root that plays holds nothing, and some modes are rigid besides the six.
    elastic = squares[0] > (2 * np.pi * 1.0) ** 2
    assert np.count_nonzero(elastic) > 6
    np.testing.assert_allclose(squares[1][elastic], (1 - softening) * squares[0][elastic], rtol=1e-3)


def test_within_its_gap_a_warm_root_holds_as_little_as_a_cold_one(hati: Scenario) -> None:
    """What takes a stop's torque away begins at the stop: halfway there it would push the root over."""
    gap = 0.004
    scenario = with_effect(with_effect(hati, "root-freeplay", gap_rad=gap), "warm-up", softening=0.1)
    model = bare_rig(plans(scenario)[0]).model
    data = mujoco.MjData(model)
    data.act[:] = 1.0
    roots = [int(model.joint(f"wing-{side}-root/torsion").qposadr[0]) for side in ("right", "left")]
    for angle in (0.25 * gap, -0.25 * gap):
        data.qpos[roots] = angle
        np.testing.assert_allclose(joint_force(model, data), 0.0, atol=1e-12)
    data.qpos[roots] = gap
    assert np.abs(joint_force(model, data)).max() > 1.0
