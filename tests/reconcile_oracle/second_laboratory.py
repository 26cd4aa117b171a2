"""A second laboratory: hung aircraft, drive, sensors and records from the independent finite-element model.

Shares no code with the simulator. Linear and in the frequency domain: Z(ω) = K + iωC - ω²M of the whole hung
aircraft, to which an effect adds couplings of any dynamic stiffness z(ω); a chirp's response is the inverse transform.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from finite_element import Array, Model, build, mirrored_beams, natural_modes
from finite_element_response import modal_damping_matrix
from numpy.typing import NDArray

from vgvt.data import Campaign, Channel, ChannelRole, Direction, Dof, Geometry, Quantity, Record
from vgvt.scenario.airframe import Airframe
from vgvt.scenario.model import Scenario

ComplexArray = NDArray[np.complex128]
Law = Callable[[Array], ComplexArray]
UP, GRAVITY = np.array([0.0, 0.0, 1.0]), 9.80665
ELEMENTS = 10
LOWEST_HZ, HIGHEST_HZ = 0.5, 60.0
FORCE_N = 4.0
BLOCK = 128


@dataclass(frozen=True, eq=False)
class Coupling:
    """A force -z(ω) (right · q) along ``left`` (N,): a spring, a dashpot, a mass or anything else between two rows."""

    left: Array
    right: Array
    law: Law


@dataclass(frozen=True, eq=False)
class Rig:
    """One run: the aircraft as it hangs, what is coupled to it, where it is pushed, and what its channels do.

    ``seats`` are the nodes where sensors sit, ``labels`` the nodes that their channels are called by;
    ``filters`` and ``force_filter`` multiply spectra; ``mixing`` turns (sensors, lines) into what is recorded.
    """

    scenario: Scenario
    model: Model
    seats: tuple[int, ...]
    labels: tuple[int, ...]
    drive_m: Array
    couplings: tuple[Coupling, ...] = ()
    stiffness_factor: float = 1.0
    filters: dict[int, Law] = field(default_factory=dict)
    force_filter: tuple[Law, ...] = ()
    mass_below_gauge_kg: float = 0.0
    mixing: Callable[[ComplexArray, Array], ComplexArray] | None = None

    def at(self, x_m: float, y_m: float) -> Array:
        """Rows (6, N) of the motion of a point of the planform: of the wing outboard of its root, else of the body."""
        part = part_under(self.model, y_m)
        return self.model.motion_at(np.array([x_m, y_m, 0.0]), part)

    def seat(self, node: int) -> Array:
        """Vertical row (N,) of a sensor."""
        return UP @ self.at(*place(self.scenario, node))[:3]

    @property
    def push(self) -> Array:
        """Vertical row (N,) of the drive point."""
        return np.asarray(UP @ self.model.motion_at(self.drive_m)[:3])

    def coupled(self, *couplings: Coupling) -> Rig:
        """The rig with more couplings."""
        return replace(self, couplings=(*self.couplings, *couplings))


Change = Callable[[Rig, int], Rig]


def place(scenario: Scenario, node: int) -> tuple[float, float]:
    """Position (x, y) of a node of the grid."""
    grid = scenario.accelerometers.grid
    k = grid.node.index(node)
    return grid.x_m[k], grid.y_m[k]


def part_under(model: Model, y_m: float) -> str:
    """The wing on this side of the plane of symmetry; the body inboard of its root."""
    for name, chain in model.chains.items():
        root = float(chain[0].start_m[1])
        if y_m * root > 0 and abs(y_m) >= abs(root):
            return name
    return "body"


def rig_of(scenario: Scenario, run: int, elements: int = ELEMENTS) -> Rig:
    """The rig of a run (from 0) without any effect."""
    nodes = scenario.acquisition.run_nodes[run]
    model = build(scenario.airframe, elements)
    return Rig(scenario, model, nodes, nodes, np.array(scenario.shaker.position_m))


def both_sides(airframe: Airframe) -> Airframe:
    """The airframe with each mirrored beam as two, so that they can differ."""
    halves = [(name, half) for beam in airframe.beam for name, half, _ in mirrored_beams(beam)]
    beams = tuple(half.model_copy(update={"name": name, "mirror": False}) for name, half in halves)
    return airframe.model_copy(update={"beam": beams})


def accelerances(rig: Rig, frequency_hz: Array) -> ComplexArray:
    """What the channels say of A/F, (sensors, lines)."""
    omega = 2 * np.pi * frequency_hz
    motion = answered(rig, omega)
    rows = np.array([rig.seat(node) for node in rig.seats])
    out = -(omega**2) * (rows @ motion.T)
    out = out * passed(rig.scenario.accelerometers.high_pass_hz, omega)
    for k, node in enumerate(rig.seats):
        if node in rig.filters:
            out[k] *= rig.filters[node](omega)
    force = passed(rig.scenario.transducer.high_pass_hz, omega)
    # A gauge below some mass of its own feels the force that moves it, too.
    force = force * (1 + rig.mass_below_gauge_kg * -(omega**2) * (motion @ rig.push))
    for law in rig.force_filter:
        force = force * law(omega)
    if rig.mixing is not None:
        out = rig.mixing(out, omega)
    return np.asarray(out / force)


def answered(rig: Rig, omega: Array) -> ComplexArray:
    """Coordinates (lines, N) for a unit force at the drive point, block by block to spare memory."""
    mass, damping, stiffness = hung(rig)
    out = np.empty((omega.size, rig.push.size), dtype=complex)
    for first in range(0, omega.size, BLOCK):
        w = omega[first : first + BLOCK]
        impedance = stiffness + 1j * w[:, None, None] * damping - (w**2)[:, None, None] * mass
        for coupling in rig.couplings:
            impedance += coupling.law(w)[:, None, None] * np.outer(coupling.left, coupling.right)
        push = np.broadcast_to(rig.push[None, :, None], (w.size, rig.push.size, 1))
        out[first : first + BLOCK] = np.linalg.solve(impedance, push)[:, :, 0]
    return out


def hung(rig: Rig) -> tuple[Array, Array, Array]:
    """Mass, damping and stiffness (N, N) of the aircraft on its spring with its instruments.

    The hook swings on a pendulum of the spring's length; the aircraft's weight below the hook rights it.
    """
    scenario, bare = rig.scenario, rig.model
    structural = bare.stiffness * rig.stiffness_factor
    stated = scenario.airframe.damping
    frequency, shapes = natural_modes(bare.mass, structural)
    ratio = np.full(frequency.size, stated.damping_ratio)
    ratio[:6] = 0.0
    ratio[6 : 6 + len(stated.modal)] = stated.modal
    damping = modal_damping_matrix(bare.mass, frequency, shapes, ratio)
    mass = bare.mass.copy()
    for node in rig.seats:
        mass += point_mass(rig.at(*place(scenario, node)), scenario.accelerometers.mass_kg)
    mass += point_mass(bare.motion_at(rig.drive_m), scenario.transducer.end_mass_kg)
    hook = np.array(scenario.suspension.hook_m)
    rows = bare.motion_at(hook)
    spring = scenario.suspension
    whole = np.eye(6, mass.shape[0])
    weight = GRAVITY * mass[2, 2]
    length = spring.free_length_m + weight / spring.stiffness_n_per_m
    stiffness = structural + spring.stiffness_n_per_m * np.outer(rows[2], rows[2])
    stiffness += weight / length * (np.outer(rows[0], rows[0]) + np.outer(rows[1], rows[1]))
    height = hook[2] - centre_of_gravity(mass, bare.origin_m)[2]
    stiffness += weight * height * (np.outer(whole[3], whole[3]) + np.outer(whole[4], whole[4]))
    stiffness += spring.yaw_stiffness_n_m_per_rad * np.outer(whole[5], whole[5])
    damping = damping + spring.damping_n_s_per_m * np.outer(rows[2], rows[2])
    damping += spring.rotation_damping_n_m_s_per_rad * whole[3:].T @ whole[3:]
    damping += spring.pendulum_damping_n_s_per_m * whole[:2].T @ whole[:2]
    return mass, damping, stiffness


def centre_of_gravity(mass: Array, origin_m: Array) -> Array:
    """Centre of gravity (3,) from the rigid part of a mass matrix: m c x = the coupling of push and turn."""
    total = mass[0, 0]
    return np.asarray(origin_m + np.array([mass[1, 5], mass[2, 3], mass[0, 4]]) / total)


def point_mass(rows: Array, mass_kg: float) -> Array:
    """Mass matrix (N, N) of a point with motion rows (6, N)."""
    return np.asarray(mass_kg * rows[:3].T @ rows[:3])


def passed(corner_hz: float, omega: Array) -> ComplexArray:
    """First-order AC coupling, (lines,)."""
    return np.asarray(1j * omega / (1j * omega + 2 * np.pi * corner_hz))


def chirp(scenario: Scenario) -> Array:
    """Force (samples,): a linear sweep with raised-cosine ends, then rest."""
    e, rate = scenario.excitation, scenario.acquisition.sample_rate_hz
    time = np.arange(round(e.record_s * rate) + 1) / rate - e.lead_in_s
    rise = (e.stop_hz - e.start_hz) / e.duration_s
    ends = np.clip(np.minimum(time, e.duration_s - time) / 0.5, 0, 1)
    phase = 2 * np.pi * (e.start_hz + rise / 2 * time) * time
    return np.asarray(FORCE_N * np.sin(np.pi / 2 * ends) ** 2 * np.sin(phase))


def campaign_of(scenario: Scenario, changes: tuple[Change, ...] = (), name: str = "second laboratory") -> Campaign:
    """The noiseless records of every run, in SI, with the effects on."""
    force, rate = chirp(scenario), scenario.acquisition.sample_rate_hz
    padded = 3 * force.size
    frequency, spectrum = np.fft.rfftfreq(padded, 1 / rate), np.fft.rfft(force, padded)
    seen = (frequency >= LOWEST_HZ) & (frequency <= HIGHEST_HZ)
    records = []
    for run in range(len(scenario.acquisition.run_nodes)):
        rig = rig_of(scenario, run)
        for change in changes:
            rig = change(rig, run)
        answer = np.zeros((len(rig.seats), frequency.size), dtype=complex)
        answer[:, seen] = accelerances(rig, frequency[seen]) * spectrum[seen]
        motion = np.fft.irfft(answer, padded, axis=1)[:, : force.size]
        records.append(Record(run + 1, rate, channels(scenario, rig.labels), np.vstack([force, motion])))
    return Campaign(name, geometry(scenario), tuple(records), scenario.excitation.band_hz)


def channels(scenario: Scenario, nodes: tuple[int, ...]) -> tuple[Channel, ...]:
    """The force, then one accelerometer a node."""
    drive = Dof(scenario.shaker.node, Direction.PLUS_Z)
    force = Channel("force", Quantity.EXCITATION_FORCE, ChannelRole.REFERENCE, drive)
    dofs = [Dof(node, Direction.PLUS_Z) for node in nodes]
    return (force, *(Channel(f"a {d}", Quantity.ACCELERATION, ChannelRole.RESPONSE, d) for d in dofs))


def geometry(scenario: Scenario) -> Geometry:
    """The grid and the drive point."""
    grid, shaker = scenario.accelerometers.grid, scenario.shaker
    points = [(x, y, 0.0) for x, y in zip(grid.x_m, grid.y_m, strict=True)]
    return Geometry((*grid.node, shaker.node), np.array([*points, shaker.position_m]), (), ())
