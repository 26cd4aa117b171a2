"""What a fit assembles without a time engine is the rig that the simulator drives, whatever effects hang on it."""

from __future__ import annotations

import numpy as np
import pytest
from effect_rig import accelerance, effect_rig, largest_error, responses
from hung_hati import with_effect

from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import simulated_campaign
from vgvt.simulation.assembly import plans
from vgvt.simulation.attached import attach
from vgvt.simulation.effect_conformance import ENGINES_AGREE, example_scenario
from vgvt.simulation.reduced import Structure, structure

AGREE = 1e-5
"""Stiffnesses are differences of forces on both sides, which leaves 4e-6 of a response without any effect."""
SURGE: tuple[str, dict[str, object]] = ("suspension-surge", {"mass_kg": 0.4})
FRAME: tuple[str, dict[str, object]] = ("frame-resonance", {"compliance_m_per_n": 2e-4, "frequency_hz": 9.0})


def on_top(scenario: Scenario, *effects: tuple[str, dict[str, object]]) -> Scenario:
    for name, parameters in effects:
        scenario = with_effect(scenario, name, **parameters)
    return scenario


def assembled(scenario: Scenario) -> Structure:
    """The structure of the first run with rows for its sensors."""
    layout = plans(scenario)[0]
    return structure(layout, layout.run_points(0))


def weightless_bff() -> Scenario:
    """BFF with sensors that weigh nothing, as the structure leaves them out."""
    whole = load_scenario("bff")
    return whole.model_copy(update={"accelerometers": whole.accelerometers.model_copy(update={"mass_kg": 0.0})})


@pytest.mark.parametrize("effects", [(SURGE, FRAME), (FRAME, SURGE)], ids=["surge first", "frame first"])
def test_a_surging_spring_on_a_frame_is_that_of_the_driven_rig(
    effects: tuple[tuple[str, dict[str, object]], ...],
) -> None:
    rig = effect_rig()
    wanted = responses(on_top(rig, *effects))[0][:-1]
    assert largest_error(accelerance(assembled(on_top(rig, *effects))), wanted) < AGREE
    for alone in effects:
        assert largest_error(responses(on_top(rig, alone))[0][:-1], wanted) > 0.1


def test_a_surge_beside_a_known_frame_is_what_assembling_gives() -> None:
    """What a scan adds by rows alone: between frame and surges exactly, on the aircraft but for their weight."""
    rig = effect_rig()
    framed, both = (plans(on_top(rig, *effects))[0] for effects in ((FRAME,), (FRAME, SURGE)))
    base = structure(framed, framed.run_points(0))
    beside = attach(base, framed, [(name, e) for name, e in both.elements if name.startswith("effect-1-")])
    assert beside is not None
    wanted = structure(both, both.run_points(0)).onto(beside.joints)
    own = np.flatnonzero([name.startswith("effect-") for name in beside.joints])
    assert own.size == 7
    for name in ("mass", "damping", "stiffness"):
        got, there = (getattr(s, name)[np.ix_(own, own)] for s in (beside, wanted))
        np.testing.assert_allclose(got, there, atol=1e-6, err_msg=name)
    # The aircraft's attitude is that without the spring's weight, to which its sharp modes are sensitive.
    assert largest_error(accelerance(beside), accelerance(wanted)) < 0.1
    assert largest_error(accelerance(base), accelerance(wanted)) > 1.0


@pytest.mark.parametrize("y_m", [0.6, -1.07])
def test_a_payload_beside_a_known_aircraft_is_shared_as_assembling_shares_it(y_m: float) -> None:
    """By the two links around it, to a thousandth of what it adds: the rest is what its weight bends."""
    scenario = example_scenario()
    payload: tuple[str, dict[str, object]] = ("payload-change", {"mass_kg": 0.02, "x_m": 0.75, "y_m": y_m})
    plain, laden = (plans(s)[1] for s in (scenario, on_top(scenario, payload)))
    base, wanted = (structure(layout, layout.run_points(1)) for layout in (plain, laden))
    beside = attach(base, plain, laden.elements)
    assert beside is not None
    added = wanted.mass - base.mass
    assert np.abs(beside.mass - wanted.mass).max() < 1e-2 * np.abs(added).max()


def test_a_mass_is_added_without_a_square_that_only_rotations_ask_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """A scan attaches thousands of masses and springs: what it does not need must not cost it an aircraft squared."""
    rig = effect_rig()
    plain, laden = (plans(s)[0] for s in (rig, with_effect(rig, "payload-change", mass_kg=0.02, x_m=0.75, y_m=0.6)))
    base = structure(plain, plain.run_points(0))

    def no_square(size: int) -> None:
        raise AssertionError(f"a square of {size}")

    monkeypatch.setattr("vgvt.simulation.attached.np.eye", no_square)
    assert attach(base, plain, laden.elements) is not None


def test_a_surging_spring_on_a_frame_looks_the_same_to_both_engines() -> None:
    """Stepped in time it is what the linear model says, and not what either effect alone would be."""
    scenario = on_top(example_scenario(), SURGE, FRAME)
    stepped, solved = (simulated_campaign(scenario, engine=engine).runs[0].samples for engine in ("mujoco", "linear"))
    alone = simulated_campaign(on_top(example_scenario(), SURGE), engine="linear").runs[0].samples
    for got, wanted, other in zip(stepped[1:], solved[1:], alone[1:], strict=True):
        assert np.linalg.norm(got - wanted) < ENGINES_AGREE * np.linalg.norm(wanted)
        assert np.linalg.norm(other - wanted) > 2 * ENGINES_AGREE * np.linalg.norm(wanted)


def test_a_bundle_of_cables_holds_nothing_up() -> None:
    """BFF hangs as without it, and is driven as the fit says."""
    plain, tied = weightless_bff(), with_effect(weightless_bff(), "cable-bundle", stiffness_n_per_m=100.0)
    hung, with_bundle = assembled(plain), assembled(tied)
    np.testing.assert_allclose(with_bundle.equilibrium, hung.equilibrium, atol=1e-6)
    wanted = responses(tied)[0][:-1]
    assert largest_error(accelerance(with_bundle), wanted) < AGREE
    assert largest_error(accelerance(hung), wanted) > 0.1
