"""The hammer: both engines, reciprocity, nothing left of the shaker, and the shaker's frequency responses."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import ValidationError
from small_rig import revised

from vgvt.data import InputError
from vgvt.scenario import Hammer, Scenario
from vgvt.scenario.effect import EffectTable
from vgvt.signals import estimate_frf
from vgvt.simulation import simulated_campaign, truth_of
from vgvt.simulation.assembly import driven_rig, hung_rig, plans, rigid_body
from vgvt.simulation.state_space import state_space

FREQUENCY_HZ = np.linspace(4.0, 34.0, 31)
HAMMER = Hammer(
    head_mass_kg=0.15, tip_mass_kg=0.01, tip_stiffness_n_per_m=24e3, peak_force_n=5.0, sensitivity_v_per_n=0.01
)


def struck(small: Scenario, nodes: tuple[int, ...] = (), **settings: object) -> Scenario:
    """The small rig with a hammer: weightless sensors on nodes 1 and 10 in each of as many runs as nodes."""
    runs = ((1, 10),) * max(len(nodes), 1)
    scenario = revised(
        small,
        acquisition={"runs": runs},
        accelerometers={"mass_kg": 0.0},
        excitation={"kind": "impact", "blocks": 2, "duration_s": 3.0, "ring_down_s": 0.0, "taper_s": 0.0},
    )
    return scenario.model_copy(update={"hammer": HAMMER.model_copy(update={"nodes": nodes, **settings})})


def responses(scenario: Scenario, run: int = 0) -> NDArray[np.complex128]:
    """Accelerations over measured force (points, lines) of the linear model."""
    layout = plans(scenario)[run]
    model = state_space(layout, driven_rig(layout, run), layout.run_points(run))
    identity = np.eye(model.state_matrix.shape[0])
    states = [np.linalg.solve(2j * np.pi * f * identity - model.state_matrix, model.inputs[:, 0]) for f in FREQUENCY_HZ]
    outputs = model.output_matrix @ np.array(states).T + model.feedthrough_rows[:, :1]
    return np.asarray(outputs[:-1] / outputs[-1])


def test_both_engines_answer_a_hit_alike(small: Scenario) -> None:
    scenario = struck(small, strength_scatter=0.1, timing_scatter_s=0.02)
    stepped, solved = (simulated_campaign(scenario, engine=engine).runs[0] for engine in ("mujoco", "linear"))
    assert [c.name for c in solved.channels] == ["force", "acceleration 1+Z", "acceleration 10+Z"]
    assert str(solved.channels[0].dof) == "100-Z"
    np.testing.assert_allclose(stepped.samples[0], solved.samples[0], atol=1e-6 * solved.samples[0].max())
    for channel in (1, 2):
        difference = stepped.samples[channel] - solved.samples[channel]
        # In the band of the test; a hit also rings the chain's high modes, which steps and exact solution date apart.
        spectrum, wanted = np.fft.rfft(difference), np.fft.rfft(solved.samples[channel])
        frequency = np.fft.rfftfreq(difference.size, 1 / solved.sample_rate_hz)
        band = (frequency > 3) & (frequency < 35)
        assert np.linalg.norm(spectrum[band]) < 0.01 * np.linalg.norm(wanted[band])


def test_hit_here_and_felt_there_is_hit_there_and_felt_here(small: Scenario) -> None:
    """Maxwell: weightless sensors on 1 and 10, hammer on 1, then on 10. Gravity's tilt is common to both."""
    scenario = struck(small, nodes=(1, 10))
    at_1, at_10 = responses(scenario, 0), responses(scenario, 1)
    assert np.abs(at_1[1] / at_10[0] - 1).max() < 5e-3


def test_the_shaker_is_off_the_aircraft(small: Scenario) -> None:
    heavy = revised(struck(small), transducer={"mass_kg": 0.5, "end_mass_kg": 0.3}, stinger={"mass_kg": 0.2})
    layout = plans(heavy)[0]
    rig = driven_rig(layout, 0)
    bare = truth_of(heavy).rigid_body.mass_kg
    assert rigid_body(rig).mass_kg == pytest.approx(bare, rel=1e-9)
    assert rig.model.nq == hung_rig(layout, 0).model.nq
    assert (rig.model.nu, rig.model.ntendon) == (1, hung_rig(layout, 0).model.ntendon)


def test_hammer_and_shaker_agree_on_the_aircraft(small: Scenario) -> None:
    """With instruments without mass, what the gauge under the shaker divides by is the hammer's force, sign turned."""
    light = {"mass_kg": 0.0}
    shaken = revised(small, accelerometers=light, transducer=light | {"end_mass_kg": 0.0}, stinger=light)
    np.testing.assert_allclose(responses(struck(shaken)), -responses(shaken), rtol=1e-6)


def test_a_gauge_behind_a_tip_misses_its_inertia(small: Scenario) -> None:
    true, seen = (
        simulated_campaign(struck(small, calibrated=c), engine="linear").runs[0].samples for c in (True, False)
    )
    np.testing.assert_allclose(seen[1:], true[1:], atol=1e-9)
    assert seen[0].max() / true[0].max() == pytest.approx(0.15 / 0.16, rel=1e-6)


def test_the_estimate_over_hits_is_the_frequency_response(small: Scenario) -> None:
    """Hits in a record long enough for the modes of the band, read without noise."""
    scenario = revised(struck(small), excitation={"duration_s": 80.0})
    frf = estimate_frf(simulated_campaign(scenario, engine="linear"), "auto", band_hz=(4.0, 34.0))
    nearest = [int(np.argmin(np.abs(frf.frequency_hz - f))) for f in FREQUENCY_HZ]
    wanted = np.array([np.interp(frf.frequency_hz[nearest], FREQUENCY_HZ, w) for w in responses(scenario)])
    # Interpolated between lines 1 Hz apart where it bends little; half of the lines are that smooth.
    assert np.median(np.abs(frf.values[:, 0, nearest] / wanted - 1)) < 0.02


def test_truth_keeps_one_reference_and_bounds_every_run(small: Scenario) -> None:
    noisy = revised(struck(small, nodes=(1, 10)), acquisition={"noise_v_per_rthz": 1e-6, "bits": 24})
    truth = truth_of(noisy)
    assert {m.references for m in truth.as_tested} == {truth.bare.references}
    for modes in truth.as_tested:
        assert modes.natural_frequency_std_hz is not None
        inside = (modes.natural_frequency_hz > 4) & (modes.natural_frequency_hz < 35)
        assert np.isfinite(modes.natural_frequency_std_hz[inside]).any()


@pytest.mark.parametrize(
    ("hammer", "words"),
    [
        (None, "hammer is missing"),
        (HAMMER.model_copy(update={"tip_stiffness_n_per_m": 1e7}), "softer tip"),
        (HAMMER.model_copy(update={"nodes": (1, 2)}), "acquisition.runs has 1"),
        (HAMMER.model_copy(update={"nodes": (999,)}), "names node 999"),
        (HAMMER.model_copy(update={"timing_scatter_s": 1.0}), "for each hit"),
    ],
)
def test_a_hammer_that_does_not_fit_is_refused(small: Scenario, hammer: Hammer | None, words: str) -> None:
    tables = struck(small).model_dump()
    tables["hammer"] = hammer.model_dump() if hammer else None
    with pytest.raises(ValidationError, match=words):
        Scenario.model_validate(tables)


@pytest.mark.parametrize(
    ("name", "parameter", "value"),
    [
        ("mount-compliance", "compliance_m_per_n", 1e-4),
        ("stinger-compliance", "compliance_m_per_n", 1e-5),
        ("stinger-moment", "rotational_stiffness_n_m_per_rad", 3.0),
        ("transducer-mass", "mass_kg", 0.02),
        ("force-distortion", "second_harmonic", 0.05),
    ],
)
def test_an_effect_of_what_the_hammer_does_not_have_is_refused(
    small: Scenario, name: str, parameter: str, value: float
) -> None:
    table = EffectTable.model_validate({"name": name, parameter: value})
    with pytest.raises(InputError, match=f"{name}: acts on the shaker.* hammer"):
        plans(struck(small).model_copy(update={"effect": (table,)}))


def test_a_hammer_that_misses_its_point_is_an_effect_unless_it_roves(small: Scenario) -> None:
    beside = EffectTable.model_validate({"name": "drive-point-offset", "dx_m": 0.02})
    right, wrong = (plans(struck(small).model_copy(update={"effect": e}))[0].strike for e in ((), (beside,)))
    assert right is not None
    assert wrong is not None
    np.testing.assert_allclose(wrong.position_m - right.position_m, [0.02, 0.0, 0.0], atol=1e-12)
    with pytest.raises(InputError, match="hammer"):
        plans(struck(small, nodes=(1,)).model_copy(update={"effect": (beside,)}))
