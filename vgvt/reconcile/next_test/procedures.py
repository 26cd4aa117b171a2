"""What a lab can change within minutes between two campaigns, and the campaign that a scenario then foretells."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.added_mass import with_lump
from vgvt.effects.beams import plain_name
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.question.holdout import Split
from vgvt.reconcile.question.problem import (
    Nominal,
    Problem,
    assembled_once,
    limit_hz,
    nuisances_of,
    slopes_in,
)
from vgvt.reconcile.question.uncertain import prepared, unknowns_of_the_rig
from vgvt.reconcile.search.candidates import places
from vgvt.scenario.airframe import Airframe
from vgvt.scenario.base import Point
from vgvt.scenario.full_scale import expected_overloads
from vgvt.scenario.mirror import expanded_beams
from vgvt.scenario.model import Scenario
from vgvt.scenario.placement import EDGE_TOLERANCE_M, placement_problems
from vgvt.scenario.planform import distance_off_m, part_at
from vgvt.simulation.command import peak_command_v
from vgvt.simulation.pushed import pushed_beams
from vgvt.simulation.reduced import Layouts, structure

_DUMMY_KG = 0.05
_AVERAGED = (4, 16)
# To move the sensors and to look at what they read.
_BETWEEN_RUNS_MIN = 3.0
# Before the first of the runs: to fix the shaker below another point, to hang up on another spring, to tape a mass on
# or to set another level and to see that nothing is overloaded.
_DRIVE_MIN, _SPRING_MIN, _SET_MIN = 20.0, 15.0, 5.0

Array = NDArray[np.float64]
Runs = tuple[tuple[int, ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Procedure:
    """A change of procedure: in words, as an edit of the scenario, and its lab time in minutes, that of all its runs.

    ``force`` multiplies what the shaker pushed with; ``sweeps`` of every run are averaged where there was one.
    ``again`` is the one run, counted from 0, that alone is made once more; without it they all are made anew.
    """

    words: str
    edit: Callable[[Scenario], Scenario]
    minutes: float
    force: float = 1.0
    sweeps: int = 1
    again: int | None = None


def levels_to_try(fits: Sequence[Fit]) -> tuple[Procedure, ...]:
    """Sweeps at other levels that the instruments take, where one of the fits holds an effect that depends on it."""
    if all(h.linear for fit in fits for h in fit.hypotheses):
        return ()
    problem = fits[0].problem
    minutes = _SET_MIN + lab_minutes(problem)
    return tuple(
        Procedure(f"sweep again with {words} the force", lambda s: s, minutes, factor)
        for words, factor in (("twice", 2.0), ("half", 0.5), ("a quarter of", 0.25))
        if factor <= 1 or not _overloads(problem, factor)
    )


def _overloads(problem: Problem, factor: float) -> bool:
    """Whether so many times the largest that was recorded, and the command that is stated, is cut off somewhere."""
    measured, stated = problem.measured, problem.stated
    force = float(np.abs(measured.pushed).max(initial=0.0))
    peaks = (force, measured.largest_m_per_s2, peak_command_v(stated))
    return bool(expected_overloads(stated, *(factor * peak for peak in peaks)))


def procedures(problem: Problem) -> tuple[Procedure, ...]:
    """What a lab can change within minutes: drive point, dummy mass, suspension, and what is measured when."""
    scenario, campaign = problem.scenario, lab_minutes(problem)
    x, y, z = scenario.shaker.position_m

    def sprung(factor: float) -> Callable[[Scenario], Scenario]:
        return lambda s: s.model_copy(
            update={
                "suspension": s.suspension.model_copy(
                    update={"stiffness_n_per_m": s.suspension.stiffness_n_per_m * factor}
                )
            }
        )

    def loaded(place: tuple[float, float]) -> Callable[[Scenario], Scenario]:
        return lambda s: with_lump(s, "dummy", _DUMMY_KG, place)

    points = [("10 cm further forward", (x - 0.1, y, z))]
    if y != 0:
        points = [("at the mirror image of the drive point", (x, -y, z)), ("on the centre line", (x, 0.0, z)), *points]
    found = [
        Procedure(f"excite {words}", partial(_driven, at=at), _DRIVE_MIN + campaign)
        for words, at in points
        if _on_the_aircraft(_driven(scenario, at), scenario.shaker.attached_to)
    ]
    found.append(Procedure("hang it on a spring half as stiff", sprung(0.5), _SPRING_MIN + campaign))
    found.append(Procedure("hang it on a spring twice as stiff", sprung(2.0), _SPRING_MIN + campaign))
    for place in places(problem):
        words = f"tape a dummy mass of {1000 * _DUMMY_KG:.0f} g at x = {place[0]:.2f} m, y = {place[1]:.2f} m"
        found.append(Procedure(words, loaded(place), _SET_MIN + campaign))
    return (*found, *_other_runs(problem), *_averages(problem))


def _driven(scenario: Scenario, at: Point) -> Scenario:
    """The scenario with its shaker below another point, fixed to the part that is there."""
    moved = {"position_m": at, "attached_to": part_at(scenario.airframe, at)}
    return scenario.model_copy(update={"shaker": scenario.shaker.model_copy(update=moved)})


def _on_the_aircraft(scenario: Scenario, before: str) -> bool:
    """Whether there is something to push on at the drive point, which was on the part ``before``.

    A part without an outline takes every point that no outline holds, however far beside it: off another part, only
    what is right over it will do.
    """
    airframe, shaker = scenario.airframe, scenario.shaker
    if placement_problems(airframe, None, shaker, None):
        return False
    stays = plain_name(shaker.attached_to) == plain_name(before)
    outlined = distance_off_m(airframe, shaker.attached_to, shaker.position_m) is not None
    return stays or outlined or _beside_m(airframe, shaker.attached_to, shaker.position_m) <= EDGE_TOLERANCE_M


def _beside_m(airframe: Airframe, part: str, at: Point) -> float:
    """How far a point is from the axis of a beam as seen from above, or from the body's plane of symmetry."""
    axes = {b.name: np.array(b.stations.position_m)[:, :2] for b in expanded_beams(airframe)}
    if part not in axes:
        return abs(at[1] - airframe.body.centre_of_gravity_m[1])
    start, step = axes[part][:-1], np.diff(axes[part], axis=0)
    arm = np.array(at[:2]) - start
    # From above a fin is a point.
    length = np.maximum((step**2).sum(axis=1), np.finfo(float).tiny)
    along = np.clip((arm * step).sum(axis=1) / length, 0.0, 1.0)
    return float(np.linalg.norm(arm - along[:, None] * step, axis=1).min())


def lab_minutes(problem: Problem, sweeps: int = 1) -> float:
    """How long all runs of a campaign take, of some sweeps each; sensors that stay for the next run are not moved."""
    runs = problem.measured.runs
    moved = sum(k == 0 or run != runs[k - 1] for k, run in enumerate(runs))
    return moved * _BETWEEN_RUNS_MIN + len(runs) * sweeps * _sweep_min(problem)


def _sweep_min(problem: Problem) -> float:
    return problem.scenario.excitation.whole_s / 60


def _averages(problem: Problem) -> list[Procedure]:
    """What takes noise away where nothing but noise keeps two explanations together."""
    return [
        Procedure(f"average {count} sweeps in every run", lambda s: s, lab_minutes(problem, count), sweeps=count)
        for count in _AVERAGED
    ]


def _other_runs(problem: Problem) -> list[Procedure]:
    """What tells an instrument from the point where it sat, and what happened in the meantime from either."""
    runs, numbers = problem.measured.runs, problem.measured.run_numbers

    def measured(after: Runs) -> Callable[[Scenario], Scenario]:
        return lambda s: s.model_copy(update={"acquisition": s.acquisition.with_runs(after)})

    found = []
    if len(runs) > 1:
        one = _BETWEEN_RUNS_MIN + _sweep_min(problem)
        found += [
            Procedure(f"make run {numbers[k]} once more after the last", measured((*runs, run)), one, again=k)
            for k, run in enumerate(runs)
        ]
    if any(len(run) > 1 for run in runs):
        words = "exchange the sensors: every run again with their places in reverse order"
        found.append(Procedure(words, measured(tuple(run[::-1] for run in runs)), lab_minutes(problem)))
    return found


def changed(problem: Problem, procedure: Procedure) -> Problem:
    """The problem of a campaign by a changed procedure, the data of the first standing in for its own.

    It comes after the first: what changed from run to run is as far in it as the last of these had it, and the records
    of a first campaign that one run is added to stay what they were.
    """
    runs, scenario = len(problem.measured.runs), procedure.edit(problem.scenario)
    made = (runs,) * runs if procedure.again is None else (*range(1, runs + 1), runs)
    scenario = scenario.model_copy(update={"acquisition": scenario.acquisition.counted_as(made)})
    moved = scenario.shakers != problem.scenario.shakers
    if not (moved and {*pushed_beams(scenario), *pushed_beams(problem.scenario)}):
        start = prepared(scenario)
        layouts = Layouts.of(start)
        layout = layouts.plan(start)
        nominal = Nominal(start, layouts, structure(layout, layout.grid, problem.nominal))
        slopes = _slopes_of_another_rig(problem, start, nominal)
    else:
        # A beam's cells end where it is pushed, and it bends with the push: nothing that is known of another is of use.
        stated = procedure.edit(problem.stated)
        stated = stated.model_copy(update={"acquisition": scenario.acquisition})
        _, nominal, slopes, finer, span = assembled_once(scenario, stated, limit_hz(problem.measured), None)
        problem = replace(problem, stated=stated, refinement=finer, coarseness=span, centre=None)
    if scenario.acquisition.runs != problem.scenario.acquisition.runs:
        problem = _rearranged(problem, scenario, procedure.again)
    measured = problem.measured
    if procedure.force != 1:
        pushed, force = procedure.force * measured.pushed, procedure.force * measured.force
        measured = replace(measured, pushed=pushed, force=force)
    # Noise of the instruments is what it is, and counts for less in A/F the harder the push and the more sweeps are
    # averaged. The model's own error does neither.
    noise = measured.noise / (procedure.force**2 * procedure.sweeps)
    measured = replace(measured, noise=noise, sigma=np.sqrt(measured.sigma**2 - measured.noise + noise))
    return replace(problem, scenario=scenario, measured=measured, start=nominal, slopes=slopes)


def _slopes_of_another_rig(problem: Problem, start: Scenario, nominal: Nominal) -> dict[str, Array]:
    """The slopes, those of the rig's own unknowns anew where that is another: half a spring has half of its slope."""
    before = problem.start.scenario
    if (start.suspension, start.shakers, start.transducer) == (before.suspension, before.shakers, before.transducer):
        return problem.slopes
    known = unknowns_of_the_rig(start)
    rows = [[k.name for k in problem.unknowns].index(k.name) for k in known]
    fresh = slopes_in(start, known, nominal.layouts, nominal.structure)
    found = {}
    for name, values in problem.slopes.items():
        found[name] = values.copy()
        found[name][rows] = fresh[name]
    return found


def _rearranged(problem: Problem, scenario: Scenario, again: int | None) -> Problem:
    """The problem of other runs over the same points: each point's data as it was first measured, wherever it is now.

    A run ``again`` (from 0) is there to be fitted; of the rest the same channels are held out.
    """
    first, runs = problem.measured, scenario.acquisition.runs
    row = {(c.run, c.dof.node): i for i, c in enumerate(first.channels)}
    # By its index: several runs may have the same sensors, at other levels of force.
    came = [*range(len(first.runs)), *([] if again is None else [again])]
    # Unknowns are known by their channels' labels: what was there keeps its number.
    numbers = list(first.run_numbers)
    numbers += [max(numbers) + 1 + k for k in range(len(runs) - len(numbers))]
    channels, index = [], []
    for k, run in enumerate(runs):
        for place, node in enumerate(run):
            index.append(row[came[k], node])
            channels.append(replace(first.channels[index[-1]], run=k, run_number=numbers[k], instrument=place))
    extra = first.used[index] & np.array([c.run >= len(first.runs) for c in channels])
    measured = replace(
        first, channels=tuple(channels), runs=runs, values=first.values[index], noise=first.noise[index],
        sigma=first.sigma[index], variances={name: v[index] for name, v in first.variances.items()},
        force=first.force[came], pushed=first.pushed[came],
        endings=tuple(first.endings[k] for k in came) if first.endings else (),
        lost=None if first.lost is None else first.lost[index],
        of_force=None if first.of_force is None else first.of_force[index],
    )  # fmt: skip
    parts = problem.split
    split = Split(parts.train[index] | extra, parts.held_runs[index] & ~extra, parts.held_channels[index] & ~extra)
    return replace(problem, measured=measured, split=split, nuisances=nuisances_of(scenario, measured))
