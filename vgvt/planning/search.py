"""The search for the best plan: every place of the shaker, sensors chosen for it, sweeps compared, all by Fisher."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.planning.budget import MOUNT_EFFECT, Mount
from vgvt.planning.pairing import named_alike, paired
from vgvt.planning.places import Place, sensor_places, shaker_places, with_places, with_shaker_at
from vgvt.planning.proposal import RIGID, Proposal, proposal
from vgvt.planning.selection import added_points, chosen_points, dealt, least_distinct, worst_relative_damping
from vgvt.planning.sweeps import Sweep, affordable_sweeps
from vgvt.planning.system import System, information_by_response, seen_by, systems_of
from vgvt.planning.wish import Wish
from vgvt.scenario.effect import EffectTable
from vgvt.scenario.model import Scenario

Progress = Callable[[float, str], None]
Runs = tuple[tuple[int, ...], ...]

_SEVERAL_MOUNTS = 3  # best places of the shaker that are tried with another mount
_FINALISTS = 6
_ALSO_APART = 1.5  # modes up to this factor above the band should have shapes that can be told apart, too
_NEAR = 0.1  # of its frequency: so far a target may move with shaker, mount and sensors


@dataclass(frozen=True, slots=True, eq=False)
class _Sketch:
    """A candidate before it is predicted in full."""

    scenario: Scenario
    mount: Mount
    place: Place
    worst: float


def best_plans(scenario: Scenario, wish: Wish, progress: Progress | None = None) -> list[Proposal]:
    """The best plans for a scenario, the best one first, each with another place or mount of the shaker.

    All keep the budget; InputError where there is time for no sweep.
    """
    report = progress or (lambda _fraction, _text: None)
    (first, sweeps), *others = affordable_sweeps(scenario, wish).items()
    places = shaker_places(scenario) if "shaker" in wish.free else shaker_places(scenario)[:1]
    sketches: list[_Sketch] = []
    behind: list[_Sketch] = []
    for k, place in enumerate(places):
        report(0.6 * k / len(places), f"place {k + 1} of {len(places)} for the shaker")
        found = _sketches(scenario, wish, first, place, sweeps)
        sketches += found[:1]
        if k == 0:
            behind = found[1:]
    leaders = sorted(sketches, key=lambda s: s.worst)[:_SEVERAL_MOUNTS]
    for mount, affordable in others:
        for leader in leaders:
            report(0.65, f"{mount.name} at the best places")
            sketches += _sketches(scenario, wish, mount, leader.place, affordable)[:1]
    # What is there already is predicted in full, too: a sketch takes masses of sensors at their average.
    finalists = [*sorted(sketches, key=lambda s: s.worst)[:_FINALISTS], *behind]
    plans = []
    for k, sketch in enumerate(finalists):
        report(0.7 + 0.3 * k / len(finalists), f"finalist {k + 1} of {len(finalists)}")
        plans.append(proposal(f"plan-{k + 1}", sketch.scenario, wish.budget, wish.targets, sketch.mount))
    plans.sort(key=lambda p: p.worst_relative_damping_std)
    best: dict[tuple[object, Mount], Proposal] = {}
    for plan in plans:
        best.setdefault((plan.scenario.shaker.position_m, plan.mount), plan)
    return [replace(plan, name=f"plan-{k + 1}") for k, plan in enumerate(best.values())]


def with_mount(scenario: Scenario, mount: Mount) -> Scenario:
    """The scenario with the effect of a mount in place of the one it has."""
    if not mount.effect:
        return scenario
    table = EffectTable(name=MOUNT_EFFECT, **dict(mount.effect))
    others = tuple(e for e in scenario.effect if e.name != MOUNT_EFFECT)
    return scenario.model_copy(update={"effect": (*others, table)})


def _sketches(scenario: Scenario, wish: Wish, mount: Mount, place: Place, sweeps: Sequence[Sweep]) -> list[_Sketch]:
    """Sensors and sweep for one place and mount, the best first; nothing where the aircraft would not hang.

    Where sensors are free, those that are chosen and the scenario's own points.
    """
    mounted = with_mount(scenario, mount)
    if place.position_m != scenario.shaker.position_m:
        mounted = with_shaker_at(mounted, place)
    measured = _measured(mounted, wish)
    system = systems_of(with_places(mounted, measured, [_spread(measured, wish)]))[0]
    wanted = _wanted(system, wish)
    if wanted is None:
        return []
    trials = [sweep.in_place_of(mounted) for sweep in sweeps]
    layouts = [mounted.acquisition.runs]
    if "sensors" in wish.free:
        layouts = _layouts(system, trials[0], measured, wanted, wish)
    found, tried = [], trials
    for runs in layouts:
        worst = [_judged(system, trial, measured, wanted, runs) for trial in tried]
        best = min(range(len(tried)), key=worst.__getitem__)
        found.append(_Sketch(_laid_out(tried[best], measured, runs), mount, place, worst[best]))
        # The best of many sweeps for some points is a good one for others.
        tried = [trials[0], tried[best]]
    return sorted(found, key=lambda s: s.worst)


def _laid_out(trial: Scenario, measured: Sequence[Place], runs: Runs) -> Scenario:
    """The trial with these runs of nodes; as it is where these are its own."""
    if runs == trial.acquisition.runs:
        return trial
    nodes = {node for run in runs for node in run}
    return with_places(trial, [p for p in measured if p.node in nodes], runs)


def _measured(scenario: Scenario, wish: Wish) -> tuple[Place, ...]:
    places = sensor_places(scenario)
    return places if "sensors" in wish.free else places[: len(scenario.accelerometers.grid.node)]


def _spread(places: Sequence[Place], wish: Wish) -> list[int]:
    """Some nodes all over the aircraft, as many as are measured at once: what their mass does, wherever they go."""
    count = min(wish.budget.sensors, wish.points, len(places))
    order = sorted(places, key=lambda p: p.position_m[1])
    return [order[int(k)].node for k in np.unique(np.linspace(0, len(order) - 1, count).astype(int))]


def _with_sweep(system: System, trial: Scenario) -> System:
    scenario = system.layout.scenario.model_copy(update={"excitation": trial.excitation})
    return replace(system, layout=replace(system.layout, scenario=scenario))


def _wanted(system: System, wish: Wish) -> NDArray[np.intp] | None:
    """Indices of the target modes among all modes, None where one of them is gone."""
    alike = named_alike([label for label, _ in wish.targets], system.modes.labels)
    found = paired([hz for _, hz in wish.targets], system.modes.natural_frequency_hz, _NEAR, alike)
    return None if None in found else np.array(found, dtype=np.intp)


def _layouts(
    system: System, trial: Scenario, measured: Sequence[Place], wanted: NDArray[np.intp], wish: Wish
) -> list[Runs]:
    """Runs of the points that tell most of the mode that is known worst, and those of the scenario's own points.

    The latter with more of them where more are asked for; not where they leave shapes too alike and others do not.
    """
    seen = seen_by(_with_sweep(system, trial))
    poles, each = information_by_response(system, seen, system.sensors)
    each = each[: len(measured)]
    places = np.array([np.flatnonzero(seen.unknown == m)[0] for m in wanted if m in seen.unknown])
    top = _ALSO_APART * trial.excitation.band_hz[1]
    apart = [
        i
        for i, (label, hz) in enumerate(zip(system.modes.labels, system.modes.natural_frequency_hz, strict=True))
        if label not in RIGID and hz <= top
    ]
    shapes = system.modes.shapes[apart][:, : len(measured)]
    count, runs = min(wish.points, len(measured)), trial.acquisition.runs

    def grouped(points: NDArray[np.intp]) -> Runs:
        alone = worst_relative_damping(poles, each[points], places)
        nodes = [measured[int(i)].node for i in points[np.argsort(alone)]]
        return tuple(tuple(run) for run in dealt(nodes, wish.run_count(trial)))

    chosen = chosen_points(each, poles, places, shapes, count, wish.largest_mac)
    has = {node for run in runs for node in run}
    kept = [i for i, place in enumerate(measured) if place.node in has]
    if len(kept) > count:
        return [grouped(chosen)]
    own = added_points(each, poles, places, kept, count)
    if least_distinct(shapes, own) > wish.largest_mac >= least_distinct(shapes, chosen):
        return [grouped(chosen)]
    at_once = max(map(len, runs))
    as_now = len(kept) == count and len(runs) == wish.run_count(trial) and at_once <= wish.budget.sensors
    return [grouped(chosen), runs if as_now else grouped(own)]


def _judged(
    system: System,
    trial: Scenario,
    measured: Sequence[Place],
    wanted: NDArray[np.intp],
    runs: Runs,
) -> float:
    """The worst target's relative deviation of damping over all runs of a trial, sensor masses at their average."""
    low, high = trial.excitation.recorded_band_hz
    frequency = system.modes.natural_frequency_hz[wanted]
    if (frequency < low).any() or (frequency > high).any():
        return float("inf")
    swept = _with_sweep(system, trial)
    seen = seen_by(swept)
    index = {p.node: i for i, p in enumerate(measured)}
    total = None
    for run in runs:
        together = tuple(index[node] for node in run)
        poles, each = information_by_response(swept, seen, together)
        told = each[list(together)].sum(axis=0) * trial.acquisition.repeats
        total = told if total is None else total + told
    assert total is not None, "a scenario has a run at least"
    places = np.array([np.flatnonzero(seen.unknown == m)[0] for m in wanted])
    return float(worst_relative_damping(poles, total[None], places)[0])
