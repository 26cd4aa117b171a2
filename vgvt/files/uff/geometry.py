"""Geometry that a Universal File states: nodes, trace lines and coordinate systems."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.files.uff.cut import Dataset
from vgvt.files.uff.fields import apart, in_columns, real, whole

_NODES_ON_ONE_LINE = 15
_NODES_ON_TWO_LINES = (781, 2411)
_TRACE_LINE = 82
_COLUMNS = 10  # of a node's number
_SYSTEMS_BY_POINTS, _SYSTEMS_BY_MATRICES = 18, 2420
_ALIGNED = 1e-3


@dataclass(frozen=True, slots=True)
class Node:
    """A node as the file states it: in its definition system, in the file's unit of length."""

    number: int
    definition_system: int
    displacement_system: int
    position: tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class CoordinateSystem:
    """A local coordinate system: where its origin (3,) is and how its axes, the rows of ``axes`` (3, 3), lie."""

    cartesian: bool
    axes: NDArray[np.float64]
    origin: NDArray[np.float64]

    @property
    def is_turned(self) -> bool:
        """True unless its axes are those of the global system."""
        return not self.cartesian or not np.allclose(self.axes, np.eye(3), atol=_ALIGNED)


@dataclass(frozen=True, slots=True, eq=False)
class UffGeometry:
    """What a file states about places; every part may be empty."""

    nodes: dict[int, Node]
    lines: tuple[tuple[int, ...], ...]
    systems: dict[int, CoordinateSystem]

    def turned_directions(self, numbers: Iterable[int]) -> tuple[int, ...]:
        """Of some nodes those whose directions are along a local system that is turned."""
        return tuple(n for n in numbers if n in self.nodes and self._turned(self.nodes[n].displacement_system))

    def displaced_positions(self) -> tuple[int, ...]:
        """Nodes whose positions are given in a local system that is turned or displaced."""
        return tuple(
            number
            for number, node in self.nodes.items()
            if self._turned(node.definition_system)
            or (node.definition_system in self.systems and self.systems[node.definition_system].origin.any())
        )

    def _turned(self, system: int) -> bool:
        """A system that the file does not define is taken for the global one: programs number that, too."""
        return system in self.systems and self.systems[system].is_turned


def read_geometry(datasets: Sequence[Dataset], path: Path) -> UffGeometry:
    """Nodes (15, 781, 2411), trace lines (82) and coordinate systems (18, 2420) of a file.

    InputError when one of them is damaged, or a node stands in the file with two positions.
    """
    nodes: dict[int, Node] = {}
    lines: list[tuple[int, ...]] = []
    systems: dict[int, CoordinateSystem] = {}
    for dataset in datasets:
        where = f"{path}, dataset {dataset.place} of the file ({dataset.number})"
        try:
            for node in _nodes(dataset):
                if nodes.setdefault(node.number, node).position != node.position:
                    raise InputError(where, f"node {node.number} has two positions", "leave one of them in the file")
            if dataset.number == _TRACE_LINE:
                lines += _polylines(dataset.lines)
            systems |= _systems(dataset)
        except InputError:
            raise
        except (ValueError, IndexError) as error:
            raise InputError(where, f"damaged: {error}", "export or copy the file again") from error
    return UffGeometry(nodes, tuple(lines), systems)


def _nodes(dataset: Dataset) -> list[Node]:
    lines = [line for line in dataset.lines if line.strip()]
    if dataset.number == _NODES_ON_ONE_LINE:
        rows = [apart(line, (10, 10, 10, 10, 13, 13, 13)) for line in lines]
    elif dataset.number in _NODES_ON_TWO_LINES:
        pairs = zip(lines[::2], lines[1::2], strict=True)
        rows = [apart(labels, (10,) * 4) + apart(position, (25,) * 3) for labels, position in pairs]
    else:
        return []
    return [
        Node(whole(row[0]), whole(row[1]), whole(row[2]), (real(row[4]), real(row[5]), real(row[6]))) for row in rows
    ]


def _polylines(lines: Sequence[str]) -> list[tuple[int, ...]]:
    """Trace line: a 0 lifts the pen, and fills up the last line."""
    found: list[tuple[int, ...]] = []
    piece: list[int] = []
    for number in [whole(word) for line in lines[2:] for word in _entries(line)] + [0]:
        if number:
            piece.append(number)
            continue
        if len(piece) > 1:
            found.append(tuple(piece))
        piece = []
    return found


def _entries(line: str) -> list[str]:
    """The node numbers of a line: between blanks, or in columns where ten digits each leave none."""
    words = line.split()
    return words if all(len(word) <= _COLUMNS for word in words) else in_columns(line.rstrip(), (_COLUMNS,) * 8)


def _systems(dataset: Dataset) -> dict[int, CoordinateSystem]:
    if dataset.number == _SYSTEMS_BY_POINTS:
        return dict(_by_points(dataset.lines[k : k + 4]) for k in range(0, len(dataset.lines) - 3, 4))
    if dataset.number == _SYSTEMS_BY_MATRICES:
        return dict(_by_matrix(dataset.lines[k : k + 6]) for k in range(2, len(dataset.lines) - 5, 6))
    return {}


def _by_points(lines: Sequence[str]) -> tuple[int, CoordinateSystem]:
    """Origin, a point on +x and one in the plane of x and z."""
    number, kind = (whole(field) for field in apart(lines[0], (10,) * 5)[:2])
    values = [*apart(lines[2], (13,) * 6), *apart(lines[3], (13,) * 3)]
    origin, on_x, in_xz = np.array([real(value) for value in values]).reshape(3, 3)
    x = on_x - origin
    y = np.cross(in_xz - origin, x)
    axes = np.array([x, y, np.cross(x, y)])
    sizes = np.linalg.norm(axes, axis=1, keepdims=True)
    if not np.all(sizes > 0):
        raise ValueError(f"the points of coordinate system {number} lie on one line")
    return number, CoordinateSystem(kind == 0, axes / sizes, origin)


def _by_matrix(lines: Sequence[str]) -> tuple[int, CoordinateSystem]:
    number, kind, _ = (whole(field) for field in apart(lines[0], (10,) * 3))
    matrix = np.array([[real(field) for field in apart(line, (25,) * 3)] for line in lines[2:6]])
    return number, CoordinateSystem(kind == 0, matrix[:3], matrix[3])
