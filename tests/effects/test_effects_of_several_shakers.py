"""Effects on a drive path with several shakers: on the one that is named, or on all."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt.effects import make_effect
from vgvt.effects.conformance import with_effect
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation.assembly import Plan, driven_rig, plans
from vgvt.simulation.state_space import StateSpace, state_space

ON_A_DRIVE_PATH: dict[str, dict[str, float]] = {
    "base-strain": {"rotational_stiffness_n_m_per_rad": 10.0},
    "drive-point-offset": {"dx_m": 0.02},
    "drive-remount": {"shift_x_m": 0.02, "from_run": 2},
    "lateral-force": {"angle_rad": 0.05},
    "mount-compliance": {"compliance_m_per_n": 1e-4},
    "mount-creep": {"compliance_m_per_n": 1e-4},
    "mount-lift-off": {"stiffness_loss": 0.5},
    "shaker-backlash": {"gap_m": 1e-4},
    "stinger-moment": {"rotational_stiffness_n_m_per_rad": 10.0},
}


@pytest.fixture(scope="module")
def two_shakers() -> Scenario:
    """Hati on two shakers at its body, in two runs, four links a wing."""
    whole = load_scenario("hati-two-shakers")
    wing = whole.airframe.beam[0].model_copy(update={"cells": 4})
    return whole.model_copy(
        update={
            "airframe": whole.airframe.model_copy(update={"beam": (wing,)}),
            "acquisition": whole.acquisition.model_copy(update={"runs": ((1, 10),), "repeats": 2}),
        }
    )


def last_plan(scenario: Scenario, name: str, **parameters: object) -> Plan:
    """The plan of the last run with one effect."""
    return plans(with_effect(scenario, make_effect(name, "test", **parameters)))[-1]


def driven(layout: Plan) -> StateSpace:
    return state_space(layout, driven_rig(layout, 1), layout.run_points(1))


def touched(layout: Plan, ideal: Plan) -> set[int]:
    """Numbers of the shakers whose own path is another than the ideal one's."""
    elements = {1 + element.exciter for _, element in layout.elements}  # type: ignore[union-attr]
    moved = {
        k + 1
        for k, (one, other) in enumerate(zip(layout.drives, ideal.drives, strict=True))
        if not (np.array_equal(one.axis, other.axis) and np.array_equal(one.position_m, other.position_m))
    }
    return elements | moved


@pytest.mark.parametrize("name", list(ON_A_DRIVE_PATH))
def test_it_acts_on_the_shaker_that_is_named_or_on_all(two_shakers: Scenario, name: str) -> None:
    ideal = plans(two_shakers)[-1]
    for shaker, wanted in ((0, {1, 2}), (1, {1}), (2, {2})):
        assert touched(last_plan(two_shakers, name, shaker=shaker, **ON_A_DRIVE_PATH[name]), ideal) == wanted


@pytest.mark.parametrize("name", list(ON_A_DRIVE_PATH))
def test_a_shaker_that_is_not_there_is_refused(two_shakers: Scenario, name: str) -> None:
    for scenario, number in ((two_shakers, 3), (two_shakers, -1), (load_scenario("spoiled-base"), 2)):
        with pytest.raises(InputError, match="shaker"):
            last_plan(scenario, name, shaker=number, **ON_A_DRIVE_PATH[name])


def test_every_effect_with_a_mount_or_a_drive_path_of_one_shaker_is_tried() -> None:
    from vgvt.effects import available_effects

    assert {n for n, cls in available_effects().items() if hasattr(cls, "shaker")} == set(ON_A_DRIVE_PATH)


def test_base_strain_is_read_by_its_own_gauge(two_shakers: Scenario) -> None:
    """The moment is the same wherever it is read; the other gauge reads what it reads without the strain."""
    held = {"shaker": 2, "rotational_stiffness_n_m_per_rad": 10.0}
    models = [
        driven(last_plan(two_shakers, "base-strain", apparent_force_per_moment_per_m=s, **held)) for s in (0.0, 10.0)
    ]
    without, with_it = (model.output_matrix[-2:] for model in models)
    np.testing.assert_allclose(with_it[0], without[0], rtol=1e-6, atol=1e-9 * np.abs(without[0]).max())
    assert np.abs(with_it[1] - without[1]).max() > 1.0


def test_a_soft_mount_filters_its_own_force_and_leaves_the_other(two_shakers: Scenario) -> None:
    """At 30 Hz, per volt of its own command: the second force changes by more than a tenth, the first by less."""

    def force_per_volt(layout: Plan) -> np.ndarray[tuple[int, ...], np.dtype[np.complex128]]:
        model = driven(layout)
        states = np.linalg.solve(2j * np.pi * 30.0 * np.eye(len(model.state_matrix)) - model.state_matrix, model.inputs)
        return np.asarray(np.diag((model.output_matrix @ states + model.feedthrough_rows)[-2:]))

    soft = force_per_volt(last_plan(two_shakers, "mount-compliance", shaker=2, compliance_m_per_n=2e-4))
    change = np.abs(soft / force_per_volt(plans(two_shakers)[-1]) - 1)
    assert change[1] > 0.1
    assert change[0] < 0.3 * change[1]
