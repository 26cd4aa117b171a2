"""No plan that is proposed breaks a stated limit; where what stays does so by itself, that is said at once."""

from __future__ import annotations

import pytest

from vgvt.data import InputError
from vgvt.planning import planner
from vgvt.planning.budget import Budget
from vgvt.planning.planner import Order, plan_test
from vgvt.planning.sweeps import affordable_sweeps
from vgvt.planning.system import check_one_shaker
from vgvt.planning.wish import Wish
from vgvt.scenario import load_scenario
from vgvt.scenario.rig import Excitation

VOLTS = 2.0


def order(free: str, minutes: float, sensors: int, **changes) -> Order:
    fields = {"seeds": 0, "largest_peak_v": VOLTS} | changes
    return Order(Budget(minutes, sensors), frozenset(free.split(",")), **fields)


@pytest.mark.parametrize(
    ("free", "minutes", "sensors"),
    [
        ("level", 5.8, 10),
        ("level,mount", 2, 10),  # clay alone is quick enough
        ("sweep-time", 5.7, 10),
        ("sweep-time,mount", 3, 10),
        ("sensors", 8, 4),
        ("sensors,level", 5.8, 12),
        ("sensors,sweep-time", 7, 4),
        ("band,sweep-time", 5.575, 10),  # 2.5 s: enough for a sweep from 4.9 Hz, not for one from 3 Hz
        ("sensors,mount,sweep-time", 3.5, 3),
        pytest.param("shaker,sensors,band,sweep-time,level,mount", 9, 4, marks=pytest.mark.slow),
    ],
)
def test_no_plan_breaks_the_budget(light, free, minutes, sensors) -> None:
    plans = plan_test(light, order(free, minutes, sensors)).plans
    assert plans
    for plan in plans:
        scenario = plan.scenario
        assert plan.minutes == pytest.approx(Budget(minutes, sensors).minutes_of(scenario, plan.mount))
        assert plan.minutes <= minutes * (1 + 1e-9)
        assert max(len(run) for run in scenario.acquisition.runs) <= sensors
        assert scenario.excitation.amplitude_v <= VOLTS


@pytest.mark.parametrize(
    ("free", "minutes", "sensors", "changes", "words"),
    [
        ("level", 20, 2, {}, ["--sensors", "10 accelerometers at once", "add sensors to --free"]),
        ("sweep-time,shaker,band", 20, 9, {}, ["--sensors", "--sensors 10"]),
        ("level", 1, 10, {}, ["--minutes", "1 run and", "take 5.8", "sweep-time, sensors, mount"]),
        ("sensors", 8, 2, {}, ["--minutes", "5 runs", "--free: sweep-time, mount"]),
        ("mount,sensors", 1, 10, {}, ["--minutes", "take 1.8", "--free: sweep-time"]),
        ("level", 20, 10, {"points": 5}, ["--points", "measure 10"]),
        ("level", 20, 10, {"points": 12}, ["--points", "measure 10"]),
        ("sweep-time", 20, 10, {"largest_peak_v": 0.1}, ["--max-volts", "add level to --free"]),
    ],
)
def test_what_stays_and_breaks_a_limit_is_refused_before_any_work(
    light, monkeypatch, free, minutes, sensors, changes, words
) -> None:
    def work(_scenario):
        raise AssertionError("nothing is to be computed")

    monkeypatch.setattr(planner, "predict", work)
    with pytest.raises(InputError) as refusal:
        plan_test(light, order(free, minutes, sensors, **changes))
    for word in words:
        assert word in str(refusal.value)


@pytest.mark.parametrize(
    ("name", "words", "own"),
    [
        ("hati-two-shakers", ["further_shaker: makes 2 shakers", "further_shaker = []"], "further_shaker = []"),
        (
            "teaching-beam-hammer",
            ["kind: is 'impact'", 'kind = "linear-chirp" and amplitude_v'],
            '[excitation]\nkind = "linear-chirp"\namplitude_v = 0.5',
        ),
    ],
)
def test_another_exciter_is_refused_first_and_told_what_to_write(tmp_path, monkeypatch, name, words, own) -> None:
    """It had come after limits of minutes and volts, which it then made no sense to have met."""

    def work(*_arguments):
        raise AssertionError("nothing is to be computed")

    for step in ("check_generator_gives", "peak_command_v", "predict"):
        monkeypatch.setattr(planner, step, work)
    with pytest.raises(InputError) as refusal:
        plan_test(load_scenario(name), order("shaker", 1, 1))
    for word in words:
        assert word in str(refusal.value)
    path = tmp_path / "own.toml"
    path.write_text(f'extends = "{name}"\nname = "own"\nsummary = "One shaker."\n{own}\n', encoding="utf-8")
    check_one_shaker(load_scenario(path))


def test_what_keeps_the_limits_exactly_is_not_refused(light) -> None:
    minutes = Budget(20, 10).minutes_of(light)
    assert plan_test(light, order("level", minutes, 10, points=10)).plans


def test_minutes_that_leave_no_time_for_a_sweep_are_refused(light) -> None:
    with pytest.raises(InputError, match=r"--minutes: 1\.2 min leave 0 s"):
        plan_test(light, order("sweep-time,band,mount", 1.2, 10))


def test_a_longest_sweep_that_is_none_is_told_by_its_option(light) -> None:
    """No minutes help: ten cycles of 3 Hz take more than three seconds."""
    short = Order(Budget(20, 10, longest_sweep_s=3.0), frozenset({"sweep-time"}), seeds=0)
    with pytest.raises(InputError, match=r"--longest-sweep: is 3 s, but from 3 Hz on a sweep takes 3\.33 s at least"):
        plan_test(light, short)


def test_no_sweep_goes_beyond_what_the_converter_can_follow(light) -> None:
    """A tenth above a mode at 31.8 Hz is beyond the 34 Hz of 68 samples a second: no file of it could be read."""
    slow = light.model_copy(
        update={
            "acquisition": light.acquisition.model_copy(update={"sample_rate_hz": 68.0}),
            "excitation": light.excitation.model_copy(update={"stop_hz": 33.0}),
        }
    )
    wish = Wish(frozenset({"band"}), Budget(20, 10), 10, VOLTS, targets=(("2nd symmetric bending", 31.8),))
    (sweeps,) = affordable_sweeps(slow, wish).values()
    assert len(sweeps) > 1
    assert max(sweep.excitation.band_hz[1] for sweep in sweeps) < 34.0


def test_minutes_that_leave_too_little_for_dwells_are_refused(light) -> None:
    """A hundred dwells of three seconds, two to settle; in eight minutes less than two are left for each."""
    dwells = {"kind": "stepped-sine", "points": 100, "settle_s": 2.0, "duration_s": 300.0}
    keys = light.excitation.model_dump(exclude_none=True) | dwells
    stepped = light.model_copy(update={"excitation": Excitation.model_validate(keys)})
    with pytest.raises(InputError, match=r"--minutes: 8 min leave an excitation of 148 s, for which .*settle_s is 2"):
        plan_test(stepped, order("sweep-time", 8, 10))
    # Other sweeps need no dwells; and what cannot be made stands beside no plan.
    found = plan_test(stepped, order("sweep-time,band", 8, 10))
    assert found.plans and found.with_budget is None
    assert {plan.scenario.excitation.kind for plan in found.plans} <= {"linear-chirp", "logarithmic-chirp"}
    assert plan_test(stepped, order("sweep-time", 20, 10)).plans
