"""A mode shape in space: displacement vectors at the nodes, and the lines and faces that carry them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Geometry, ModalModel


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Nodes (N, 3) of a geometry with the edges and faces that draw them, as indices."""

    positions_m: NDArray[np.float64]
    edges: tuple[tuple[int, int], ...]
    faces: tuple[tuple[int, ...], ...]


def mesh_of(geometry: Geometry, nodes: tuple[int, ...]) -> Mesh:
    """The mesh over some nodes: the geometry's own lines with ribs between neighbouring ones.

    Without lines each node is joined to its three nearest.
    """
    place = {node: k for k, node in enumerate(nodes)}
    positions = np.array([geometry.position_m(node) for node in nodes]).reshape(-1, 3)
    lines = [[place.get(node) for node in line] for line in geometry.lines]
    drawn = {
        (min(a, b), max(a, b))
        for line in lines
        for a, b in pairwise(line)
        if a is not None and b is not None and a != b
    }
    edges = tuple(sorted(drawn | _ribs(positions, drawn, lines) if drawn else _nearest_neighbours(positions)))
    return Mesh(positions, edges, _faces(len(nodes), edges))


def displacement(model: ModalModel, mode: int, nodes: tuple[int, ...]) -> NDArray[np.complex128]:
    """Displacement (N, 3) of a mode at some nodes, largest length 1, turned to be as real as it can be.

    Directions that were not measured are zero. The mean phase is that of sum(shape^2) / 2.
    """
    place = {node: k for k, node in enumerate(nodes)}
    vectors = np.zeros((len(nodes), 3), dtype=complex)
    shape = np.nan_to_num(model.shapes[mode])
    turned = shape * np.exp(-0.5j * np.angle(np.sum(shape**2)))
    for dof, value in zip(model.dofs, turned, strict=True):
        if dof.node in place and not dof.direction.is_rotation:
            vectors[place[dof.node]] += value * dof.direction.unit_vector
    largest = np.sqrt((np.abs(vectors) ** 2).sum(axis=1)).max(initial=0.0)
    return vectors / largest if largest > 0 else vectors


def aligned(reference: NDArray[np.complex128], shape: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """``reference`` scaled by the complex factor that brings it closest to ``shape`` (modal scale factor)."""
    power = np.vdot(reference, reference).real
    factor = np.vdot(reference, shape) / power if power > 0 else 1.0
    return np.asarray(reference * factor)


def main_axis(vectors: NDArray[np.complex128]) -> int:
    """The axis (0, 1, 2) that carries most of a shape: its component gives the colour."""
    return int(np.argmax((np.abs(vectors) ** 2).sum(axis=0)))


def _ribs(
    positions_m: NDArray[np.float64], edges: set[tuple[int, int]], lines: list[list[int | None]]
) -> set[tuple[int, int]]:
    """Pairs on different lines that are each other's nearest, closer than half again their longest edge.

    Rows of sensors along a wing become a surface; a bay that has its ribs gets no diagonal.
    """
    longest = np.zeros(len(positions_m))
    joined = np.zeros((len(positions_m), len(positions_m)), dtype=int)
    for a, b in edges:
        joined[a, b] = joined[b, a] = 1
        longest[[a, b]] = np.maximum(longest[[a, b]], np.linalg.norm(positions_m[a] - positions_m[b]))
    distance = np.linalg.norm(positions_m[:, None] - positions_m[None, :], axis=2)
    distance[(joined @ joined + np.eye(len(joined), dtype=int)) > 0] = np.inf
    for line in lines:
        members = [k for k in line if k is not None]
        distance[np.ix_(members, members)] = np.inf
    nearest = np.argmin(distance, axis=1)
    return {
        (i, int(j))
        for i, j in enumerate(nearest)
        if i < j and nearest[j] == i and distance[i, j] <= 1.5 * max(longest[i], longest[j])
    }


def _nearest_neighbours(positions_m: NDArray[np.float64], count: int = 3) -> set[tuple[int, int]]:
    distance = np.linalg.norm(positions_m[:, None] - positions_m[None, :], axis=2)
    np.fill_diagonal(distance, np.inf)
    near = np.argsort(distance, axis=1, kind="stable")[:, : min(count, max(len(positions_m) - 1, 0))]
    return {(min(i, int(j)), max(i, int(j))) for i, row in enumerate(near) for j in row}


def _faces(nodes: int, edges: tuple[tuple[int, int], ...]) -> tuple[tuple[int, ...], ...]:
    """Triangles and chordless quadrilaterals of the edge graph."""
    near: list[set[int]] = [set() for _ in range(nodes)]
    for a, b in edges:
        near[a].add(b)
        near[b].add(a)
    found: dict[frozenset[int], tuple[int, ...]] = {}
    for a, b in edges:
        for c in near[a] & near[b]:
            found.setdefault(frozenset((a, b, c)), (a, b, c))
    for a, c in combinations(range(nodes), 2):
        if c not in near[a]:
            for b, d in combinations(sorted(near[a] & near[c]), 2):
                if d not in near[b]:
                    found.setdefault(frozenset((a, b, c, d)), (a, b, c, d))
    return tuple(found.values())
