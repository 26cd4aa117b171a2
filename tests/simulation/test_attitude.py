"""How the aircraft hangs, against statics: the centre of gravity of a rigid one comes to rest below the hook."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.effect import EffectTable
from vgvt.scenario.mass import rigid_body_properties
from vgvt.simulation.attitude import attitudes_deg

MASS_KG = 0.05


def stiff() -> Scenario:
    """The small scenario with wings that hardly droop, and without what is hung on them for the test."""
    quick = load_scenario("quick")

    def harder(columns: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(1e4 * value for value in columns)

    beams = tuple(
        b.model_copy(
            update={
                "stations": b.stations.model_copy(
                    update={
                        "bending_stiffness_n_m2": harder(b.stations.bending_stiffness_n_m2),
                        "torsional_stiffness_n_m2": harder(b.stations.torsional_stiffness_n_m2),
                    }
                )
            }
        )
        for b in quick.airframe.beam
    )
    return quick.model_copy(
        update={
            "airframe": quick.airframe.model_copy(update={"beam": beams}),
            "accelerometers": quick.accelerometers.model_copy(update={"mass_kg": 0.0}),
        }
    )


def hung_with(mass_kg: float, x_m: float, y_m: float) -> tuple[float, float]:
    """Roll and pitch, degrees, with a mass at a point of the wing."""
    table = EffectTable.model_validate({"name": "added-mass", "mass_kg": mass_kg, "x_m": x_m, "y_m": y_m})
    ((roll, pitch),) = attitudes_deg(stiff().model_copy(update={"effect": (table,)}))
    return roll, pitch


def by_statics(scenario: Scenario, mass_kg: float, at_m: np.ndarray) -> tuple[float, float]:
    """Roll (left wing down is positive) and pitch (nose up is positive), degrees, of the rigid aircraft."""
    body, drive = rigid_body_properties(scenario.airframe), np.array(scenario.shaker.position_m)
    carried = scenario.transducer.mass_kg + 0.5 * scenario.stinger.mass_kg
    hook = np.array(scenario.suspension.hook_m)
    moments = body.mass_kg * (body.centre_of_gravity_m - hook) + carried * (drive - hook) + mass_kg * (at_m - hook)
    aft, right, below = moments[0], moments[1], -moments[2]
    # The line from hook to centre of gravity turns into the vertical.
    pitch = np.arctan2(aft, below)
    roll = np.arctan2(-right, np.hypot(aft, below))
    return float(np.degrees(roll)), float(np.degrees(pitch))


@pytest.mark.parametrize(("x_m", "y_m"), [(0.7, 0.8), (0.7, -0.8), (0.9, 1.2), (0.5, 0.0)])
def test_the_centre_of_gravity_comes_to_rest_below_the_hook(x_m: float, y_m: float) -> None:
    """A mass on the right wing brings that one down, one in front of the hook the nose."""
    found = hung_with(MASS_KG, x_m, y_m)
    assert found == pytest.approx(by_statics(stiff(), MASS_KG, np.array([x_m, y_m, 0.0])), abs=0.15)


def test_right_is_down_where_the_mass_is_right() -> None:
    right, left = hung_with(MASS_KG, 0.7, 0.8), hung_with(MASS_KG, 0.7, -0.8)
    assert right[0] < -1 < 1 < left[0]
