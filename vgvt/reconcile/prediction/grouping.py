"""Runs that an effect treats alike share a structure: from a scenario, scores and hypotheses to assembled groups."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError, PluginError
from vgvt.effects.acting import acted
from vgvt.effects.action import Action
from vgvt.effects.protocol import Effect
from vgvt.effects.registry import effects_of
from vgvt.reconcile.mechanics.refinement import Refinement
from vgvt.reconcile.question.hypothesis import Hypothesis, refused
from vgvt.reconcile.question.problem import CELLS, Problem
from vgvt.reconcile.question.uncertain import edited
from vgvt.scenario.model import Scenario
from vgvt.simulation.assembly import Plan
from vgvt.simulation.reduced import Structure, structure
from vgvt.simulation.seats import MeasurementPoint

Array = NDArray[np.float64]
# Of all damping, what no slope changes in a step of some thousandths of a deviation.
_EDGE = 0.05
# Assemblies; each is about a megabyte.
_KEPT = 24


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Runs of one structure: its plan and matrices at the anchor, rows of its channels, their sensors' masses.

    ``channels`` (C_g,) index the campaign's; ``rows`` (C_g,) the structure's places; ``masses_kg`` (C_g,).
    ``filtered`` where any run of the campaign has an effect on its channels.
    """

    plan: Plan
    structure: Structure
    channels: NDArray[np.intp]
    rows: NDArray[np.intp]
    masses_kg: Array
    filtered: bool = False


def cells_at(problem: Problem, u: Array) -> float:
    """How far the scores u lead from the continuum towards the chain as stated."""
    return CELLS.amount(float(u[problem.unknowns.index(CELLS)]))


def sensor_mass(problem: Problem, u: Array) -> float:
    """What the scores u make of every sensor's own mass, kg: whatever effects add to it stays as it is."""
    index = sensor_mass_index(problem)
    stated = problem.scenario.accelerometers.mass_kg
    return stated if index is None else stated * problem.unknowns[index].amount(float(u[index]))


def sensor_mass_index(problem: Problem) -> int | None:
    """Which unknown scales the sensors' mass; None where none does."""
    return _index(problem, "sensor mass")


def end_mass_index(problem: Problem) -> int | None:
    """Which unknown scales the transducer's mass on the structure's side; None where none does."""
    return _index(problem, "transducer end mass")


def _index(problem: Problem, name: str) -> int | None:
    names = [k.name for k in problem.unknowns]
    return names.index(name) if name in names else None


class NoStructureError(ValueError):
    """The parameters describe no aircraft that hangs."""


def effects_at(problem: Problem, hypotheses: Sequence[Hypothesis], e: Array) -> tuple[Effect, ...] | None:
    """The scenario's own effects, then the hypotheses' at scores e; None where one refuses its values, or fails."""
    made: list[Effect] = list(effects_of(problem.scenario))
    start = 0
    for hypothesis in hypotheses:
        count = len(hypothesis.parameters)
        effect = hypothesis.effect(hypothesis.values(e[start : start + count]))
        start += count
        if effect is None:
            return None
        made.append(effect)
    return tuple(made)


def run_actions(
    scenario: Scenario, effects: tuple[Effect, ...], runs: int
) -> list[tuple[Scenario, tuple[Action, ...]]]:
    """What effects make of every one of ``runs`` runs: the edited scenario and the actions, in their order.

    Somebody else's effect that fails is refused like one that cannot be had, by NoStructureError, but not without a
    word.
    """
    try:
        return [acted(effects, scenario, run) for run in range(runs)]
    except PluginError as error:
        refused(error)
        raise NoStructureError(str(error)) from error


def refined_rows(problem: Problem, cells: float, s: Structure, site: str) -> Array:
    """What a sensor's row (n,) of a structure lacks of a continuum's, at its place or its home on the grid."""
    row = np.zeros(len(s.joints))
    index = np.array([s.joints.index(j) for j in problem.nominal.joints])
    for share, part in ((1.0, problem.refinement), (cells, problem.coarseness)):
        row[index] += share * part.axis[part.places.index(home(site))]
    return row


def spare_flexibility(problem: Problem, cells: float, s: Structure, rows: NDArray[np.intp]) -> Array:
    """Static flexibility (rows,), m/N, that a structure's highest modes lack of a continuum's."""
    return _of_places(problem.refinement, s, rows) + cells * spare_by_cells(problem, s, rows)


def spare_by_cells(problem: Problem, s: Structure, rows: NDArray[np.intp]) -> Array:
    """What of :func:`spare_flexibility` (rows,), m/N, there is per unit of what leads to the chain as stated."""
    return _of_places(problem.coarseness, s, rows)


def _of_places(part: Refinement, s: Structure, rows: NDArray[np.intp]) -> Array:
    return part.flexibility[[part.places.index(home(s.places[r])) for r in rows]]


def refined(s: Structure, problem: Problem, cells: float) -> Structure:
    """The structure with what makes up for its cells: at -1 it is the chain as stated, at 0 a continuum."""
    stiffness, damping, axis, drive = s.stiffness.copy(), s.damping.copy(), s.axis.copy(), s.drive.copy()
    index = np.array([s.joints.index(j) for j in problem.nominal.joints])
    for share, part in ((1.0, problem.refinement), (cells, problem.coarseness)):
        stiffness[np.ix_(index, index)] += share * part.stiffness
        damping[np.ix_(index, index)] += share * part.damping
        drive[index] += share * part.drive
        for k, place in enumerate(s.places):
            axis[k, index] += share * part.axis[part.places.index(home(place))]
    return replace(s, stiffness=stiffness, damping=damping, axis=axis, drive=drive)


def assembled(
    problem: Problem,
    u: Array,
    hypotheses: tuple[Hypothesis, ...],
    e: Array,
) -> tuple[Group, ...] | None:
    """The groups of runs that share a structure, each assembled; None where the parameters are impossible."""
    packed, own = (np.asarray(scores, dtype=np.float64).tobytes() for scores in (u, e))
    try:
        return _assembled(problem, packed, hypotheses, own)
    except (InputError, RuntimeError, ValueError, OverflowError, np.linalg.LinAlgError):
        return None


# Every candidate's fit begins where the one before began, and slopes are taken where a step has arrived. What fails is
# tried anew, and told anew.
@lru_cache(maxsize=_KEPT)
def _assembled(problem: Problem, packed: bytes, hypotheses: tuple[Hypothesis, ...], own: bytes) -> tuple[Group, ...]:
    u, made = np.frombuffer(packed), effects_at(problem, hypotheses, np.frombuffer(own))
    if made is None:
        raise NoStructureError("an effect refuses its values")
    base = _base(problem, packed)[0]
    per_run = run_actions(base, made, len(problem.measured.runs))
    kinds: list[tuple[Scenario, tuple[Action, ...], list[int]]] = []
    for run, (scenario, actions) in enumerate(per_run):
        for known_scenario, known_actions, runs in kinds:
            if _same(scenario, known_scenario, actions, known_actions):
                runs.append(run)
                break
        else:
            kinds.append((scenario, actions, [run]))
    # Any run, not a group's first: runs of one structure may differ in what effects do to their channels.
    filtered = any(action.channels for _, actions in per_run for action in actions)
    groups = (_group(problem, u, s, a, runs) for s, a, runs in kinds)
    return tuple(replace(g, filtered=filtered) for g in groups)


def parted(ends: Sequence[tuple[Group, ...]]) -> list[tuple[Group, ...]]:
    """Groups of the same channels, each end parted as all of them are, in one order: as it was where it is so already.

    At the size that does nothing an effect leaves together what it parts a step away. Runs that are added to what is
    known come in the order of that, and those that are assembled in their own.
    """
    home = [{channel: k for k, group in enumerate(end) for channel in group.channels.tolist()} for end in ends]
    pieces: dict[tuple[int, ...], list[int]] = {}
    for group in ends[0]:
        for channel in group.channels.tolist():
            pieces.setdefault(tuple(of[channel] for of in home), []).append(channel)
    if all(list(pieces.values()) == [group.channels.tolist() for group in end] for end in ends):
        return list(ends)
    known: dict[tuple[int, int], Group] = {}

    def piece(group: Group, number: int, channels: list[int]) -> Group:
        # What several ends share they share in parts, too.
        if (id(group), number) not in known:
            at = np.flatnonzero(np.isin(group.channels, channels))
            whole = at.size == group.channels.size
            known[id(group), number] = (
                group
                if whole
                else replace(group, channels=group.channels[at], rows=group.rows[at], masses_kg=group.masses_kg[at])
            )
        return known[id(group), number]

    return [
        tuple(piece(end[places[k]], number, channels) for number, (places, channels) in enumerate(pieces.items()))
        for k, end in enumerate(ends)
    ]


def changed_places(here: Sequence[Group], there: Sequence[Group]) -> bool:
    """Whether modes have changed places between groups a slope's step apart, and taken each other's damping ratio.

    A scenario states ratios by the modes' order: where two of them meet, damping falls over an edge, and a difference
    across it is no slope.
    """
    return any(
        float(np.linalg.norm(b.structure.damping - a.structure.damping))
        > _EDGE * float(np.linalg.norm(a.structure.damping))
        for a, b in zip(here, there, strict=True)
    )


@lru_cache(maxsize=8)
def _base(problem: Problem, scores: bytes) -> tuple[Scenario, Plan]:
    """The scenario at some scores, and its plan: what thousands of candidates are added to.

    NoStructureError where a factor has rounded to nothing, or to more than a number holds.
    """
    base = edited(problem.scenario, problem.unknowns, np.frombuffer(scores)[: len(problem.unknowns)])
    # Effects divide by what a beam has, as every scenario that is read has some of it.
    for beam in base.airframe.beam:
        s = beam.stations
        columns = (s.bending_stiffness_n_m2, s.torsional_stiffness_n_m2, s.mass_kg_per_m, s.pitch_inertia_kg_m)
        if not all(0 < value < np.inf for column in columns for value in column):
            raise NoStructureError(f"nothing is left of {beam.name}")
    return base, problem.layouts.plan(base)


def _same(one: Scenario, other: Scenario, actions: tuple[Action, ...], others: tuple[Action, ...]) -> bool:
    if [a.elements for a in actions] != [a.elements for a in others]:
        return False
    if [a.points for a in actions] != [a.points for a in others]:
        return False
    return one is other or one == other


@lru_cache(maxsize=64)
def _planned(problem: Problem, scenario: Scenario) -> Plan:
    """The plan of an edited scenario: a scan over an effect's sizes often edits it alike."""
    return problem.layouts.plan(scenario)


def _group(
    problem: Problem,
    u: Array,
    scenario: Scenario,
    actions: tuple[Action, ...],
    runs: list[int],
) -> Group:
    known, base_plan = _base(problem, u.tobytes())
    leans = any(p.node == base_plan.drive.dof.node for a in actions for p in a.points)
    if scenario is known and not leans:
        plan = replace(base_plan, actions=actions)
    elif not leans:
        plan = replace(_planned(problem, scenario), actions=actions)
    else:
        plan = problem.layouts.plan(scenario, actions)
    points: dict[str, MeasurementPoint] = {p.site: p for p in plan.grid}
    channels, sites = [], []
    seated = {run: {p.dof.node: p for p in plan.run_points(run)} for run in runs}
    for i, channel in enumerate(problem.measured.channels):
        if channel.run in seated:
            point = seated[channel.run][channel.dof.node]
            points[point.site] = point
            channels.append(i)
            sites.append(point.site)
    found = refined(structure(plan, tuple(points.values()), problem.nominal), problem, cells_at(problem, u))
    rows = np.array([found.places.index(site) for site in sites])
    masses = np.full(len(rows), scenario.accelerometers.mass_kg)
    return Group(plan, found, np.array(channels), rows, masses)


def home(site: str) -> str:
    """The grid point that a misplaced sensor sits on or next to, of which it borrows slopes: a site's own else."""
    return site.rpartition("-at-")[2] if site.startswith("misplaced-") else site
