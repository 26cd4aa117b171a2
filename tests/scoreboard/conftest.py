"""Builders of small modal models and truths."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from vgvt.data import Direction, Dof, ModalModel, RigidBodyProperties, Truth

ModelBuilder = Callable[..., ModalModel]


@pytest.fixture
def model() -> ModelBuilder:
    """Builder of a modal model from frequencies, damping ratios and shapes, sorted by frequency."""

    def build(
        frequency_hz: Sequence[float],
        damping: Sequence[float],
        shapes: object,
        drive: int | None = None,
        **more: object,
    ) -> ModalModel:
        order = np.argsort(frequency_hz, kind="stable")
        frequency, ratio = np.asarray(frequency_hz, float)[order], np.asarray(damping, float)[order]
        shape = np.asarray(shapes, complex).reshape(len(order), -1)[order]
        dofs = tuple(Dof(k + 1, Direction.PLUS_Z) for k in range(shape.shape[1]))
        if drive is not None:
            damped = 2 * np.pi * frequency * np.sqrt(1 - ratio**2)
            more["residues"] = (shape * shape[:, [drive]] / (2j * damped[:, None]))[:, :, None]
            more["references"] = (dofs[drive],)
        return ModalModel(frequency, ratio, shape, dofs, **more)  # type: ignore[arg-type]

    return build


@pytest.fixture
def sealed() -> Callable[..., Truth]:
    """Builder of a truth from the as-tested model of each run."""

    def build(*runs: ModalModel) -> Truth:
        body = RigidBodyProperties(1.0, np.zeros(3), np.eye(3))
        bare = runs[0] if runs else ModalModel.empty(outcome="declined", advice=())  # type: ignore[arg-type]
        return Truth("example", body, bare, tuple(range(1, len(runs) + 1)), runs, runs)

    return build
