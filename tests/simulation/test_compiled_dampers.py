"""The dampers of modes in compiled code do what their tendons do, and leave no trace behind."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import mujoco
import numpy as np
import pytest
from small_rig import revised

from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import compiled_dampers as compiled
from vgvt.simulation import simulated_campaign
from vgvt.simulation.assembly import driven_rig, plans
from vgvt.simulation.compiled_dampers import compiled_dampers
from vgvt.simulation.damping import MODAL_DAMPING

MANY = 10**9


def model_of(name: str) -> mujoco.MjModel:
    return driven_rig(plans(load_scenario(name))[0], 0).model


@pytest.fixture
def hati() -> mujoco.MjModel:
    return model_of("hati-unsymmetric")


@pytest.fixture(autouse=True)
def nothing_left() -> Iterator[None]:
    """Whatever a test does, the callback is gone behind it."""
    yield
    assert mujoco.get_mjcb_passive() is None
    assert compiled._users == 0


def passive_force(model: mujoco.MjModel) -> np.ndarray:
    data = mujoco.MjData(model)
    data.qvel[:] = np.random.default_rng(3).standard_normal(model.nv)
    mujoco.mj_forward(model, data)
    return np.array(data.qfrc_passive)


@pytest.mark.parametrize("name", ["hati-unsymmetric", "garteur-sm-ag19", "bff"])
def test_forces_are_those_of_the_tendons(name: str) -> None:
    model = model_of(name)
    wanted = passive_force(model)
    with compiled_dampers([model], MANY) as (relieved,):
        got = passive_force(relieved)
        # A model of anybody else is as it was.
        np.testing.assert_array_equal(passive_force(model), wanted)
    np.testing.assert_allclose(got, wanted, rtol=0, atol=1e-12 * np.abs(wanted).max())
    # Of turning joints, N m, beside the springs at the body.
    assert np.abs(passive_force(relieved) - wanted).max() > 0.1


def test_records_are_those_of_the_tendons(monkeypatch: pytest.MonkeyPatch) -> None:
    """All runs on several threads, the shaker's current and what the gauge feels among them."""
    scenario = short()
    seen: list[bool] = []
    relieved = compiled._relieved
    monkeypatch.setattr(compiled, "_relieved", lambda model: seen.append(True) or relieved(model))
    slow = simulated_campaign(scenario, engine="mujoco")
    assert not seen
    monkeypatch.setattr(compiled, "_WORTH_S", 0.0)
    fast = simulated_campaign(scenario, engine="mujoco")
    assert len(seen) == len(fast.runs)
    for one, other in zip(slow.runs, fast.runs, strict=True):
        largest = np.abs(one.samples).max(axis=1, keepdims=True)
        # A step of the converter is 5e-8 of the largest.
        assert np.all(np.abs(other.samples - one.samples) < 2e-7 * largest)


def short() -> Scenario:
    """Some tenths of a second, by instruments without noise: a converter's rounding would hide a difference."""
    return revised(
        load_scenario("hati-unsymmetric"),
        excitation={"duration_s": 0.4},
        accelerometers={"noise": None},
        transducer={"noise": None},
        acquisition={"noise_v_per_rthz": 0.0, "bits": 32},
    )


def test_short_records_are_not_worth_compiling(hati: mujoco.MjModel) -> None:
    with compiled_dampers([hati], 1000) as (same,):
        assert same is hati
        assert mujoco.get_mjcb_passive() is None


def test_models_stay_as_they_are(hati: mujoco.MjModel) -> None:
    before = hati.tendon_num.copy()
    with compiled_dampers([hati], MANY) as (relieved,):
        modal = [t for t in range(hati.ntendon) if hati.tendon(t).name.startswith(MODAL_DAMPING)]
        assert modal
        assert sorted(np.flatnonzero(relieved.tendon_num < 0)) == modal
        np.testing.assert_array_equal(np.abs(relieved.tendon_num), before)
    np.testing.assert_array_equal(hati.tendon_num, before)


def test_the_last_of_several_takes_the_callback_away(hati: mujoco.MjModel) -> None:
    wanted = passive_force(hati)
    with compiled_dampers([hati], MANY) as (outer,):
        with compiled_dampers([hati], MANY), pytest.raises(KeyboardInterrupt), compiled_dampers([hati], MANY):
            raise KeyboardInterrupt
        np.testing.assert_allclose(passive_force(outer), wanted, rtol=0, atol=1e-12 * np.abs(wanted).max())


def test_somebody_elses_callback_stays(hati: mujoco.MjModel) -> None:
    """And with it the tendons."""
    compiled._probed()

    def own(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        data.qfrc_passive[0] += 7.0

    mujoco.set_mjcb_passive(own)
    try:
        with compiled_dampers([hati], MANY) as (same,):
            assert same is hati
            assert mujoco.get_mjcb_passive() is own
        assert mujoco.get_mjcb_passive() is own
    finally:
        mujoco.set_mjcb_passive(None)


def test_who_replaces_it_is_told_and_keeps_its_own(hati: mujoco.MjModel) -> None:
    def own(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Nothing."""

    with pytest.raises(RuntimeError, match="set_mjcb_passive"), compiled_dampers([hati], MANY):
        mujoco.set_mjcb_passive(own)
    assert mujoco.get_mjcb_passive() is own
    mujoco.set_mjcb_passive(None)


def test_dampers_that_grow_with_speed_stay_tendons() -> None:
    """An effect's drag, of which the callback knows nothing."""
    model = model_of("spoiled-amplitude-dependent-damping")
    modal = [t for t in range(model.ntendon) if model.tendon(t).name.startswith(MODAL_DAMPING)]
    assert model.tendon_dampingpoly[modal].any(axis=1).all()
    wanted = passive_force(model)
    with compiled_dampers([model, model_of("hati-unsymmetric")], MANY) as (dragged, other):
        assert (other.tendon_num < 0).any()
        np.testing.assert_array_equal(passive_force(dragged), wanted)


def test_threads_that_ask_at_once_share_one(hati: mujoco.MjModel) -> None:
    compiled._probed.cache_clear()
    together = threading.Barrier(4, timeout=60)

    def stepped(_: int) -> bool:
        together.wait()
        with compiled_dampers([hati], MANY) as (model,):
            together.wait()
            return model is not hati

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(stepped, range(4)))


def test_somebody_elses_callback_is_in_the_way_only_while_it_is_there(hati: mujoco.MjModel) -> None:
    compiled._probed.cache_clear()
    mujoco.set_mjcb_passive(lambda model, data: None)
    try:
        with compiled_dampers([hati], MANY) as (same,):
            assert same is hati
    finally:
        mujoco.set_mjcb_passive(None)
    with compiled_dampers([hati], MANY) as (relieved,):
        assert relieved is not hati


@pytest.mark.parametrize("broken", ["no addresses", "another order", "no place for machine code", "no compiler"])
def test_what_is_not_as_expected_leaves_the_tendons(
    hati: mujoco.MjModel, monkeypatch: pytest.MonkeyPatch, broken: str
) -> None:
    compiled._probed.cache_clear()
    places = compiled._places
    if broken == "no addresses":
        monkeypatch.setattr(compiled, "_places", lambda model, data: None)
    elif broken == "no compiler":

        def refused(places: object) -> None:
            raise RuntimeError("nothing compiles here")

        monkeypatch.setattr("vgvt.simulation.compiled_push.compiled_push", refused)
    elif broken == "no place for machine code":
        # That is told while the module is imported.
        monkeypatch.setitem(sys.modules, "vgvt.simulation.compiled_push", None)
    else:

        def swapped(model: mujoco.MjModel, data: mujoco.MjData) -> dict[str, int] | None:
            found = places(model, data)
            assert found is not None
            # Both are of a number for each tendon's joint, and of eight bytes.
            return found | {"tendon_damping": found["wrap_prm"], "wrap_prm": found["tendon_damping"]}

        monkeypatch.setattr(compiled, "_places", swapped)
    with compiled_dampers([hati], MANY) as (same,):
        assert same is hati
    compiled._probed.cache_clear()
