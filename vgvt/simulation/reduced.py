"""Matrices without a time engine: the structure as the force gauge sees it, assembled fast for thousands of variants.

Z(ω) q = d F, with F the *measured* force and Z = K + iωC - ω²M. What lies between the sensing element and
the stinger, and what the gauge feels besides, is moved to the left: with F_stinger = F + m (a + tilt) + gauge,
M loses m d dᵀ, and so on. A/F then equals that of the driven rig exactly, shaker left out. The inertia of the roving
accelerometers is left out too: it is a rank-one change per sensor and run. Their weight is not, in the mean of all
runs: a wing that sags by a hundredth more under 56 g has its first bending 0.035 % lower, which peaks show.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.effects.action import Action
from vgvt.scenario.mass import rigid_body_properties
from vgvt.scenario.mirror import expanded_beams
from vgvt.scenario.model import Scenario
from vgvt.simulation.airframe import ROOT
from vgvt.simulation.as_hung import AXES, rest_as_hung, trim, turned_as_hung
from vgvt.simulation.assembly import Plan, plan
from vgvt.simulation.damping import StructuralDamping
from vgvt.simulation.elements import add_elements
from vgvt.simulation.felt import felt_by
from vgvt.simulation.linear import linearise, settle
from vgvt.simulation.once import cut_recently, with_damped_joints
from vgvt.simulation.rig import DRIVE_SITE, GRAVITY_M_PER_S2, TRANSDUCER, add_point_mass, hang
from vgvt.simulation.seats import MeasurementPoint, seats_at
from vgvt.simulation.settling import settle_near
from vgvt.simulation.silence import silent

Array = NDArray[np.float64]
_UP = np.array([0.0, 0.0, 1.0])
# Plans that are kept: an edit makes roots joints or not, and seldom moves a point.
_PLANS = 16


@dataclass(frozen=True, slots=True, eq=False)
class Structure:
    """Z q = d F at the equilibrium under all sensors, whose inertia is not in it; over coordinates named ``joints``.

    ``mass``, ``damping``, ``stiffness`` (n, n) in SI; ``drive`` (n,) is the row of the drive point along the push.
    ``places`` name the points; ``jacobian`` (places, 3, n) are their displacements in world axes, ``axis`` (places, n)
    along what is sensed there and ``tilt`` (places, n) what a sensor there feels of gravity, m/s² a unit. ``bodies``
    (B, 6, n) are displacement and rotation of each body's origin, named ``body_names``, turned by ``attitude``
    (B, 3, 3) from the unloaded shape.

    The first six coordinates are translation and rotation of the centre body along its own axes, so that the
    attitude in which a rig hangs does not change the matrices of the airframe. They are those of the middle of the
    beams' roots, as if it were fixed to the body: the body's own frame sits at its centre of gravity, and another
    balance would change the rows of every point. ``root`` (6, 6) turns them into those of the six root joints, for
    which ``equilibrium`` stands.
    """

    joints: tuple[str, ...]
    mass: Array
    damping: Array
    stiffness: Array
    drive: Array
    places: tuple[str, ...]
    jacobian: Array
    axis: Array
    tilt: Array
    equilibrium: Array
    body_names: tuple[str, ...]
    bodies: Array
    attitude: Array
    root: Array

    def softness(self) -> Array:
        """Inverse stiffness (n, n) over the joints themselves, those of the root included."""
        turn = np.eye(len(self.joints))
        turn[:6, :6] = self.root
        return np.asarray(turn @ np.linalg.solve(self.stiffness, turn.T))

    def onto(self, joints: tuple[str, ...]) -> Structure:
        """The same structure over more coordinates, in that order; the new ones move nothing."""
        if joints == self.joints:
            return self
        index = np.array([joints.index(name) for name in self.joints])
        square = np.ix_(index, index)

        def wide(rows: Array) -> Array:
            out = np.zeros((*rows.shape[:-1], len(joints)))
            out[..., index] = rows
            return out

        matrices = []
        for matrix in (self.mass, self.damping, self.stiffness):
            out = np.zeros((len(joints), len(joints)))
            out[square] = matrix
            matrices.append(out)
        mass, damping, stiffness = matrices
        return replace(
            self,
            joints=joints,
            mass=mass,
            damping=damping,
            stiffness=stiffness,
            drive=wide(self.drive),
            jacobian=wide(self.jacobian),
            axis=wide(self.axis),
            tilt=wide(self.tilt),
            equilibrium=wide(self.equilibrium),
            bodies=wide(self.bodies),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Layouts:
    """Plans of edited scenarios, made fast: what an edit cannot have moved is taken from one made before."""

    first: Plan
    _known: dict[tuple[object, ...], Plan]

    @classmethod
    def of(cls, scenario: Scenario) -> Layouts:
        """For edits of a scenario, whose own effects are left to the caller."""
        first = plan(scenario)
        return cls(first, {_places(scenario): first})

    def plan(self, scenario: Scenario, actions: tuple[Action, ...] = ()) -> Plan:
        """The plan of an edited scenario with actions whose edits are in it already."""
        like = self._like(scenario)
        if like.scenario is scenario:
            fresh = like
        else:
            # Where nothing of the airframe changed, its cut is as good.
            same = scenario.airframe is like.scenario.airframe
            parts = like.parts if same else cut_recently(self.first.parts.pushed)(scenario.airframe)
            x, y, z = scenario.shaker.position_m
            place = np.array([x, y, z])
            drive = replace(
                like.drive,
                part=scenario.shaker.attached_to,
                position_m=place,
                carrier=parts.carrier(scenario.shaker.attached_to, place),
            )
            fresh = Plan(scenario, parts, like.grid, drive)
        drive = fresh.drive
        leans = [e.lean for action in actions for e in action.points if e.node == drive.dof.node]
        axis = drive.axis + np.sum(leans, axis=0) if leans else drive.axis
        return replace(fresh, actions=actions, drive=replace(drive, axis=axis / np.linalg.norm(axis)))

    def _like(self, scenario: Scenario) -> Plan:
        """A plan whose grid points are on the same links as the scenario's: its own where there is none yet."""
        first = self.first.scenario
        if scenario.airframe is first.airframe and scenario.accelerometers.grid == first.accelerometers.grid:
            return self.first
        key = _places(scenario)
        if key not in self._known:
            if len(self._known) >= _PLANS:
                del self._known[next(iter(self._known))]
            # A fit that moves the drive does not cut its beams anew for that.
            self._known[key] = plan(scenario, self.first.parts.pushed)
        return self._known[key]


def _places(scenario: Scenario) -> tuple[object, ...]:
    """What says on which links grid points are: grid, planform, cells, and what is a joint of roots and the body."""
    cut = tuple(
        (
            b.name, b.cells, b.stations.position_m, b.normal,
            b.root_bending_stiffness_n_m_per_rad is None, b.root_torsional_stiffness_n_m_per_rad is None,
        )
        for b in expanded_beams(scenario.airframe)
    )  # fmt: skip
    body = scenario.airframe.body
    halved = body.carry_through_stiffness_n_m_per_rad is not None
    return (scenario.accelerometers.grid, body.outline_m, halved, cut)


# A fit's trial step may lead to an aircraft that has hardly any inertia: what it predicts refuses it.
@silent()
def structure(layout: Plan, points: Sequence[MeasurementPoint], near: Structure | None = None) -> Structure:
    """The structure of a plan with rows for ``points``; ``near`` is one whose equilibrium is not far.

    InputError or RuntimeError where the aircraft finds no rest.
    """
    spec, damped = _hung(layout)
    hung = spec.compile()
    qpos = rest_as_hung(hung, layout.elements, lambda model: _rest(model, near))
    model = turned_as_hung(spec, layout.elements, layout.drives, hung, qpos)
    names = _joints(model)
    data = trim(model, layout.elements, qpos)
    linear = linearise(model, qpos)
    built = {model.body(k).name for k in range(model.nbody)}
    body_names = tuple(name for name in layout.parts.origin_m if name in built)
    bodies = np.zeros((len(body_names), 6, model.nv))
    for k, name in enumerate(body_names):
        mujoco.mj_jacBody(model, data, bodies[k, :3], bodies[k, 3:], model.body(name).id)
    attitude = np.array([data.body(name).xmat.reshape(3, 3) for name in body_names])
    drive, drive_tilt = _rows(model, data, layout.drive)
    drive = drive + _beside_its_link(layout, body_names, bodies, attitude)
    scenario = layout.scenario
    above = scenario.transducer.mass_kg - scenario.transducer.end_mass_kg + 0.5 * scenario.stinger.mass_kg
    mass = linear.mass - above * np.outer(drive, drive) - _sensors_inertia(model, data, layout)
    stiffness = linear.stiffness - above * np.outer(drive, drive_tilt)
    damping = linear.damping + damped.modal_matrix(names)
    for _, spring in layout.gauged_springs():
        k = body_names.index(layout.drives[spring.exciter].carrier)
        felt = spring.gauge_per_m * np.outer(drive, (attitude[k].T @ bodies[k, 3:])[AXES[spring.axis]])
        stiffness -= spring.stiffness_n_m_per_rad * felt
        damping -= spring.damping_n_m_s_per_rad * felt
    places = tuple(p.site for p in points)
    jacobian, axis, tilt = felt_by(points, layout.parts.origin_m, body_names, bodies, attitude)
    joint_structure = Structure(
        names, mass, damping, stiffness, drive, places, jacobian, axis, tilt, qpos, body_names, bodies, attitude,
        np.eye(6),
    )  # fmt: skip
    centre_m = layout.parts.origin_m[ROOT]
    # A body without beams has no root: its own frame, then.
    roots_m = [chain.table.point_m(0.0) for chain in layout.parts.chains.values()] or [centre_m]
    return _in_body_axes(joint_structure, centre_m - np.mean(roots_m, axis=0))


def _in_body_axes(s: Structure, centre_m: Array) -> Structure:
    """The structure with its first six coordinates, those of the root joints, along the centre body's own axes.

    ``centre_m`` (3,) is where the body's own frame sits, from the point whose coordinates they are.
    """
    k = s.body_names.index(ROOT)
    back = s.attitude[k].T
    twist = np.vstack([back @ s.bodies[k, :3, :6], back @ s.bodies[k, 3:, :6]])
    about = np.eye(6)
    # What the centre moves by as the body turns about the point.
    about[:3, 3:] = np.cross(np.eye(3), centre_m).T
    turn = np.eye(s.drive.size)
    turn[:6, :6] = np.linalg.solve(twist, about)
    return replace(
        s,
        mass=turn.T @ s.mass @ turn,
        damping=turn.T @ s.damping @ turn,
        stiffness=turn.T @ s.stiffness @ turn,
        drive=s.drive @ turn,
        jacobian=s.jacobian @ turn,
        axis=s.axis @ turn,
        tilt=s.tilt @ turn,
        bodies=s.bodies @ turn,
        root=turn[:6, :6],
    )


def mean_sensors_kg(scenario: Scenario) -> dict[int, float]:
    """What accelerometers weigh at every node that has one, kg, in the mean of all runs."""
    runs = scenario.acquisition.run_nodes
    counts = Counter(node for nodes in runs for node in nodes)
    return {node: scenario.accelerometers.mass_kg * count / len(runs) for node, count in counts.items()}


def _sensors_inertia(model: mujoco.MjModel, data: mujoco.MjData, layout: Plan) -> Array:
    """Inertia (n, n) of what :func:`_hung` hangs in place of the accelerometers, for the sake of its weight alone."""
    total, moved = np.zeros((model.nv, model.nv)), np.zeros((3, model.nv))
    for node in mean_sensors_kg(layout.scenario):
        body = model.body(_weight(node))
        mujoco.mj_jacBody(model, data, moved, None, body.id)
        total += body.mass * moved.T @ moved
    return total


def _weight(node: int) -> str:
    return f"accelerometers-at-{node}"


def _hung(layout: Plan) -> tuple[mujoco.MjSpec, StructuralDamping]:
    """The aircraft on its spring with the whole transducer, and its damping."""
    scenario, parts = layout.scenario, layout.parts
    spec, damped = with_damped_joints(parts)
    add_elements(spec, parts, ((n, e) for n, e in layout.elements if e.owner == "airframe"))
    sensors = mean_sensors_kg(scenario)
    homes = {p.dof.node: p for p in layout.grid}
    for node, mass in sensors.items():
        add_point_mass(spec, parts, _weight(node), homes[node].carrier, homes[node].position_m, mass)
    carried = scenario.transducer.mass_kg + 0.5 * scenario.stinger.mass_kg
    lumps = sum(float(getattr(e, "mass_kg", 0.0)) for _, e in layout.elements if e.owner == "airframe")
    hang(
        spec,
        parts,
        scenario.suspension,
        rigid_body_properties(scenario.airframe).mass_kg + lumps + carried + sum(sensors.values()),
    )
    drive = layout.drive
    add_point_mass(spec, parts, TRANSDUCER, drive.carrier, drive.position_m, carried)
    spec.body(TRANSDUCER).add_site(name=DRIVE_SITE)
    add_elements(spec, parts, ((n, e) for n, e in layout.elements if e.owner == "rig"), layout.drives)
    return spec, damped


def _joints(model: mujoco.MjModel) -> tuple[str, ...]:
    return tuple(model.joint(j).name for j in range(model.njnt))


def _rest(model: mujoco.MjModel, near: Structure | None) -> Array:
    """The equilibrium (nq,); from a neighbour's first."""
    if near is None:
        return settle(model)
    names = _joints(model)
    start = np.array([near.equilibrium[near.joints.index(n)] if n in near.joints else 0.0 for n in names])
    # A flap that is held while rest is looked for gives way otherwise than the neighbour's.
    alike = near.joints == names and not any(n.endswith("/flap") for n in names)
    found = settle_near(model, start, near.softness() if alike else None)
    return settle(model) if found is None else found


def _beside_its_link(layout: Plan, names: tuple[str, ...], bodies: Array, attitude: Array) -> Array | float:
    """How the beam under the drive moves along the push (n,) beyond the link that the transducer rides on.

    Nothing where a cell ends at the drive, as a simulation has it. A fit moves the drive along the beam that it has.
    """
    parts, drive = layout.parts, layout.drive
    seats = seats_at(parts, drive.part, drive.position_m)
    if len(seats) == 1:
        return 0.0
    both = (replace(drive, seats=seats), replace(drive, seats=()))
    _, along, _ = felt_by(both, parts.origin_m, names, bodies, attitude)
    return np.asarray(along[0] - along[1])


def _rows(model: mujoco.MjModel, data: mujoco.MjData, point: MeasurementPoint) -> tuple[Array, Array]:
    """Displacement along a point's axis (nv,) at its own site, and the gravity that is felt there (nv,)."""
    moved, turned = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    site = model.site(point.site).id
    mujoco.mj_jacSite(model, data, moved, turned, site)
    direction = data.site_xmat[site].reshape(3, 3) @ point.axis
    return direction @ moved, GRAVITY_M_PER_S2 * np.cross(direction, _UP) @ turned
