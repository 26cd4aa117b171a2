"""The fast prediction of every A/F of a campaign: assembled once at an anchor, linear in its parameters around it.

Effects act as they do in the simulation, through what their ``act`` returns for each run, so that any installed
effect is predicted without a line of code about it. Runs that an effect treats alike share a structure.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.action import Action
from vgvt.reconcile.mechanics.ending import Ending, accelerance_slopes, left_out, left_out_slopes
from vgvt.reconcile.mechanics.level_slopes import level_accelerance_slopes
from vgvt.reconcile.mechanics.response import Matrices, Slopes, accelerances, by_rate, poles_of
from vgvt.reconcile.prediction.adjacent import beside as groups_beside
from vgvt.reconcile.prediction.carried import Structures
from vgvt.reconcile.prediction.chain import chain_factor
from vgvt.reconcile.prediction.grouping import (
    Group,
    NoStructureError,
    cells_at,
    effects_at,
    end_mass_index,
    run_actions,
    sensor_mass,
    sensor_mass_index,
)
from vgvt.reconcile.prediction.left_out import spare_slopes
from vgvt.reconcile.prediction.level_following import Followed, Following
from vgvt.reconcile.prediction.levels import Levels, level_accelerances, levels_of
from vgvt.reconcile.prediction.local_slopes import LocalSlopes, Origin, origin_at, slopes_for, whole_near
from vgvt.reconcile.prediction.plain import loaded, plain_of
from vgvt.reconcile.prediction.riding import riding
from vgvt.reconcile.prediction.sides import Side, pulled_by, sides_of, together, widened
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS, MATRICES, Problem

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, eq=False)
class Reduced:
    """A group in reduced coordinates, ``basis`` (n, m), with its slopes (parameters, …) by name of the matrix.

    ``rests`` (unknowns, J) are those of where the weight holds joints with a law; None without slopes or such joints.
    """

    basis: Array
    matrices: Matrices
    slopes: dict[str, Array]
    runs: tuple[NDArray[np.intp], ...]
    channels: NDArray[np.intp]
    masses_kg: Array
    mass_slopes: Array
    roving: bool
    levels: Levels | None = None
    rests: Array | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Anchor:
    """The linearisation at scores ``u0`` (problem.size,) and ``e0`` (all parameters of the hypotheses, joined).

    The unknowns' slopes are those at ``origin``, None for the values as stated. ``structures`` are what anchors at
    other scores are made from.
    """

    problem: Problem
    hypotheses: tuple[Hypothesis, ...]
    u0: Array
    e0: Array
    groups: tuple[Reduced, ...]
    assembled: tuple[Group, ...]
    filtered: bool
    origin: Origin | None
    structures: Structures

    @property
    def size(self) -> int:
        """Number of parameters, those of the hypotheses included."""
        return self.u0.size + self.e0.size

    def predict(self, u: Array, e: Array, *, ended: bool = True) -> ComplexArray:
        """A/F (C, L) of every channel at scores u and e; NoStructureError where a joint's march runs away.

        Without ``ended``, records are taken to end at rest: half of the work, for a look at where peaks are.
        """
        found = self.mechanical(u, e, ended=ended) * self.chain(u, e)
        if not np.isfinite(found).all():
            raise NoStructureError("the response is not finite")
        return found

    def chain(self, u: Array, e: Array) -> ComplexArray:
        """The measuring chain's factor (C, L)."""
        return chain_factor(self.problem, u[len(self.problem.unknowns) :], self._actions(e))

    def mechanical(self, u: Array, e: Array, *, ended: bool = True) -> ComplexArray:
        """Accelerance (C, L) of the structure alone."""
        problem = self.problem
        omega = 2 * np.pi * problem.measured.frequency_hz
        count = len(problem.unknowns)
        moved = [k.change(float(a)) - k.change(float(b)) for k, a, b in zip(problem.unknowns, u, self.u0, strict=False)]
        x = np.concatenate([moved, e - self.e0])
        still = not x.any()
        heavier = sensor_mass(problem, u) - sensor_mass(problem, self.u0)
        out = np.empty(problem.measured.values.shape, dtype=complex)
        for group in self.groups:
            matrices = group.matrices if still else _at(group, x)
            masses = tuple(
                group.masses_kg[rows] + heavier + (0.0 if still else x[count:] @ group.mass_slopes[:, rows])
                if group.roving
                else np.zeros(rows.size)
                for rows in group.runs
            )
            of, poles = (matrices, omega, group.runs, masses), poles_of(matrices, omega)
            if group.levels is None:
                out[group.channels] = accelerances(*of, poles)
            else:
                shown, rung = group.levels.moved(x[count:])
                joints = group.levels.joints
                out[group.channels] = (
                    level_accelerances(matrices, joints, shown, omega, group.runs, masses, poles) + rung
                )
            if ended and problem.measured.endings:
                out[group.channels] += left_out(*of, self._endings(group), poles)
        return out

    def slopes(self, wanted: NDArray[np.bool_] | None = None) -> ComplexArray:
        """Derivatives (unknowns + e0.size, C, L) of :meth:`mechanical` at the anchor, in unknowns, then e.

        Of the channels that are ``wanted`` (all of them, C,), by default all.
        """
        problem = self.problem
        known = problem.unknowns
        omega = 2 * np.pi * problem.measured.frequency_hz
        rate = np.array([k.rate(float(a)) for k, a in zip(known, self.u0, strict=False)] + [1.0] * self.e0.size)
        index = sensor_mass_index(problem)
        out = np.empty((rate.size, *problem.measured.values.shape), dtype=complex)
        for group in self.groups:
            masses = tuple(group.masses_kg[rows] * group.roving for rows in group.runs)
            mass_slopes = np.zeros((rate.size, group.masses_kg.size))
            if group.roving:
                mass_slopes[len(known) :] = group.mass_slopes
                if index is not None:
                    mass_slopes[index] = problem.scenario.accelerometers.mass_kg * rate[index]
            changes = Slopes(**{n: by_rate(rate, of) for n, of in group.slopes.items()}, masses_kg=mass_slopes)
            of = (group.matrices, omega, group.runs, masses)
            endings = self._endings(group) if problem.measured.endings else ()
            if group.levels is None:
                of_group = None if wanted is None else wanted[group.channels]
                out[:, group.channels] = accelerance_slopes(*of, changes, endings, of_group)
            else:
                follows, rung = group.levels.with_unknowns(rate[: len(known)])
                shown = np.concatenate([follows, group.levels.slopes])
                out[:, group.channels] = level_accelerance_slopes(
                    group.matrices, group.levels.joints, group.levels.shown, shown, omega, group.runs, masses, changes
                )
                out[:, group.channels] += np.concatenate([rung, group.levels.left_out_slopes])
                if endings:
                    out[:, group.channels] += left_out_slopes(*of, endings, changes)
        return out if wanted is None else out[:, wanted]

    def _endings(self, group: Reduced) -> tuple[Ending, ...]:
        """How the records of a group's runs end."""
        measured = self.problem.measured
        return tuple(measured.endings[measured.channels[group.channels[rows[0]]].run] for rows in group.runs)

    def _actions(self, e: Array) -> list[tuple[Action, ...]] | None:
        if not self.filtered:
            return None
        made = effects_at(self.problem, self.hypotheses, e)
        if made is None:
            return None
        return [a for _, a in run_actions(self.problem.scenario, made, len(self.problem.measured.runs))]


def anchor(
    problem: Problem,
    u: Array,
    hypotheses: tuple[Hypothesis, ...] = (),
    e: Array | None = None,
    *,
    slopes: bool = True,
    beside: tuple[Group, ...] | None = None,
    groups: tuple[Group, ...] | None = None,
    origin: Origin | None = None,
    rough: bool = False,
    structures: Structures | None = None,
    sides: Sequence[Side] | None = None,
) -> Anchor:
    """Assemble the structure at scores u and e; without ``slopes`` it predicts there and nowhere else.

    ``beside`` are the groups at the same u without the last hypothesis: what it changes is then added to them where
    that is enough. ``groups`` are those at u and e, where they are known. ``origin`` is where the slopes in the
    unknowns were taken, by default where they serve; ``rough`` takes those of the stated values, however far u is from
    them. ``structures`` are what a fit keeps of its structures, by default everything is assembled. ``sides`` are those
    of the hypotheses before the last one, which has no parameters then. NoStructureError where there is none.
    """
    scores = np.zeros(0) if e is None else e
    kept = Structures(problem) if structures is None else structures
    if groups is None:
        near = None if beside is None else groups_beside(problem, u, beside, hypotheses, scores)
        groups = kept.at(u, hypotheses, scores) if near is None else near
    if groups is None:
        raise NoStructureError("no such structure")
    steps_aside = None if sides is None else widened(sides, groups)
    if steps_aside is None and slopes:
        steps_aside = sides_of(kept, u, hypotheses, scores, groups)
    if rough or not slopes:
        origin = None
    elif kept.whole:
        origin = whole_near(u, scores, origin)
    elif origin is None:
        origin = origin_at(problem, u, scores, hypotheses)
    try:
        known = [slopes_for(problem, hypotheses, origin, g) for g in groups]
        # Slopes of the whole hold what follows from an unknown.
        pulls = slopes and not all(k.whole for k in known)
        pulled = pulled_by(kept, u, hypotheses, scores, groups) if pulls else []
        if steps_aside:
            groups, steps_aside, pulled = together(groups, steps_aside, pulled)
            known = [slopes_for(problem, hypotheses, origin, g) for g in groups]
        reduced = tuple(
            _reduced(problem, u, groups, g, steps_aside, pulled, scores.size, known[g]) for g in range(len(groups))
        )
    except np.linalg.LinAlgError as error:
        raise NoStructureError("no mass matrix") from error
    if slopes and kept.follows is not None:
        reduced = _following(problem, u, reduced, kept.follows)
    # What does nothing to a channel yet may do so a step away.
    filtered = any(g.filtered for end in (groups, *(s.there for s in steps_aside or ())) for g in end)
    return Anchor(problem, hypotheses, u.copy(), scores.copy(), reduced, groups, filtered, origin, kept)


def _following(problem: Problem, u: Array, groups: tuple[Reduced, ...], known: Following) -> tuple[Reduced, ...]:
    """Groups whose joints follow the unknowns, by what is known of that, else by marches here."""
    rates = np.array([k.rate(float(a)) for k, a in zip(problem.unknowns, u, strict=False)])
    heavier, sensor = np.zeros((rates.size, 1)), sensor_mass_index(problem)
    if sensor is not None:
        heavier[sensor] = problem.scenario.accelerometers.mass_kg
    of = [
        Followed(
            g.channels, g.runs, g.masses_kg * g.roving, g.levels, g.matrices, g.slopes,
            heavier * (g.roving * np.ones(g.masses_kg.size)), g.rests,
        )
        for g in groups
    ]  # fmt: skip
    levels = known.followed(problem.measured, of, rates)
    return tuple(replace(group, levels=there) for group, there in zip(groups, levels, strict=True))


def _reduced(
    problem: Problem,
    u: Array,
    groups: tuple[Group, ...],
    index: int,
    sides: list[Side] | None,
    pulled: list[tuple[int, Side]],
    effects: int,
    local: LocalSlopes,
) -> Reduced:
    group = groups[index]
    s = group.structure
    plain = plain_of(problem, cells_at(problem, u), group)
    basis, matrices, runs, riders, levels = plain.basis, plain.matrices, plain.runs, plain.riders, plain.levels
    roving = riders.roving
    slopes: dict[str, Array] = {}
    if sides is None:
        none = np.zeros((0, 0))
        return Reduced(basis, matrices, slopes, runs, group.channels, group.masses_kg, none, roving, levels)
    count = len(problem.unknowns)
    part = basis[[s.joints.index(j) for j in local.joints]]
    sensor, end_mass = sensor_mass_index(problem), end_mass_index(problem)
    otherwise = riding(s.drive, np.array([joint in local.joints for joint in s.joints]))
    grid_rows = local.rows([s.places[r] for r in group.rows])
    extra: list[dict[str, Array]] = []
    mass_slopes = np.zeros((effects, group.rows.size))
    beside: list[tuple[Levels, Levels, float] | None] = []
    # All parameters of an effect step aside from the same groups.
    seen: dict[int, tuple[Matrices, Levels | None]] = {}

    def end(g: Group) -> tuple[Matrices, Levels | None]:
        """What a slope is taken of, in the group's coordinates, and what its joints show where there are any."""
        if id(g) not in seen:
            # Coordinates that only others have hold nothing there: they have no flexibility.
            m = loaded(problem, g, basis, levels is not None)
            shows = levels if g is group or levels is None else levels_of(problem.measured, g, basis, m, roving=roving)
            seen[id(g)] = m, shows
        return seen[id(g)]

    for j, side in enumerate(sides):
        (before, near), (after, far) = (end(g[index]) for g in (side.here, side.there))
        extra.append({n: (getattr(after, n) - getattr(before, n)) / side.step for n in MATRICES})
        mass_slopes[j] = (side.there[index].masses_kg - side.here[index].masses_kg) / side.step
        if levels is not None:
            beside.append(None if near is None or far is None else (near, far, side.step))
    pulls = [(k, [loaded(problem, g[index], basis) for g in (side.here, side.there)], side.step) for k, side in pulled]
    for name in MATRICES:
        values = local.values[name]
        if name in ("mass", "damping", "stiffness"):
            rows = part.T @ (values @ part)
        elif name == "drive":
            rows = values @ part
        else:
            rows = values[:, grid_rows] @ part
        if name == "mass" and sensor is not None:
            rows[sensor] += basis.T @ riders.weighing(problem.scenario.accelerometers.mass_kg).inertia(s) @ basis
        if name == "mass" and roving:
            cells, carrying = problem.unknowns.index(CELLS), local.rows([s.places[r] for r in riders.rows])
            moved = local.values["axis"][cells, carrying] @ part
            rows[cells] += riders.by_rows(s.axis[riders.rows] @ basis, moved)
        if name == "mass" and end_mass is not None:
            rows[end_mass] += problem.scenario.transducer.end_mass_kg * (basis.T @ otherwise @ basis)
        for k, (before, after), step in pulls:
            rows[k] += (getattr(after, name) - getattr(before, name)) / step
        added = np.array([e[name] for e in extra]).reshape(effects if extra else 0, *rows.shape[1:])
        if not extra and effects:
            added = np.zeros((effects, *rows.shape[1:]))
        slopes[name] = np.concatenate([rows, added])
    slopes["spare"] = spare_slopes(problem, group, index, basis, local, grid_rows, sides, pulled)
    assert slopes["mass"].shape[0] == slopes["spare"].shape[0] == count + effects
    sloped, rests = None, None
    if levels is not None:
        sloped, rests = levels.sloped(beside), local.rests([s.joints[k] for k in levels.joints.index])
    return Reduced(basis, matrices, slopes, runs, group.channels, group.masses_kg, mass_slopes, roving, sloped, rests)


def _at(group: Reduced, x: Array) -> Matrices:
    changed = {name: getattr(group.matrices, name) + np.tensordot(x, by, axes=1) for name, by in group.slopes.items()}
    return Matrices(**changed)
