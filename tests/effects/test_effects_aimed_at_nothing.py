"""An effect of a sensor or a run that a test does not have is refused, and not simulated as nothing."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from effect_rig import FORE, TIP, WING, effect_rig, having
from small_rig import revised

from vgvt.data import InputError
from vgvt.effects import make_effect
from vgvt.effects.action import NOTHING
from vgvt.effects.conformance import with_effect
from vgvt.effects.places import require_in_the_runs
from vgvt.effects.protocol import Family
from vgvt.effects.sensor_choice import chosen_channels
from vgvt.scenario import Scenario, bundled_scenarios, load_scenario, spoiled_scenarios
from vgvt.simulation.assembly import plans


@pytest.fixture(scope="module")
def roving() -> Scenario:
    """A run of two sensors and one of a single one."""
    return revised(effect_rig(), acquisition={"runs": ((WING, TIP), (FORE,))})


@pytest.mark.parametrize(
    ("effect", "settings"),
    [
        ("channel-gain", {"gain_error": 0.1, "channels": "sensor-3"}),
        ("channel-delay", {"delay_s": 1e-4, "channels": "sensor-99"}),
        ("sensor-tilt", {"angle_rad": 0.1, "sensors": "sensor-3"}),
    ],
)
def test_a_sensor_that_no_run_has_is_refused(roving: Scenario, effect: str, settings: dict[str, object]) -> None:
    with pytest.raises(InputError, match=rf"effect {effect}: sensor-\d+: no run has \d+ sensors") as refused:
        plans(having(roving, effect, **settings))
    assert "sensor-1 to sensor-2" in refused.value.advice


def test_a_sensor_that_one_run_lacks_is_nothing_in_that_run(roving: Scenario) -> None:
    assert [len(chosen_channels(roving, run, "sensor-2", "test")) for run in (0, 1)] == [1, 0]


@pytest.mark.parametrize("name", (*bundled_scenarios(), *spoiled_scenarios()))
def test_all_that_is_bundled_begins_in_its_runs(name: str) -> None:
    require_in_the_runs(load_scenario(name))


@pytest.mark.parametrize(
    ("runs", "words", "advice"),
    [
        (1, "there is 1 run", "more runs, or leave"),
        (2, "there are 2 runs", "Write 2,"),
        (4, "there are 4 runs", "Write 2 to 4,"),
    ],
)
def test_a_change_after_the_last_run_is_refused(runs: int, words: str, advice: str) -> None:
    scenario = revised(load_scenario("quick"), acquisition={"runs": ((1, 2),) * runs})
    late = make_effect("payload-change", "test", mass_kg=0.1, from_run=5)
    with pytest.raises(
        InputError, match=rf"effect\[0\]\.from_run: payload-change: from_run = 5, but {words}"
    ) as refused:
        require_in_the_runs(with_effect(scenario, late))
    assert advice in refused.value.advice


def test_repeats_are_runs_and_a_drift_has_no_first_run() -> None:
    scenario = revised(load_scenario("quick"), acquisition={"runs": ((1, 2),), "repeats": 3})
    require_in_the_runs(with_effect(scenario, make_effect("re-hang", "test", shift_x_m=0.01, from_run=3)))
    for shape in ("linear", "exponential"):
        drift = make_effect("gain-drift", "test", drift=0.1, shape=shape, from_run=9)
        require_in_the_runs(with_effect(scenario, drift))
    with pytest.raises(InputError, match="are 3 runs"):
        step = make_effect("gain-drift", "test", drift=0.1, shape="step", from_run=4)
        require_in_the_runs(with_effect(scenario, step))


@pytest.mark.parametrize(
    ("effect", "settings"),
    [
        ("run-drift", {"drift": 0.05}),
        ("gain-drift", {"drift": 0.05, "shape": "exponential"}),
        ("temperature-change", {"warming_k": 5.0}),
        ("root-creep", {"bending": 0.1}),
        ("mount-creep", {"compliance_m_per_n": 1e-4}),
    ],
)
def test_what_goes_on_from_run_to_run_asks_for_two(effect: str, settings: dict[str, object]) -> None:
    """`quick` has one: drifts of any size had been simulated as nothing there."""
    whole = load_scenario("quick")
    drifting = with_effect(whole, make_effect(effect, "test", **settings))
    with pytest.raises(InputError, match=rf"effect\[0\]\.shape: {effect} goes on .* there is 1 run"):
        require_in_the_runs(drifting)
    require_in_the_runs(revised(drifting, acquisition={"repeats": 2}))


@pytest.mark.parametrize(
    ("effect", "settings", "words"),
    [
        ("channel-gain", {"gain_error": 0.1, "channels": "10+Z"}, "channels: channel-gain: .*'10.Z'"),
        ("channel-gain", {"gain_error": 0.1, "channels": "even"}, "channels: channel-gain: .*'even'"),
        ("sensor-tilt", {"angle_rad": 0.05, "sensors": "10+Z"}, "sensors: sensor-tilt: .*'10.Z'"),
        ("cable-drag", {"stiffness_n_per_m": 5.0, "sensors": "10+Z"}, "sensors: cable-drag: .*'10.Z'"),
        ("loose-sensor-mount", {"period_s": 0.01, "node": 10}, "node: loose-sensor-mount: .*node 10"),
        ("sensor-position-error", {"dx_m": 0.01, "node": 10}, "node: sensor-position-error: .*node 10"),
        ("swapped-sensors", {"node": 10, "other_node": 12}, "node: swapped-sensors: .*node 10 or 12"),
    ],
)
def test_a_point_of_the_grid_that_no_run_measures_is_refused(
    effect: str, settings: dict[str, object], words: str
) -> None:
    few = revised(load_scenario("quick"), acquisition={"runs": ((1, 3), (5, 7))})
    aimed = with_effect(few, make_effect(effect, "test", **settings))
    with pytest.raises(InputError, match=rf"effect\[0\]\.{words}") as refused:
        require_in_the_runs(aimed)
    assert "1, 3, 5, 7" in refused.value.advice
    require_in_the_runs(revised(aimed, acquisition={"runs": ((1, 3), (10, 7))}))


def test_a_sensor_that_is_measured_at_anothers_place_is_exchanged() -> None:
    few = revised(load_scenario("quick"), acquisition={"runs": ((1, 3),)})
    require_in_the_runs(with_effect(few, make_effect("swapped-sensors", "test", node=3, other_node=12)))


@pytest.mark.parametrize("effect", ["channel-gain", "mains-hum"])
def test_a_hammer_test_has_no_command_to_spoil(effect: str) -> None:
    size = {"channel-gain": "gain_error", "mains-hum": "amplitude_v"}[effect]
    driven = make_effect(effect, "test", **{size: 0.01}, channels="drive")
    with pytest.raises(InputError, match=r"effect\[0\]\.channels: .* no run has a channel of 'drive'"):
        require_in_the_runs(with_effect(load_scenario("teaching-beam-hammer"), driven))
    require_in_the_runs(with_effect(load_scenario("quick"), driven))


def test_an_effect_of_ones_own_may_call_something_else_its_shape(monkeypatch: pytest.MonkeyPatch) -> None:
    own: Any = SimpleNamespace(name="dent", family=Family.AIRFRAME, shape="round", act=lambda scenario, run: NOTHING)
    monkeypatch.setattr("vgvt.effects.places.effects_of", lambda scenario: (own,))
    require_in_the_runs(load_scenario("quick"))
