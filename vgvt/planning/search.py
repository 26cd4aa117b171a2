"""The search for the best plan: every place of the shaker, sensors chosen for it, sweeps compared, all by Fisher."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.planning.budget import AS_DESCRIBED, MOUNT_EFFECT, MOUNTS, Budget, Mount
from vgvt.planning.places import Place, sensor_places, shaker_places, with_places, with_shaker_at
from vgvt.planning.proposal import RIGID, Proposal, proposal
from vgvt.planning.selection import chosen_points, dealt, worst_relative_damping
from vgvt.planning.system import System, information_by_response, seen_by, systems_of
from vgvt.scenario.effect import EffectTable
from vgvt.scenario.model import Scenario
from vgvt.scenario.rig import Excitation

Progress = Callable[[float, str], None]

FREE = ("shaker", "sensors", "band", "sweep-time", "level", "mount")
"""What a search may change."""
_SEVERAL_MOUNTS = 3  # best places of the shaker that are tried with another mount
_FINALISTS = 6
_BELOW, _ABOVE = (0.6, 0.75, 0.85), (1.1, 1.25)
_ALSO_APART = 1.5  # modes up to this factor above the band should have shapes that can be told apart, too


@dataclass(frozen=True, slots=True, eq=False)
class Wish:
    """What is looked for: the target modes, what is free, the limits."""

    targets: tuple[tuple[str, float], ...]
    free: frozenset[str]
    budget: Budget
    points: int
    largest_amplitude_v: float
    largest_mac: float = 0.25


@dataclass(frozen=True, slots=True, eq=False)
class _Sketch:
    """A candidate before it is predicted in full."""

    scenario: Scenario
    mount: Mount
    place: Place
    worst: float


def best_plans(scenario: Scenario, wish: Wish, progress: Progress | None = None) -> list[Proposal]:
    """The best plans for a scenario, the best one first, each with another place or mount of the shaker."""
    report = progress or (lambda _fraction, _text: None)
    places = shaker_places(scenario) if "shaker" in wish.free else shaker_places(scenario)[:1]
    sketches: list[_Sketch] = []
    for k, place in enumerate(places):
        report(0.6 * k / len(places), f"place {k + 1} of {len(places)} for the shaker")
        sketches += _sketches(scenario, wish, AS_DESCRIBED, place)
    if "mount" in wish.free:
        leaders = sorted(sketches, key=lambda s: s.worst)[:_SEVERAL_MOUNTS]
        for mount in MOUNTS[1:]:
            for leader in leaders:
                report(0.65, f"{mount.name} at the best places")
                sketches += _sketches(scenario, wish, mount, leader.place)
    finalists = sorted(sketches, key=lambda s: s.worst)[:_FINALISTS]
    plans = []
    for k, sketch in enumerate(finalists):
        report(0.7 + 0.3 * k / len(finalists), f"finalist {k + 1} of {len(finalists)}")
        plans.append(proposal(f"plan-{k + 1}", sketch.scenario, wish.budget, wish.targets, sketch.mount))
    plans.sort(key=lambda p: p.worst_relative_damping_std)
    return [replace(plan, name=f"plan-{k + 1}") for k, plan in enumerate(plans)]


def with_mount(scenario: Scenario, mount: Mount) -> Scenario:
    """The scenario with the effect of a mount in place of the one it has."""
    if not mount.effect:
        return scenario
    table = EffectTable(name=MOUNT_EFFECT, **dict(mount.effect))
    others = tuple(e for e in scenario.effect if e.name != MOUNT_EFFECT)
    return scenario.model_copy(update={"effect": (*others, table)})


def _sketches(scenario: Scenario, wish: Wish, mount: Mount, place: Place) -> list[_Sketch]:
    """The best sensors and sweep for one place and mount; nothing where the aircraft would not hang."""
    mounted = with_mount(scenario, mount)
    if place.position_m != scenario.shaker.position_m:
        mounted = with_shaker_at(mounted, place)
    measured = _measured(mounted, wish)
    system = systems_of(with_places(mounted, measured, [_spread(measured, wish)]))[0]
    wanted = _wanted(system, wish)
    if wanted is None:
        return []
    runs = _run_count(mounted, wish)
    sweeps = [_at_level(e, wish) for e in _excitations(mounted.excitation, wish)]
    first = _timed(mounted, sweeps[0], runs, wish, mount)
    nodes = _chosen(system, first, measured, wanted, wish) if "sensors" in wish.free else None
    best: _Sketch | None = None
    for excitation in sweeps:
        trial = _timed(mounted, excitation, runs, wish, mount)
        worst = _judged(system, trial, measured, wanted, nodes, wish)
        if best is None or worst < best.worst:
            best = _Sketch(trial, mount, place, worst)
    assert best is not None, "there is one excitation at least"
    if nodes is None:
        return [best]
    chosen = [p for p in measured if p.node in nodes]
    return [replace(best, scenario=with_places(best.scenario, chosen, dealt(nodes, runs)))]


def _measured(scenario: Scenario, wish: Wish) -> tuple[Place, ...]:
    places = sensor_places(scenario)
    return places if "sensors" in wish.free else places[: len(scenario.accelerometers.grid.node)]


def _spread(places: Sequence[Place], wish: Wish) -> list[int]:
    """Some nodes all over the aircraft, as many as are measured at once: what their mass does, wherever they go."""
    count = min(wish.budget.sensors, wish.points, len(places))
    order = sorted(places, key=lambda p: p.position_m[1])
    return [order[int(k)].node for k in np.unique(np.linspace(0, len(order) - 1, count).astype(int))]


def _run_count(scenario: Scenario, wish: Wish) -> int:
    if "sensors" not in wish.free:
        return len(scenario.acquisition.runs)
    return math.ceil(wish.points / wish.budget.sensors)


def _excitations(e: Excitation, wish: Wish) -> Iterator[Excitation]:
    """The scenario's own and, with a free band, sweeps around the targets, linear and logarithmic."""
    yield e
    if "band" not in wish.free:
        return
    low, high = wish.targets[0][1], wish.targets[-1][1]
    starts = {round(low * factor, 1) for factor in _BELOW} | {e.band_hz[0]}
    stops = {round(high * factor, 1) for factor in _ABOVE} | {e.band_hz[1]}
    for kind in ("linear-chirp", "logarithmic-chirp"):
        for start in sorted(s for s in starts if s > 0):
            for stop in sorted(s for s in stops if s > start):
                keys = {"kind": kind, "start_hz": start, "stop_hz": stop, "amplitude_v": e.amplitude_v}
                silences = {"lead_in_s": e.lead_in_s, "ring_down_s": e.ring_down_s, "taper_s": e.taper_s}
                yield Excitation(duration_s=e.duration_s, **keys, **silences)  # type: ignore[arg-type]


def _at_level(e: Excitation, wish: Wish) -> Excitation:
    return e.model_copy(update={"amplitude_v": wish.largest_amplitude_v}) if "level" in wish.free else e


def _timed(scenario: Scenario, e: Excitation, runs: int, wish: Wish, mount: Mount) -> Scenario:
    swept = scenario.model_copy(update={"excitation": e})
    if "sweep-time" not in wish.free:
        return swept
    duration, repeats = wish.budget.sweep(swept, runs, mount)
    return swept.model_copy(
        update={
            "excitation": e.model_copy(update={"duration_s": duration}),
            "acquisition": scenario.acquisition.model_copy(update={"repeats": repeats}),
        }
    )


def _with_sweep(system: System, trial: Scenario) -> System:
    scenario = system.layout.scenario.model_copy(update={"excitation": trial.excitation})
    return replace(system, layout=replace(system.layout, scenario=scenario))


def _wanted(system: System, wish: Wish) -> NDArray[np.intp] | None:
    """Indices of the target modes among all modes, None where one of them is gone."""
    found = []
    for label, hz in wish.targets:
        ratio = np.abs(system.modes.natural_frequency_hz / hz - 1)
        same = [i for i in np.flatnonzero(ratio < 0.1) if system.modes.labels[i] == label]
        near = same or list(np.flatnonzero(ratio < 0.1))
        if not near:
            return None
        found.append(min(near, key=lambda i: ratio[i]))
    return np.array(found, dtype=np.intp)


def _chosen(
    system: System, trial: Scenario, measured: Sequence[Place], wanted: NDArray[np.intp], wish: Wish
) -> list[int]:
    """Nodes of the points to measure, in order of what they tell of the mode that is known worst."""
    seen = seen_by(_with_sweep(system, trial))
    poles, each = information_by_response(system, seen, system.sensors)
    places = np.array([np.flatnonzero(seen.unknown == m)[0] for m in wanted if m in seen.unknown])
    points = len(measured)
    top = _ALSO_APART * trial.excitation.band_hz[1]
    apart = [
        i
        for i, (label, hz) in enumerate(zip(system.modes.labels, system.modes.natural_frequency_hz, strict=True))
        if label not in RIGID and hz <= top
    ]
    shapes = system.modes.shapes[apart][:, :points]
    chosen = chosen_points(each[:points], poles, places, shapes, min(wish.points, points), wish.largest_mac)
    alone = worst_relative_damping(poles, each[chosen], places)
    return [measured[int(i)].node for i in chosen[np.argsort(alone)]]


def _judged(
    system: System,
    trial: Scenario,
    measured: Sequence[Place],
    wanted: NDArray[np.intp],
    nodes: list[int] | None,
    wish: Wish,
) -> float:
    """The worst target's relative deviation of damping over all runs of a trial, sensor masses at their average."""
    swept = _with_sweep(system, trial)
    seen = seen_by(swept)
    low, high = trial.excitation.band_hz
    frequency = system.modes.natural_frequency_hz[wanted]
    if (frequency < low).any() or (frequency > high).any():
        return float("inf")
    index = {p.node: i for i, p in enumerate(measured)}
    runs = dealt(nodes, _run_count(trial, wish)) if nodes is not None else trial.acquisition.runs
    total = None
    for run in runs:
        together = tuple(index[node] for node in run)
        poles, each = information_by_response(swept, seen, together)
        told = each[list(together)].sum(axis=0) * trial.acquisition.repeats
        total = told if total is None else total + told
    assert total is not None, "a scenario has a run at least"
    places = np.array([np.flatnonzero(seen.unknown == m)[0] for m in wanted])
    return float(worst_relative_damping(poles, total[None], places)[0])
