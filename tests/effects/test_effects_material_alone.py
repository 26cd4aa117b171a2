"""A material's memory is the wing's alone: what is bolted on, or ties two places together, keeps its own springs."""

from __future__ import annotations

import numpy as np
import pytest
from hung_hati import UP, made, mode, with_effect

from vgvt.effects.elements import Relaxation
from vgvt.scenario import Scenario
from vgvt.simulation import truth_of
from vgvt.simulation.assembly import bare_rig, plans
from vgvt.simulation.effect_conformance import example_scenario
from vgvt.simulation.linear import LinearModel, linearise
from vgvt.simulation.relaxation_elements import NODE_RATE_RAD_PER_S

FREQUENCY_HZ = np.linspace(2.0, 70.0, 1500)
BOLTED_ON: dict[str, tuple[str, dict[str, object]]] = {
    "absorber": ("local-absorber", {"mass_kg": 0.03, "frequency_hz": 20.0, "damping_ratio": 0.01}),
    "rattle": ("rattling-mass", {"mass_kg": 0.02, "contact_hz": 30.0}),
    "flap": ("control-surface", {"compliance_rad_per_n_m": 20.0}),
    "bundle": ("cable-bundle", {"stiffness_n_per_m": 3000.0, "damping_n_s_per_m": 0.1}),
}
"""What has a spring that is no wing material."""


def hung_on(kind: str, **where: float) -> Scenario:
    name, values = BOLTED_ON[kind]
    return with_effect(example_scenario(), name, **{**values, **where})


def bare(scenario: Scenario) -> LinearModel:
    """The bare airframe, with the displacement of the drive point and of a tip."""
    model = bare_rig(plans(scenario)[0]).model
    return linearise(model, np.zeros(model.nq), (("drive-point", UP), ("node-10", UP)))


def wing_stiffness(scenario: Scenario) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Stiffness (nv, nv) of the hinges that the beams were cut at, and of nothing else."""
    layout = plans(scenario)[0]
    model = bare_rig(layout).model
    stiffness = np.zeros(model.nv)
    for link in (link for chain in layout.parts.chains.values() for link in chain.links):
        for hinge in link.hinges:
            stiffness[model.joint(f"{link.name}/{hinge.kind}").dofadr[0]] = hinge.stiffness_n_m_per_rad
    return np.diag(stiffness)


@pytest.mark.parametrize("kind", BOLTED_ON)
def test_only_the_hinges_of_the_wings_relax(kind: str) -> None:
    """K + (modulus - 1) Kw, solved line by line without any mode, is what the nodes make of it."""
    size: dict[str, float] = {"rise": 0.3, "low_hz": 1.0, "high_hz": 60.0}
    outboard: dict[str, float] = {"x_m": 0.9, "y_m": 1.2} if kind in ("absorber", "rattle") else {}
    scenario = hung_on(kind, **outboard)
    (element,) = made("viscoelastic-stiffness", **size).act(scenario, 0).elements
    assert isinstance(element, Relaxation)
    # All modes of four cells a wing have branches then, and the sum is the material itself.
    excitation = scenario.excitation.model_copy(update={"stop_hz": 400.0})
    scenario = scenario.model_copy(update={"excitation": excitation})
    s = 2j * np.pi * FREQUENCY_HZ[:, None, None]
    gained = sum(share * s / (s + 2 * np.pi * corner) for share, corner in element.branches)
    plain, relaxed = bare(scenario), bare(with_effect(scenario, "viscoelastic-stiffness", **size))
    law = plain.stiffness + gained * wing_stiffness(scenario)
    wanted, got = (
        m.displacement @ np.linalg.solve(s**2 * m.mass + s * m.damping + stiffness, m.displacement.T[None])
        for m, stiffness in ((plain, law), (relaxed, relaxed.stiffness))
    )
    # A node's mass takes at most half of ω/p of a branch's share of the stiffness, over 2ζ at a resonance.
    loss = float(np.abs(gained.imag / (1 + gained.real)).max())
    allowed = np.pi * FREQUENCY_HZ[-1] / NODE_RATE_RAD_PER_S * element.branches[-1][0] / (2 * 0.011 + loss)
    assert np.abs(got - wanted).max() / np.abs(wanted).max() < allowed < 0.05


@pytest.mark.parametrize(("kind", "label"), [("absorber", "1st absorber"), ("rattle", "1st rattle")])
@pytest.mark.parametrize(
    ("material", "size"), [("viscoelastic-stiffness", {"rise": 0.3}), ("hysteretic-damping", {"loss_factor": 0.06})]
)
def test_an_absorber_keeps_its_frequency_and_damping(
    kind: str, label: str, material: str, size: dict[str, float]
) -> None:
    """On the body it still resonates where it did: 20.07 Hz and 1.00 % had become 21.9 Hz, or 4.14 %."""
    alone = hung_on(kind, x_m=0.45, y_m=0.0)
    relaxed = with_effect(alone, material, **size)
    (frequency, damping), (got, damped) = (mode(truth_of(scenario).bare, label) for scenario in (alone, relaxed))
    assert got == pytest.approx(frequency, rel=5e-3)
    assert damped == pytest.approx(damping, abs=2e-3)
