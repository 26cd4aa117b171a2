"""An aircraft of any size comes to rest: enlarged with its forces it swings as before, only more slowly."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest

from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import truth_of
from vgvt.simulation.assembly import driven_rig, plan
from vgvt.simulation.linear import at_rest_n, joint_force
from vgvt.simulation.settling import settle_near

# What a key's unit becomes with the lengths, where gravity stays: the longest ending counts.
_POWERS = {
    "_m": 1.0,
    "_s": 0.5,
    "_hz": -0.5,
    "_kg": 3.0,
    "_kg_m": 4.0,
    "_kg_m2": 5.0,
    "_kg_per_m": 2.0,
    "_n_m2": 5.0,
    "_n_per_m": 2.0,
    "_n_s_per_m": 2.5,
    "_n_m_per_rad": 4.0,
    "_n_m_s_per_rad": 4.5,
}


def enlarged(scenario: Scenario, factor: float) -> Scenario:
    """All of it ``factor`` times as long, of the same density and shape at rest (Froude's similarity)."""

    def grown(value: Any, key: str) -> Any:
        if isinstance(value, dict):
            return {name: grown(inner, name) for name, inner in value.items()}
        if isinstance(value, list | tuple):
            return [grown(inner, key) for inner in value]
        ending = max((e for e in _POWERS if key.endswith(e)), key=len, default=None)
        return value * factor ** _POWERS[ending] if ending and isinstance(value, float) else value

    tables = scenario.model_dump(exclude={"tolerances", "simulation"}, exclude_none=True)
    return Scenario.model_validate(grown(tables, ""))


@pytest.mark.parametrize("factor", [40.0, 100.0])
def test_it_comes_to_rest_and_swings_alike(factor: float) -> None:
    """At 40 times its size Hati weighs 400 t: what rounding leaves of that is more than a small aircraft's limit."""
    small = load_scenario("quick")
    model, large = (truth_of(s).as_tested[0].natural_frequency_hz for s in (small, enlarged(small, factor)))
    assert model[8] > 30.0
    np.testing.assert_allclose(large[:9] * np.sqrt(factor), model[:9], rtol=1e-5)


def test_it_is_found_from_beside_it() -> None:
    rig = driven_rig(plan(enlarged(load_scenario("quick"), 100.0)), 0)
    near = rig.qpos.copy()
    near[2] += 0.1
    found = settle_near(rig.model, near, None)
    assert found is not None
    np.testing.assert_allclose(found, rig.qpos, atol=1e-6)


def test_a_small_aircraft_rests_as_exactly_as_ever() -> None:
    rig = driven_rig(plan(load_scenario("garteur-sm-ag19")), 0)
    data = mujoco.MjData(rig.model)
    data.qpos[:] = rig.qpos
    joint_force(rig.model, data)
    assert at_rest_n(rig.model, data, 1e-9) == 1e-9
