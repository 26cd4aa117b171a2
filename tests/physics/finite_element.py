"""An independent finite-element beam model of an airframe: the judge of the simulator.

Shares no code with the simulator. Hermite (Euler–Bernoulli) bending, St-Venant
torsion, consistent mass; axially rigid, and rigid in the plane of the surface
unless a stiffness is given. The coordinates are the six motions of the body and,
for each element, the deformation of its far end relative to its near end: rigid
constraints then hold exactly, without penalty stiffness, and the stiffness
matrix is block diagonal.

Przemieniecki, Theory of Matrix Structural Analysis, 1968, chapters 5 and 11.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, eigh

from vgvt.scenario.airframe import Airframe, Beam, Item

Array = NDArray[np.float64]
LEGENDRE = np.polynomial.legendre.leggauss(6)
GAUSS_POINT, GAUSS_WEIGHT = (LEGENDRE[0] + 1) / 2, LEGENDRE[1] / 2
MIRROR = np.array([1.0, -1.0, 1.0])


@dataclass(frozen=True)
class Element:
    """A straight piece of a beam: near end, triad (tangent, normal, aft) and its own columns of coordinates."""

    start_m: Array
    length_m: float
    tangent: Array
    normal: Array
    aft: Array
    near: Array
    """Motion of the near end, (6, N): three translations, three rotations."""
    columns: slice
    in_plane: bool

    def motion(self, xi: float) -> Array:
        """Motion (6, N) of the axis point at ``xi`` in 0..1."""
        length, side = self.length_m, np.cross(self.tangent, self.normal)
        out = rigid_transfer(xi * length * self.tangent) @ self.near
        rise = np.array([xi**2 * (3 - 2 * xi), xi**2 * (xi - 1) * length])
        slope = np.array([6 * xi * (1 - xi) / length, xi * (3 * xi - 2)])
        first = self.columns.start
        for k in range(2):
            out[:3, first + k] += rise[k] * self.normal
            out[3:, first + k] += slope[k] * side
        out[3:, first + 2] += xi * self.tangent
        if self.in_plane:
            for k in range(2):
                out[:3, first + 3 + k] += rise[k] * side
                out[3:, first + 3 + k] -= slope[k] * self.normal
        return out


@dataclass(frozen=True)
class Model:
    """Mass and stiffness (N, N) and the motion of any material point."""

    mass: Array
    stiffness: Array
    origin_m: Array
    chains: dict[str, tuple[Element, ...]]

    def motion_at(self, position_m: Array, part: str = "body") -> Array:
        """Motion (6, N) of a point that is rigidly tied to the body or to the nearest axis point of a beam."""
        position = np.asarray(position_m, dtype=float)
        if part == "body":
            return rigid_transfer(position - self.origin_m) @ np.eye(6, self.mass.shape[0])
        return motion_on_chain(self.chains[part], position)

    def with_point_mass(self, mass_kg: float, position_m: Array, part: str = "body") -> Model:
        """The model with a point mass added: a sensor."""
        row = self.motion_at(position_m, part)[:3]
        return replace(self, mass=self.mass + mass_kg * row.T @ row)

    def with_ground_spring(self, stiffness_n_per_m: float, position_m: Array, direction: Array) -> Model:
        """The model with a spring from the body to the ground along ``direction``."""
        row = np.asarray(direction, dtype=float) @ self.motion_at(position_m)[:3]
        return replace(self, stiffness=self.stiffness + stiffness_n_per_m * np.outer(row, row))

    def clamped(self) -> tuple[Array, Array]:
        """Mass and stiffness with the body held."""
        return self.mass[6:, 6:], self.stiffness[6:, 6:]


def build(airframe: Airframe, elements: int = 40) -> Model:
    """The free-free model of an airframe with about ``elements`` elements a beam."""
    beams = [half for beam in parents_first(airframe.beam) for half in mirrored_beams(beam)]
    names = [name for name, _, _ in beams]
    items = placed_items(airframe, names)
    hung = [(parent_of(beam, name, names), np.array(beam.stations.position_m[0])) for name, beam, _ in beams]
    hung += [(part, np.array(item.position_m)) for part, item in items]
    nodes = {n: node_arcs(beam, elements, [point for part, point in hung if part == n]) for n, beam, _ in beams}
    coordinates = 6 + sum(beam_coordinates(beam, nodes[name]) for name, beam, _ in beams)
    body = np.eye(6, coordinates)
    origin = np.array(airframe.body.centre_of_gravity_m)
    mass = inertia_term(body, airframe.body.mass_kg, np.diag(airframe.body.inertia_kg_m2))
    blocks: list[Array] = [np.zeros((6, 6))]
    chains: dict[str, tuple[Element, ...]] = {}
    first = 6
    for name, beam, aft in beams:
        parent = parent_of(beam, name, names)
        root = np.array(beam.stations.position_m[0])
        near = rigid_transfer(root - origin) @ body if parent == "body" else motion_on_chain(chains[parent], root)
        chain, beam_mass, beam_blocks = build_chain(beam, aft, near, first, nodes[name])
        chains[name] = chain
        mass += beam_mass
        blocks += beam_blocks
        first += beam_coordinates(beam, nodes[name])
    model = Model(mass, block_diag(*blocks), origin, chains)
    for part, item in items:
        at = model.motion_at(np.array(item.position_m), part)
        mass += inertia_term(at, item.mass_kg, np.diag(item.inertia_kg_m2))
    return replace(model, mass=mass)


def build_chain(
    beam: Beam, aft_sign_of: Array | None, near: Array, first: int, nodes: Array
) -> tuple[tuple[Element, ...], Array, list[Array]]:
    """The elements of one beam, their mass (N, N) and stiffness blocks, starting at coordinate ``first``."""
    table, arc = beam.stations, arc_length(beam)
    position = np.array(table.position_m)
    in_plane = table.in_plane_stiffness_n_m2 is not None
    chain: list[Element] = []
    mass = np.zeros((near.shape[1],) * 2)
    near, first, blocks = root_joint(beam, aft_sign_of, near, first)
    for begin, end in pairwise(nodes):
        segment = int(np.searchsorted(arc, (begin + end) / 2)) - 1
        tangent, normal, aft = triad(beam, segment, aft_sign_of)
        columns = slice(first, first + (5 if in_plane else 3))
        start = position[segment] + (begin - arc[segment]) * tangent
        element = Element(start, float(end - begin), tangent, normal, aft, near, columns, in_plane)
        here = begin + GAUSS_POINT * (end - begin)
        mass += element_mass(element, beam, here)
        blocks.append(element_stiffness(element, beam, here))
        chain.append(element)
        near, first = element.motion(1.0), columns.stop
    return tuple(chain), mass, blocks


def root_joint(beam: Beam, aft: Array | None, near: Array, first: int) -> tuple[Array, int, list[Array]]:
    """Add the springs of the root joint that are given: bending about the side axis, torsion about the tangent."""
    tangent, normal, _ = triad(beam, 0, aft)
    blocks, near = [], near.copy()
    for stiffness, axis in (
        (beam.root_bending_stiffness_n_m_per_rad, np.cross(tangent, normal)),
        (beam.root_torsional_stiffness_n_m_per_rad, tangent),
    ):
        if stiffness is not None:
            near[3:, first] += axis
            blocks.append(np.array([[stiffness]]))
            first += 1
    return near, first, blocks


def element_mass(element: Element, beam: Beam, arc: Array) -> Array:
    """Consistent mass (N, N): sections with an offset centre of gravity, thin (no inertia about the chord)."""
    mass, pitch, offset = (column(beam, name, arc) for name in ("mass_kg_per_m", "pitch_inertia_kg_m", "cg_offset_m"))
    about = np.outer(element.tangent, element.tangent) + np.outer(element.normal, element.normal)
    total = np.zeros((element.near.shape[1],) * 2)
    for k, xi in enumerate(GAUSS_POINT):
        section = rigid_transfer(offset[k] * element.aft) @ element.motion(float(xi))
        total += GAUSS_WEIGHT[k] * element.length_m * inertia_term(section, mass[k], pitch[k] * about)
    return total


def element_stiffness(element: Element, beam: Beam, arc: Array) -> Array:
    """Stiffness of the element's own coordinates: (rise, slope, twist[, in-plane rise, slope])."""
    length = element.length_m
    weight = GAUSS_WEIGHT * length
    curvature = np.stack([(6 - 12 * GAUSS_POINT) / length**2, (6 * GAUSS_POINT - 2) / length])
    bending = (curvature * weight * column(beam, "bending_stiffness_n_m2", arc)) @ curvature.T
    twist = np.array([[(weight * column(beam, "torsional_stiffness_n_m2", arc)).sum() / length**2]])
    if not element.in_plane:
        return np.asarray(block_diag(bending, twist))
    lateral = (curvature * weight * column(beam, "in_plane_stiffness_n_m2", arc)) @ curvature.T
    return np.asarray(block_diag(bending, twist, lateral))


def inertia_term(motion: Array, mass_kg: float, inertia: Array) -> Array:
    """Mass matrix (N, N) of one rigid particle with motion (6, N)."""
    return mass_kg * motion[:3].T @ motion[:3] + motion[3:].T @ inertia @ motion[3:]


def rigid_transfer(arm_m: Array) -> Array:
    """The motion (6, 6) of a point at ``arm_m`` from a rigid point's own motion: u + theta x arm."""
    x, y, z = arm_m
    out = np.eye(6)
    out[:3, 3:] = [[0, z, -y], [-z, 0, x], [y, -x, 0]]
    return out


def triad(beam: Beam, segment: int, aft: Array | None) -> tuple[Array, Array, Array]:
    """Tangent, normal and aft direction of one straight segment; ``aft`` says which way counts as aft."""
    a, b = np.array(beam.stations.position_m[segment : segment + 2])
    tangent = (b - a) / np.linalg.norm(b - a)
    normal = np.array(beam.normal) - (np.array(beam.normal) @ tangent) * tangent
    normal /= np.linalg.norm(normal)
    side = np.cross(tangent, normal)
    ahead = np.array([1.0, 0.0, 0.0]) if aft is None else aft
    return tangent, normal, side if side @ ahead >= 0 else -side


def mirrored_beams(beam: Beam) -> list[tuple[str, Beam, Array | None]]:
    """Name, table and aft direction of each beam that a table describes."""
    if not beam.mirror:
        return [(beam.name, beam, None)]
    points = tuple(tuple(float(v) for v in np.array(p) * MIRROR) for p in beam.stations.position_m)
    normal = tuple(float(v) for v in np.array(beam.normal) * MIRROR)
    stations = beam.stations.model_copy(update={"position_m": points})
    left = beam.model_copy(update={"stations": stations, "normal": normal})
    return [(f"{beam.name}-right", beam, None), (f"{beam.name}-left", left, triad(beam, 0, None)[2] * MIRROR)]


def parents_first(beams: tuple[Beam, ...]) -> list[Beam]:
    """The tables in an order in which every parent is built before what hangs on it."""
    ordered, waiting = [], list(beams)
    known = {"body"}
    while waiting:
        ready = next(beam for beam in waiting if beam.parent in known)
        waiting.remove(ready)
        ordered.append(ready)
        known |= {ready.name, f"{ready.name}-right", f"{ready.name}-left"}
    return ordered


def parent_of(beam: Beam, name: str, names: list[str]) -> str:
    """The part that carries a beam; the two halves of a mirrored beam sit on the two halves of its parent."""
    if beam.parent == "body" or beam.parent in names:
        return beam.parent
    side = name.rsplit("-", 1)[-1] if beam.mirror else ("left" if beam.stations.position_m[0][1] < 0 else "right")
    return f"{beam.parent}-{side}"


def placed_items(airframe: Airframe, names: list[str]) -> list[tuple[str, Item]]:
    """Every item with the part that carries it, mirrored ones twice."""
    placed: list[tuple[str, Item]] = []
    for item in airframe.item:
        x, y, z = item.position_m
        copies = [item, item.model_copy(update={"position_m": (x, -y, z)})] if item.mirror else [item]
        for copy in copies:
            part = item.attached_to
            if part not in names and part != "body":
                part = f"{part}-{'left' if copy.position_m[1] < 0 else 'right'}"
            placed.append((part, copy))
    return placed


def motion_on_chain(chain: tuple[Element, ...], position_m: Array) -> Array:
    """Motion (6, N) of a point tied rigidly to the nearest point of a beam's axis."""
    best = (np.inf, chain[0], 0.0)
    for element in chain:
        along = (position_m - element.start_m) @ element.tangent / element.length_m
        xi = float(np.clip(along, 0, 1))
        axis = element.start_m + xi * element.length_m * element.tangent
        best = min(best, (float(np.linalg.norm(position_m - axis)), element, xi), key=lambda found: found[0])
    _, element, xi = best
    axis = element.start_m + xi * element.length_m * element.tangent
    return rigid_transfer(position_m - axis) @ element.motion(xi)


def arc_length(beam: Beam) -> Array:
    """Length along the axis at the stations."""
    steps = np.linalg.norm(np.diff(np.array(beam.stations.position_m), axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])


def node_arcs(beam: Beam, elements: int, attachments: list[Array]) -> Array:
    """Arc lengths of the nodes: the stations, about ``elements`` pieces, and where anything is attached."""
    arc, position = arc_length(beam), np.array(beam.stations.position_m)
    total = arc[-1]
    nodes = list(arc)
    wanted = [nearest_arc(arc, position, point) for point in attachments]
    for begin, end in pairwise(arc):
        wanted += list(np.linspace(begin, end, max(1, round(elements * (end - begin) / total)) + 1)[1:-1])
    for place in wanted:
        # An element much shorter than the others would only cost accuracy.
        if np.abs(np.array(nodes) - place).min() > 0.02 * total / elements:
            nodes.append(place)
    return np.sort(nodes)


def nearest_arc(arc: Array, position: Array, point: Array) -> float:
    """Arc length of the axis point nearest to a point."""
    best = (np.inf, 0.0)
    for k, step in enumerate(np.diff(position, axis=0)):
        xi = float(np.clip((point - position[k]) @ step / (step @ step), 0, 1))
        best = min(
            best, (float(np.linalg.norm(point - position[k] - xi * step)), float(arc[k] + xi * (arc[k + 1] - arc[k])))
        )
    return best[1]


def beam_coordinates(beam: Beam, nodes: Array) -> int:
    """Coordinates that a beam adds."""
    joints = (beam.root_bending_stiffness_n_m_per_rad, beam.root_torsional_stiffness_n_m_per_rad)
    width = 3 if beam.stations.in_plane_stiffness_n_m2 is None else 5
    return width * (len(nodes) - 1) + sum(joint is not None for joint in joints)


def column(beam: Beam, name: str, arc: Array) -> Array:
    """A column of the station table at some arc lengths; zero where it is left out."""
    values = getattr(beam.stations, name)
    return np.zeros_like(arc) if values is None else np.interp(arc, arc_length(beam), values)


def natural_modes(mass: Array, stiffness: Array, shift_hz: float = 1.0) -> tuple[Array, Array]:
    """Natural frequencies (N,) in Hz, rising, and mass-normalised shapes (N, N) as columns.

    Solves M x = mu (K + s M) x, mu = 1 / (omega^2 + s): the low modes are the large, accurate eigenvalues.
    """
    shift = (2 * np.pi * shift_hz) ** 2
    inverse, vectors = eigh(mass, stiffness + shift * mass)
    order = np.argsort(inverse)[::-1]
    inverse, vectors = np.maximum(inverse[order], 1e-300), vectors[:, order]
    squared = np.maximum(1 / inverse - shift, 0.0)
    return np.sqrt(squared) / (2 * np.pi), vectors / np.sqrt(inverse)
