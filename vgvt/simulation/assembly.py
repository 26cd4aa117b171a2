"""Put a scenario together as MuJoCo models: bare, hung and instrumented, with the shaker attached."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.data import Direction, Dof, RigidBodyProperties
from vgvt.effects.acting import acted
from vgvt.effects.action import Action
from vgvt.effects.elements import Element, RotationSpring
from vgvt.effects.point_error import as_it_sits, seats, shifted_m
from vgvt.effects.registry import effects_of
from vgvt.effects.root_joint import require_one_stiffness
from vgvt.effects.under_a_hammer import act_on
from vgvt.scenario.model import Scenario
from vgvt.scenario.points import sensor_points
from vgvt.simulation.airframe import ROOT, AirframeParts, Pushed
from vgvt.simulation.as_hung import laid_as_hung, rest_as_hung
from vgvt.simulation.elements import add_elements
from vgvt.simulation.inertia import NOTHING, lump
from vgvt.simulation.linear import settle
from vgvt.simulation.no_rest import no_rest
from vgvt.simulation.once import cut_once, damped_airframe
from vgvt.simulation.pushed import pushed_beams
from vgvt.simulation.rig import (
    DRIVE_SITE,
    STINGER,
    STRIKE_SITE,
    TRANSDUCER,
    add_hammer,
    add_point_mass,
    add_shaker,
    hang,
    hung_mass_kg,
    numbered,
)
from vgvt.simulation.seats import MeasurementPoint, seats_at


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """A scenario with its airframe cut and every point placed.

    ``grid`` are the accelerometer points in the order of the scenario, ``drive``
    the shaker's, ``further_drives`` those of more shakers; ``strike`` is where a hammer hits instead, its axis the
    direction of the hit. ``actions`` are what the scenario's effects do to the run; their changes of the scenario
    are in ``scenario`` already.
    """

    scenario: Scenario
    parts: AirframeParts
    grid: tuple[MeasurementPoint, ...]
    drive: MeasurementPoint
    actions: tuple[Action, ...] = ()
    further_drives: tuple[MeasurementPoint, ...] = ()
    strike: MeasurementPoint | None = None

    @property
    def elements(self) -> tuple[tuple[str, Element], ...]:
        """The elements that effects add, each with a name of its own."""
        return tuple(
            (f"effect-{i}-{k}", element)
            for i, action in enumerate(self.actions)
            for k, element in enumerate(action.elements)
        )

    def gauged_springs(self, exciter: int | None = None) -> tuple[tuple[str, RotationSpring], ...]:
        """The rotation springs whose moment the force gauge of an exciter feels, or that of any."""
        springs = ((n, e) for n, e in self.elements if isinstance(e, RotationSpring) and e.gauge_per_m != 0)
        return tuple((n, spring) for n, spring in springs if exciter in (None, spring.exciter))

    @property
    def points(self) -> tuple[MeasurementPoint, ...]:
        """Grid points, then the drive points."""
        return (*self.grid, *self.drives)

    @property
    def drives(self) -> tuple[MeasurementPoint, ...]:
        """The drive points of all shakers, the first one first."""
        return (self.drive, *self.further_drives)

    @property
    def forces(self) -> tuple[MeasurementPoint, ...]:
        """Where a force is measured: under every shaker, or under the hammer."""
        return self.drives if self.strike is None else (self.strike,)

    def run_points(self, run: int) -> tuple[MeasurementPoint, ...]:
        """The accelerometers of a run (counted from 0) in the order of the channels, where they really sit."""
        return tuple(self._really_at(node) for node in self.scenario.acquisition.run_nodes[run])

    def _really_at(self, node: int) -> MeasurementPoint:
        by_node = {p.dof.node: p for p in self.grid}
        labelled = by_node[node]
        errors = [e for action in self.actions for e in action.points if e.node == node]
        if not errors:
            return labelled
        seat = by_node[seats(action.points for action in self.actions).get(node, node)]
        position = np.array(shifted_m(self.scenario.airframe, seat.part, seat.position_m.tolist(), errors))
        turned = labelled.dof.direction, seat.dof.direction
        return MeasurementPoint(
            labelled.dof,
            # By the point that it sits on, or next to, too: what holds there holds for it.
            f"misplaced-{node}-at-{seat.site}",
            seat.part,
            position,
            self.parts.carrier(seat.part, position),
            seat.axis + np.sum([as_it_sits(v, *turned) for e in errors for v in (e.lean, e.cross_sensitivity)], axis=0),
            seats_at(self.parts, seat.part, position),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Rig:
    """A compiled model at its equilibrium ``qpos`` (nq,)."""

    model: mujoco.MjModel
    qpos: NDArray[np.float64]


def plans(scenario: Scenario) -> list[Plan]:
    """The plan of every run; without effects all runs share one. InputError for effects that contradict each other."""
    effects = effects_of(scenario)
    count = len(scenario.acquisition.run_nodes)
    if not effects:
        ideal = plan(scenario)
        return [_struck(ideal, run) for run in range(count)]
    layouts = []
    for run in range(count):
        changed, actions = acted(effects, scenario, run, act_on)
        require_one_stiffness(actions)
        layouts.append(_struck(_with_actions(plan(changed), actions), run))
    return layouts


def _struck(layout: Plan, run: int) -> Plan:
    """The plan of a run (counted from 0) with the point that the hammer hits; as it is without a hammer."""
    scenario = layout.scenario
    if scenario.excitation.kind != "impact" or scenario.hammer is None:
        return layout
    point = layout.drive
    if scenario.hammer.nodes:
        node = scenario.hammer.nodes[run // scenario.acquisition.repeats]
        point = next(p for p in layout.grid if p.dof.node == node)
    against = Dof(point.dof.node, Direction(-point.dof.direction))
    return replace(layout, strike=replace(point, dof=against, site=STRIKE_SITE, axis=-point.axis))


def _with_actions(ideal: Plan, actions: tuple[Action, ...]) -> Plan:
    def leaning(drive: MeasurementPoint) -> MeasurementPoint:
        leans = [np.array(e.lean) for action in actions for e in action.points if e.node == drive.dof.node]
        axis = np.sum([drive.axis, *leans], axis=0)
        return replace(drive, axis=axis / np.linalg.norm(axis))

    first, *further = map(leaning, ideal.drives)
    return replace(ideal, actions=actions, drive=first, further_drives=tuple(further))


def plan(scenario: Scenario, pushed: Pushed | None = None) -> Plan:
    """Cut the airframe and place every point of the scenario on it, effects left out.

    A cell ends where a shaker pushes, unless it is told where else cells are to end.
    """
    parts = cut_once(scenario.airframe, pushed_beams(scenario) if pushed is None else pushed)

    def point(dof: Dof, site: str, part: str, position_m: Sequence[float]) -> MeasurementPoint:
        place = np.array(position_m)
        return MeasurementPoint(dof, site, part, place, parts.carrier(part, place), dof.direction.unit_vector)

    grid = tuple(
        replace(found, seats=seats_at(parts, found.part, found.position_m))
        for found in (point(p.dof, f"node-{p.dof.node}", p.part, p.position_m) for p in sensor_points(scenario))
    )
    drives = [
        point(Dof(s.node, Direction.PLUS_Z), numbered(DRIVE_SITE, k), s.attached_to, s.position_m)
        for k, s in enumerate(scenario.shakers)
    ]
    return Plan(scenario, parts, grid, drives[0], further_drives=tuple(drives[1:]))


def bare_rig(layout: Plan) -> Rig:
    """The airframe alone, free-free, unloaded, with sites at every point."""
    spec = _airframe_with_points(layout)
    for drive in layout.drives:
        _add_site(spec, layout, drive)
    model = spec.compile()
    return Rig(model, np.zeros(model.nq))


def gauged_rig(layout: Plan, run: int, at_rest: NDArray[np.float64]) -> Rig:
    """Hung and instrumented with all that hangs on the aircraft in a run, transducers and stingers too, but no shaker.

    ``at_rest`` (nq,) is the equilibrium of the driven rig of the same run.
    """
    spec = _hung_spec(layout, run, _transducer_side_mass(layout))
    qpos = at_rest[: spec.compile().nq]
    laid_as_hung(spec, layout.elements, layout.drives, qpos)
    return Rig(spec.compile(), qpos)


def hung_rig(layout: Plan, run: int, at_rest: NDArray[np.float64] | None = None) -> Rig:
    """Hung and instrumented, without the shaker: the structure as seen from the sensing element.

    Only the part of the transducer between sensing element and structure
    counts here, at the equilibrium of the whole: that of the driven rig of the same run,
    ``at_rest`` (nq,), where it is known already.
    """
    if at_rest is None:
        at_rest = _settle(layout, _hung_spec(layout, run, _transducer_side_mass(layout)))
    end_mass = 0.0 if layout.strike is not None else layout.scenario.transducer.end_mass_kg
    structure_side = _hung_spec(layout, run, end_mass)
    # Armature and coil come after the coordinates of the hung aircraft.
    qpos = at_rest[: structure_side.compile().nq]
    laid_as_hung(structure_side, layout.elements, layout.drives, qpos)
    return Rig(structure_side.compile(), qpos)


def driven_rig(layout: Plan, run: int) -> Rig:
    """The complete rig of a run, ready to be driven, with its sensors."""
    spec, qpos = driven_spec(layout, run)
    model = spec.compile()
    return Rig(model, np.concatenate([qpos, np.zeros(model.nq - qpos.size)]))


def driven_spec(layout: Plan, run: int) -> tuple[mujoco.MjSpec, NDArray[np.float64]]:
    """The complete rig of a run before it is compiled, and the hung aircraft's equilibrium.

    The coordinates of armature and coil come after those and are zero there.
    """
    spec = _hung_spec(layout, run, _transducer_side_mass(layout))
    qpos = _settle(layout, spec)
    laid_as_hung(spec, layout.elements, layout.drives, qpos)
    hung = spec.compile()
    data = mujoco.MjData(hung)
    data.qpos[:] = qpos
    mujoco.mj_forward(hung, data)
    if layout.strike is not None:
        for k, (site, weight) in enumerate(layout.strike.weighted_sites):
            add_hammer(spec, site, layout.strike.axis, weight, k)
    else:
        for k, (shaker, point) in enumerate(zip(layout.scenario.shakers, layout.drives, strict=True)):
            drive = data.site(point.site)
            push = drive.xmat.reshape(3, 3) @ point.axis
            add_shaker(spec, shaker, layout.scenario.stinger, drive.xpos.copy(), push, k)
    _add_sensors(spec, layout, run)
    return spec, qpos


def rigid_body(rig: Rig) -> RigidBodyProperties:
    """Mass, centre of gravity and inertia of what has weight on the centre body, and it, from the compiled model."""
    data = mujoco.MjData(rig.model)
    data.qpos[:] = rig.qpos
    mujoco.mj_kinematics(rig.model, data)
    root = rig.model.body(ROOT).id
    total = NOTHING
    for body in range(rig.model.nbody):
        if rig.model.body_rootid[body] == root and rig.model.body_gravcomp[body] == 0.0:
            axes = data.ximat[body].reshape(3, 3)
            inertia = axes @ np.diag(rig.model.body_inertia[body]) @ axes.T
            total += lump(float(rig.model.body_mass[body]), data.xipos[body].copy(), inertia)
    return total.rigid_body()


def _transducer_side_mass(layout: Plan) -> float:
    """What rides on the aircraft at each drive point of a shaker: nothing under a hammer."""
    scenario = layout.scenario
    return 0.0 if layout.strike is not None else scenario.transducer.mass_kg + 0.5 * scenario.stinger.mass_kg


def _settle(layout: Plan, spec: mujoco.MjSpec) -> NDArray[np.float64]:
    """The equilibrium (nq,) of all that hangs, with what will be trimmed to it."""
    try:
        return rest_as_hung(spec.compile(), layout.elements, settle)
    except RuntimeError as error:
        cg = rigid_body(bare_rig(layout)).centre_of_gravity_m
        raise no_rest(layout.scenario, cg, str(error)) from error


def _airframe_with_points(layout: Plan) -> mujoco.MjSpec:
    """Airframe with its damping, the elements that effects add to it, and a site at every grid point."""
    spec = damped_airframe(layout.scenario.airframe, layout.parts.pushed).copy()
    add_elements(spec, layout.parts, ((n, e) for n, e in layout.elements if e.owner == "airframe"))
    for point in layout.grid:
        _add_site(spec, layout, point)
    return spec


def _hung_spec(layout: Plan, run: int, transducer_mass_kg: float) -> mujoco.MjSpec:
    """The instrumented aircraft on its spring."""
    scenario = layout.scenario
    spec = _airframe_with_points(layout)
    airframe_mass = rigid_body(bare_rig(layout)).mass_kg
    hang(spec, layout.parts, scenario.suspension, hung_mass_kg(scenario, airframe_mass, run))
    for point in layout.run_points(run):
        name = f"accelerometer-{point.dof.node}"
        add_point_mass(spec, layout.parts, name, point.carrier, point.position_m, scenario.accelerometers.mass_kg)
        if point not in layout.grid:
            _add_site(spec, layout, point)
    for k, drive in enumerate(layout.drives if layout.strike is None else ()):
        transducer = numbered(TRANSDUCER, k)
        add_point_mass(spec, layout.parts, transducer, drive.carrier, drive.position_m, transducer_mass_kg)
        # On the transducer, which a compliant mount lets move on its own.
        spec.body(transducer).add_site(name=drive.site)
    for point in () if layout.strike is None else (*layout.drives, layout.strike):
        _add_site(spec, layout, point)
    add_elements(spec, layout.parts, ((n, e) for n, e in layout.elements if e.owner == "rig"), layout.drives)
    return spec


def _add_site(spec: mujoco.MjSpec, layout: Plan, point: MeasurementPoint) -> None:
    """A site on the rigid body that carries a point, and one for every seat of a sensor."""
    spec.body(point.carrier).add_site(name=point.site, pos=point.position_m - layout.parts.origin_m[point.carrier])
    for (name, _), seat in zip(point.weighted_sites if point.seats else (), point.seats, strict=True):
        spec.body(seat.carrier).add_site(name=name, pos=seat.position_m - layout.parts.origin_m[seat.carrier])


def _add_sensors(spec: mujoco.MjSpec, layout: Plan, run: int) -> None:
    site, tendon = mujoco.mjtObj.mjOBJ_SITE, mujoco.mjtObj.mjOBJ_TENDON
    kind = mujoco.mjtSensor
    for name in (name for point in (*layout.run_points(run), *layout.drives) for name, _ in point.weighted_sites):
        spec.add_sensor(name=name, type=kind.mjSENS_ACCELEROMETER, objtype=site, objname=name)
    rods = [numbered(STINGER, k) for k in range(len(layout.drives))] if layout.strike is None else []
    for rod in (*rods, *(name for name, _ in layout.gauged_springs())):
        spec.add_sensor(name=f"{rod}-length", type=kind.mjSENS_TENDONPOS, objtype=tendon, objname=rod)
        spec.add_sensor(name=f"{rod}-rate", type=kind.mjSENS_TENDONVEL, objtype=tendon, objname=rod)
