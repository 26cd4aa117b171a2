"""DOFs by their place in a list, whatever the sign of their labels: 12-Z and 12+Z are one DOF."""

from __future__ import annotations

from collections.abc import Iterable

from vgvt.data import Dof


def named_once(dofs: Iterable[Dof]) -> tuple[Dof, ...]:
    """Every DOF once, named as first seen."""
    first: dict[Dof, Dof] = {}
    for dof in dofs:
        first.setdefault(dof.unsigned, dof)
    return tuple(first.values())


def places(dofs: tuple[Dof, ...]) -> dict[Dof, tuple[int, int]]:
    """Place and sign of every DOF by its unsigned name."""
    return {dof.unsigned: (i, dof.direction.sign) for i, dof in enumerate(dofs)}
