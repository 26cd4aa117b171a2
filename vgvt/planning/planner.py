"""The whole of planning: targets, limits, search, confirmation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from vgvt.data import InputError
from vgvt.data.suggestion import choose_one_of
from vgvt.planning.budget import AS_DESCRIBED, MOUNTS, Budget
from vgvt.planning.confirmation import confirm
from vgvt.planning.limits import check_generator_gives, check_one_level, check_what_stays
from vgvt.planning.places import sensor_places, with_places
from vgvt.planning.prediction import predict
from vgvt.planning.proposal import Proposal, elastic, proposal
from vgvt.planning.result import PlanningResult
from vgvt.planning.search import best_plans, with_mount
from vgvt.planning.selection import dealt
from vgvt.planning.system import check_one_shaker
from vgvt.planning.wish import FREE, Wish
from vgvt.scenario.model import Scenario
from vgvt.scenario.sampling import MOST_SAMPLES
from vgvt.simulation.assembly import plans as layouts_of
from vgvt.simulation.command import peak_command_v

Progress = Callable[[float, str], None]


@dataclass(frozen=True, slots=True)
class Order:
    """What a planner is asked for; ``modes_hz`` are frequencies near the modes that count, empty for all in the band.

    ``points`` are how many places are measured over all runs (default: as many as now, or as there
    are accelerometers), ``largest_peak_v`` what the command may rise to (default: what it does now),
    ``confirmed`` how many of the best plans are simulated with ``seeds`` campaigns.
    """

    budget: Budget
    free: frozenset[str] = frozenset(FREE)
    modes_hz: tuple[float, ...] = ()
    points: int | None = None
    largest_peak_v: float | None = None
    largest_mac: float = 0.25
    seeds: int = 20
    confirmed: int = 1
    identifier: str = "maximum-likelihood"


def checked_free(words: Sequence[str]) -> frozenset[str]:
    """The words of --free, checked; InputError names the one that was meant."""
    for word in words:
        if word not in FREE:
            raise InputError("--free", f"there is nothing called {word!r}", choose_one_of(word, FREE))
    if not words:
        raise InputError("--free", "nothing is free", f"name some of {', '.join(FREE)}")
    return frozenset(words)


def plan_test(scenario: Scenario, order: Order, progress: Progress | None = None) -> PlanningResult:
    """The best plans for a scenario within a budget, beside the scenario as it is, some confirmed by simulation.

    Deterministic. InputError for an order that no test can meet. ``progress(fraction, message)`` is called
    now and then.
    """
    report = progress or (lambda _fraction, _text: None)
    share = 0.5 if order.seeds else 1.0
    check_one_level(scenario)
    check_one_shaker(scenario)
    check_generator_gives(scenario, order.largest_peak_v)
    _check_size(scenario, order.budget)
    peak_v = order.largest_peak_v or peak_command_v(scenario)
    wish = Wish(_that_can_be(order.free, scenario), order.budget, _points(scenario, order), peak_v, order.largest_mac)
    check_what_stays(scenario, wish)
    report(0.0, "the scenario as it is")
    prediction = predict(scenario)
    targets = _targets(elastic(prediction), order, scenario)
    now = proposal("as-described", scenario, order.budget, targets, prediction=prediction)
    wish = replace(wish, targets=targets)
    plans = best_plans(scenario, wish, lambda fraction, text: report(share * fraction, text))
    full = _with_budget(scenario, wish)
    confirmed = {}
    chosen = [now, *plans[: order.confirmed]] if order.seeds else []
    for k, plan in enumerate(chosen):
        done = share + (1 - share) * k / len(chosen)

        def of_plan(fraction: float, text: str, done: float = done) -> None:
            report(done + (1 - share) * fraction / len(chosen), text)

        confirmed[plan.name] = confirm(plan, order.identifier, order.seeds, of_plan)
    return PlanningResult(now, full, tuple(plans), confirmed)


def _that_can_be(free: frozenset[str], scenario: Scenario) -> frozenset[str]:
    """What is free, less the mount where the scenario's transducer has no mass that could ride on another one.

    InputError where nothing else is free.
    """
    if "mount" not in free:
        return free
    try:
        for mount in MOUNTS:
            layouts_of(with_mount(scenario, mount))
    except InputError:
        if free == {"mount"}:
            raise
        return free - {"mount"}
    return free


def _check_size(scenario: Scenario, budget: Budget) -> None:
    """InputError where so many minutes hold more samples than a campaign may have."""
    rate_hz = scenario.acquisition.sample_rate_hz
    at_once = max(min(budget.sensors, len(sensor_places(scenario))), *map(len, scenario.acquisition.runs))
    channels = at_once + 2 * len(scenario.shakers)
    most_minutes = MOST_SAMPLES / (60 * rate_hz * channels)
    if budget.minutes > most_minutes:
        raise InputError(
            "--minutes",
            f"{budget.minutes:g} min of {channels} channels at {rate_hz:g} Hz make more than the "
            f"{8 * MOST_SAMPLES / 1e9:g} GB of samples that a campaign may have",
            f"give at most {0.99 * most_minutes:.3g}, or lower acquisition.sample_rate_hz",
        )


def _targets(modes: tuple[tuple[str, float], ...], order: Order, scenario: Scenario) -> tuple[tuple[str, float], ...]:
    if not modes:
        low, high = scenario.excitation.recorded_band_hz
        raise InputError(
            f"scenario {scenario.name}: excitation",
            f"no elastic mode lies between {low:g} and {high:g} Hz",
            "sweep where the modes are, see vgvt show",
        )
    if not order.modes_hz:
        return modes
    wanted = {min(modes, key=lambda m: abs(m[1] - hz)) for hz in order.modes_hz}
    for hz in order.modes_hz:
        if min(abs(m[1] / hz - 1) for m in modes) > 0.1:
            known = ", ".join(f"{m[1]:.2f}" for m in modes)
            raise InputError("--modes", f"there is no mode near {hz:g} Hz", f"the modes in the band are at {known} Hz")
    return tuple(sorted(wanted, key=lambda m: m[1]))


def _points(scenario: Scenario, order: Order) -> int:
    now = len({node for run in scenario.acquisition.runs for node in run})
    if "sensors" not in order.free:
        if order.points not in (None, now):
            problem = f"is {order.points}, but the runs stay as they are and measure {now}"
            raise InputError("--points", problem, "add sensors to --free, or leave --points out")
        return now
    places = len(sensor_places(scenario))
    points = order.points or max(now, min(order.budget.sensors, places))
    if points > places:
        raise InputError("--points", f"{points} points, but there are places for {places}", "measure fewer")
    return points


def _with_budget(scenario: Scenario, wish: Wish) -> Proposal | None:
    """The scenario's own points, shaker and band, as many points at once as there are sensors, all of the time."""
    budget = wish.budget
    nodes = list(dict.fromkeys(node for run in scenario.acquisition.runs for node in run))
    runs = -(-len(nodes) // budget.sensors)
    try:
        duration, repeats = budget.sweep(scenario, runs, AS_DESCRIBED)
    except InputError:
        return None
    chosen = [p for p in sensor_places(scenario) if p.node in nodes]
    regrouped = with_places(scenario, chosen, dealt(nodes, runs))
    swept = regrouped.model_copy(
        update={
            "excitation": scenario.excitation.model_copy(update={"duration_s": duration}),
            "acquisition": regrouped.acquisition.model_copy(update={"repeats": repeats}),
        }
    )
    return proposal("with-budget", swept, budget, wish.targets)
