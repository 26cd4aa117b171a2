"""Test geometry: numbered nodes and the lines that draw them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data.dof import Dof
from vgvt.data.shown import counted, headed


@dataclass(frozen=True, slots=True, eq=False)
class Geometry:
    """Nodes of the test geometry in aircraft axes: x aft from the nose, y right, z up, metres.

    ``lines`` are polylines of node numbers (UFF dataset 82); ``outline_m`` is
    an optional list of closed (P, 3) polylines that only serve the drawing.
    """

    nodes: tuple[int, ...]
    positions_m: NDArray[np.float64]
    lines: tuple[tuple[int, ...], ...] = ()
    outline_m: tuple[NDArray[np.float64], ...] = ()

    def __post_init__(self) -> None:
        if self.positions_m.shape != (len(self.nodes), 3):
            raise ValueError(f"positions_m must be ({len(self.nodes)}, 3), got {self.positions_m.shape}")
        if len(set(self.nodes)) != len(self.nodes):
            twice = sorted({n for n in self.nodes if self.nodes.count(n) > 1})
            raise ValueError(f"node numbers must be unique; twice: {twice}")
        unknown = sorted({n for line in self.lines for n in line} - set(self.nodes))
        if unknown:
            raise ValueError(f"lines name nodes that do not exist: {unknown}")

    def __repr__(self) -> str:
        spans = [
            f"{axis} {min(c):.4g} to {max(c):.4g} m"
            for axis, c in zip("xyz", self.positions_m.T, strict=True)
            if c.size
        ]
        counts = (counted(len(self.nodes), "node"), counted(len(self.lines), "line"))
        return headed(f"Geometry: {', '.join((*counts, *spans))}")

    def position_m(self, node: int) -> NDArray[np.float64]:
        """Position (3,) of a node; KeyError that lists the known ones."""
        if node not in self.nodes:
            raise KeyError(f"no node {node}; the geometry has {list(self.nodes)}")
        position: NDArray[np.float64] = self.positions_m[self.nodes.index(node)]
        return position

    def positions_of(self, dofs: tuple[Dof, ...]) -> NDArray[np.float64]:
        """Positions (D, 3) of the nodes of some DOFs."""
        return np.array([self.position_m(d.node) for d in dofs]).reshape(-1, 3)
