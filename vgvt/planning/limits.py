"""What stays as it is may break a limit by itself; that is said before anything is computed."""

from __future__ import annotations

import math

from vgvt.data import InputError
from vgvt.planning.budget import Mount
from vgvt.planning.wish import Wish
from vgvt.scenario.model import Scenario
from vgvt.simulation.command import peak_command_v

_SHORTENS = ("sweep-time", "sensors", "mount")  # what may make a test shorter where it is free


def check_one_level(scenario: Scenario) -> None:
    """InputError where runs are driven at several levels: what a plan foretells is of one."""
    if len(set(scenario.acquisition.levels or (1.0,))) > 1:
        raise InputError(
            f"scenario {scenario.name}: acquisition.levels",
            "drives runs at several levels, and a plan is for one",
            "take levels out to plan, and write them into the plan's scenario",
        )


def check_generator_gives(scenario: Scenario, largest_peak_v: float | None) -> None:
    """InputError where the command may rise to more than the scenario's generator gives."""
    range_v = scenario.generator.range_v
    if largest_peak_v is not None and range_v is not None and largest_peak_v > range_v:
        raise InputError(
            "--max-volts",
            f"is {largest_peak_v:g}, but the scenario's generator gives {range_v:g} V at most",
            f"write --max-volts {range_v:g}, or a larger shaker.amplifier_gain into the scenario for more force",
        )


def most_given_v(scenario: Scenario) -> float:
    """The largest command that the scenario's generator gives, V."""
    return math.inf if scenario.generator.range_v is None else scenario.generator.range_v


def check_what_stays(scenario: Scenario, wish: Wish) -> None:
    """InputError where what is not free breaks a limit, so that no plan could keep it."""
    at_once = max(len(run) for run in scenario.acquisition.runs)
    if "sensors" not in wish.free and at_once > wish.budget.sensors:
        raise InputError(
            "--sensors",
            f"is {wish.budget.sensors}, but the runs stay as they are and record {at_once} accelerometers at once",
            f"add sensors to --free, or write --sensors {at_once}",
        )
    peak_v = min(peak_command_v(scenario), most_given_v(scenario)) if "level" not in wish.free else 0.0
    if peak_v > wish.largest_peak_v:
        least_v = math.ceil(1000 * peak_v - 1e-6) / 1000
        raise InputError(
            "--max-volts",
            f"is {wish.largest_peak_v:g}, but the command stays as it is and has peaks of {least_v:g} V",
            f"add level to --free, or write --max-volts {least_v:g}",
        )
    if "sweep-time" not in wish.free and not any(has_time_for(scenario, wish, mount) for mount in wish.mounts):
        raise too_long(scenario, wish)


def has_time_for(scenario: Scenario, wish: Wish, mount: Mount) -> bool:
    """Whether a scenario's own sweeps and repeats, in as many runs as a plan has, fit into the minutes."""
    return wish.minutes_of(scenario, mount) <= wish.budget.minutes * (1 + 1e-9)  # sums of minutes round


def too_long(scenario: Scenario, wish: Wish) -> InputError:
    """The error for sweeps that stay and take more than the minutes: how much more, and what may shorten the test."""
    least = math.ceil(10 * min(wish.minutes_of(scenario, mount) for mount in wish.mounts) - 1e-6) / 10
    runs, more = wish.run_count(scenario), ", ".join(word for word in _SHORTENS if word not in wish.free)
    return InputError(
        "--minutes",
        f"is {wish.budget.minutes:g}, but the sweeps stay as they are: {runs} run{'s' if runs > 1 else ''} "
        f"and setting up take {least:g}",
        f"write --minutes {least:g}, or add what may shorten the test to --free: {more}",
    )
