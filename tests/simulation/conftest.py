"""A small scenario that simulates in seconds: one run, a short sweep, and a silence to come to rest in."""

from __future__ import annotations

import pytest
from small_rig import revised

from vgvt.scenario import Scenario, load_scenario


@pytest.fixture(scope="session")
def small() -> Scenario:
    """Hati with eight links a wing and two sensors; a small, tapered sweep; instruments without noise or filters."""
    scenario = load_scenario("hati-unsymmetric")
    wing = scenario.airframe.beam[0].model_copy(update={"cells": 8})
    clean = {"noise": None, "high_pass_hz": 0.0}
    return revised(
        scenario.model_copy(update={"airframe": scenario.airframe.model_copy(update={"beam": (wing,)})}),
        acquisition={
            "runs": ((1, 10),),
            "sample_rate_hz": 1000.0,
            "bits": 32,
            "range_v": 10.0,
            "noise_v_per_rthz": 0.0,
        },
        # A coil with resistance and inductance on a stiff flexure (Modal Shop 2100E11): all of the shaker's physics.
        shaker={
            "drive": "voltage",
            "amplifier_gain": 0.25,
            "coil_resistance_ohm": 4.0,
            "coil_inductance_h": 6e-4,
            "force_factor_n_per_a": 36.0,
            "armature_mass_kg": 0.44,
            "flexure_stiffness_n_per_m": 1.1e5,
            "flexure_damping_n_s_per_m": 9.6,
        },
        accelerometers=clean,
        transducer=clean,
        excitation={
            "start_hz": 1.0,
            "stop_hz": 37.0,
            "duration_s": 8.0,
            "amplitude_v": 0.05,
            "taper_s": 0.5,
            "ring_down_s": 16.0,
        },
    )
