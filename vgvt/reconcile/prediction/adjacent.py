"""Structures next to assembled ones, by adding what an effect changes: what a scan over thousands of variants affords.

What an effect edits is taken from the nominal aircraft, where it is assembled once for all scores: an error of second
order, the product of two small changes. A fit that follows assembles the whole rig.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.effects.acting import acted
from vgvt.effects.action import Action
from vgvt.effects.elements import Element, GroundSpring
from vgvt.effects.protocol import Effect
from vgvt.reconcile.prediction.acts_known import action_known
from vgvt.reconcile.prediction.grouping import Group, assembled, cells_at, effects_at, home, refined_rows
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Nominal, Problem
from vgvt.scenario.model import Scenario
from vgvt.simulation.airframe import ROOT_JOINTS, elastic_joints
from vgvt.simulation.assembly import Plan
from vgvt.simulation.attached import attach, sensed_at
from vgvt.simulation.damping import RIGID_MODES
from vgvt.simulation.reduced import Structure, structure
from vgvt.simulation.seats import MeasurementPoint

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Change:
    """What an effect does to some runs of the nominal aircraft: its action there, and what it edits.

    ``runs`` count from 0; ``before`` is the scenario that the effect finds, ``layout`` the edited plan and its actions.
    ``filtered`` where it changes the channels of any run of the campaign: runs of one structure may differ in that.
    """

    runs: frozenset[int]
    action: Action
    before: Scenario
    layout: Plan
    filtered: bool

    @property
    def edits(self) -> bool:
        """Whether the effect changes the scenario."""
        return self.before != self.layout.scenario

    @property
    def sensor_mass_kg(self) -> float:
        """What the effect adds to each sensor's mass."""
        return self.layout.scenario.accelerometers.mass_kg - self.before.accelerometers.mass_kg


def groups_at(
    problem: Problem,
    u: Array,
    hypotheses: tuple[Hypothesis, ...],
    e: Array,
    known: tuple[Group, ...] | None = None,
) -> tuple[Group, ...] | None:
    """Groups at scores u and e, next to those ``known`` (without the last hypothesis) where that is enough."""
    near = None if known is None else beside(problem, u, known, hypotheses, e)
    return assembled(problem, u, hypotheses, e) if near is None else near


def beside(
    problem: Problem,
    u: Array,
    known: tuple[Group, ...],
    hypotheses: tuple[Hypothesis, ...],
    e: Array,
    start: Nominal | None = None,
) -> tuple[Group, ...] | None:
    """Groups with the last hypothesis added to those without it; None where only assembling will do.

    What it adds follows from the aircraft ``start``, by default the nominal one.
    """
    made = effects_at(problem, hypotheses, e)
    return None if made is None else adjacent(problem, known, cells_at(problem, u), made[:-1], made[-1], start)


def adjacent(
    problem: Problem,
    known: Sequence[Group],
    cells: float,
    others: tuple[Effect, ...],
    effect: Effect,
    start: Nominal | None = None,
) -> tuple[Group, ...] | None:
    """The groups ``known``, in which ``others`` act, with one more effect; None where only assembling will do.

    What it adds follows from the aircraft ``start``, by default the nominal one.
    """
    try:
        # Not every effect can be hashed: one of somebody else's may hold a list.
        told = _changes if _hashable((*others, effect)) else _changes.__wrapped__
        changes: tuple[Change, ...] = told(start or problem.start, others, effect)  # type: ignore[arg-type]
        found = []
        for group in known:
            run_of = np.array([problem.measured.channels[i].run for i in group.channels])
            for change in changes:
                chosen = np.isin(run_of, list(change.runs))
                moved = _moved(problem, cells, group, change, chosen) if chosen.any() else None
                if moved is not None:
                    found.append(moved)
                elif chosen.any():
                    return None
    except (InputError, RuntimeError, ValueError, np.linalg.LinAlgError):
        return None
    filtered = any(c.filtered for c in changes)
    return tuple(replace(g, filtered=g.filtered or filtered) for g in found)


def _hashable(effects: tuple[Effect, ...]) -> bool:
    try:
        hash(effects)
    except TypeError:
        return False
    return True


def _moved(problem: Problem, cells: float, group: Group, change: Change, chosen: NDArray[np.bool_]) -> Group | None:
    """The chosen channels of a group under a change."""
    s, layout, action = group.structure, change.layout, change.action
    if any(p.node == layout.drive.dof.node and np.any(p.lean) for p in action.points):
        return None
    if change.edits:
        start = problem.start
        before = _bare(start, change.before)
        if set(before.joints) != set(elastic_joints(layout.parts)) | set(ROOT_JOINTS):
            # A hinge more or less: assembling it here would tell nothing else.
            return None
        widened = _added(s, before, _bare(start, layout.scenario))
        if widened is None:
            return None
        s = widened
    rows = group.rows[chosen]
    if action.points:
        astray = {p.node for p in action.points}
        sites = [s.places[r] for r in rows]
        seats: dict[str, MeasurementPoint] = {}
        for k, i in enumerate(group.channels[chosen]):
            channel = problem.measured.channels[i]
            if channel.dof.node in astray:
                point = next(p for p in layout.run_points(channel.run) if p.dof.node == channel.dof.node)
                seats[point.site] = point
                sites[k] = point.site
        if seats:
            s = _seated(problem, cells, s, layout, tuple(seats.values()))
            rows = np.array([s.places.index(site) for site in sites])
    if action.elements:
        last = len(layout.actions) - 1
        with_elements = attach(s, layout, [(f"effect-{last}-{k}", e) for k, e in enumerate(action.elements)])
        if with_elements is None:
            return None
        s = with_elements
    return Group(
        layout, s, group.channels[chosen], rows, group.masses_kg[chosen] + change.sensor_mass_kg, group.filtered
    )


@lru_cache(maxsize=4096)
def _changes(start: Nominal, others: tuple[Effect, ...], effect: Effect) -> tuple[Change, ...]:
    """What an effect does to the nominal aircraft, runs that it treats alike together."""
    kinds: list[tuple[Scenario, Scenario, tuple[Action, ...], list[int]]] = []
    filtered = False
    for run in range(len(start.scenario.acquisition.run_nodes)):
        scenario, found = acted(others, start.scenario, run, action_known)
        edited, actions = acted((*others, effect), start.scenario, run, action_known)
        carried = _carried_along(found, actions)
        if carried:
            actions = (*actions[:-1], replace(actions[-1], elements=(*actions[-1].elements, *carried)))
        filtered = filtered or bool(actions[-1].channels)
        for before, after, known, runs in kinds:
            alike = [(a.elements, a.points) for a in actions] == [(a.elements, a.points) for a in known]
            # Filters differ by run too, but it is the prediction's chain that asks for them.
            if alike and (before is scenario or before == scenario) and (after is edited or after == edited):
                runs.append(run)
                break
        else:
            kinds.append((scenario, edited, actions, [run]))
    return tuple(
        Change(frozenset(runs), actions[-1], before, _layout(start, after, actions), filtered)
        for before, after, actions, runs in kinds
    )


def _carried_along(before: Sequence[Action], after: Sequence[Action]) -> list[Element]:
    """What takes the springs of other effects that an effect carries along with their sensors off, and puts them on."""
    elements: list[Element] = []
    for one, other in zip(before, after, strict=False):
        for old, new in zip(one.elements, other.elements, strict=False):
            if isinstance(old, GroundSpring) and isinstance(new, GroundSpring) and old.node is not None and old != new:
                off = replace(old, stiffness_n_per_m=-old.stiffness_n_per_m, damping_n_s_per_m=-old.damping_n_s_per_m)
                elements += [off, new]
    return elements


def _layout(start: Nominal, scenario: Scenario, actions: tuple[Action, ...]) -> Plan:
    """The plan of an edited scenario: a scan over an effect's sizes often edits it alike."""
    drive = start.layouts.first.drive.dof.node
    if any(p.node == drive for a in actions for p in a.points):
        return start.layouts.plan(scenario, actions)
    return replace(_cut(start, scenario), actions=actions)


@lru_cache(maxsize=256)
def _cut(start: Nominal, scenario: Scenario) -> Plan:
    return start.layouts.plan(scenario)


# What a screen asks for at every stand: the variants' first steps.
@lru_cache(maxsize=512)
def _bare(start: Nominal, scenario: Scenario) -> Structure:
    """A scenario without any element, with the sensors where the grid says."""
    if scenario == start.scenario:
        return start.structure
    layout = start.layouts.plan(scenario)
    return structure(layout, layout.grid, start.structure)


def _added(s: Structure, before: Structure, after: Structure) -> Structure | None:
    """``s`` with the difference of two structures of the nominal aircraft; None where they differ in coordinates.

    A new hinge hardly moves any mass of its own: its row beside another aircraft's would not be one of a mass matrix.
    """
    if before.joints != after.joints or before.body_names != after.body_names or before.places != after.places:
        return None
    if s.body_names != before.body_names or not set(before.joints) <= set(s.joints):
        return None
    before, after = before.onto(s.joints), after.onto(s.joints)
    place = [before.places.index(home(p)) for p in s.places]
    stiffer = _stiffer(s, before)
    return replace(
        s,
        mass=s.mass + after.mass - before.mass,
        damping=s.damping + stiffer[:, None] * (after.damping - before.damping) * stiffer,
        stiffness=s.stiffness + stiffer[:, None] * (after.stiffness - before.stiffness) * stiffer,
        drive=s.drive + after.drive - before.drive,
        jacobian=s.jacobian + (after.jacobian - before.jacobian)[place],
        axis=s.axis + (after.axis - before.axis)[place],
        tilt=s.tilt + (after.tilt - before.tilt)[place],
        bodies=s.bodies + after.bodies - before.bodies,
    )


def _stiffer(s: Structure, nominal: Structure) -> Array:
    """Square roots (n,) of how many times as stiff a structure's elastic joints are as the nominal aircraft's.

    An edit of the airframe changes joints by a share of what they have: of a wing that is 7 % softer a difference of
    15 % takes 1 % less, which is the width of a resonance.
    """
    here, there = np.diag(s.stiffness), np.diag(nominal.stiffness)
    elastic = (here > 0) & (there > 0)
    elastic[:RIGID_MODES] = False
    return np.sqrt(np.divide(here, there, out=np.ones(here.size), where=elastic))


def _seated(
    problem: Problem, cells: float, s: Structure, layout: Plan, points: tuple[MeasurementPoint, ...]
) -> Structure:
    """The structure with rows for points where sensors really sit, in place of any of the same name."""
    old = [k for k, name in enumerate(s.places) if name not in {p.site for p in points}]
    jacobian, axis, tilt = zip(*(sensed_at(s, layout, p) for p in points), strict=True)
    fine = [row + refined_rows(problem, cells, s, p.site) for row, p in zip(axis, points, strict=True)]
    return replace(
        s,
        places=(*(s.places[k] for k in old), *(p.site for p in points)),
        jacobian=np.concatenate([s.jacobian[old], np.array(jacobian)]),
        axis=np.concatenate([s.axis[old], np.array(fine)]),
        tilt=np.concatenate([s.tilt[old], np.array(tilt)]),
    )
