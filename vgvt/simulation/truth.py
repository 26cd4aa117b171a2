"""The sealed truth: modes of the bare airframe, of every run as tested, and with the shaker attached."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from vgvt.data import ModalModel, Truth
from vgvt.scenario.model import Scenario
from vgvt.simulation.assembly import Plan, Rig, bare_rig, driven_rig, gauged_rig, plans, rigid_body
from vgvt.simulation.information import least_deviations
from vgvt.simulation.labels import mode_labels
from vgvt.simulation.linear import LinearModel
from vgvt.simulation.modes import eigenpairs, modal_model
from vgvt.simulation.seats import MeasurementPoint
from vgvt.simulation.sensed import linearised_at, tilt_rows
from vgvt.simulation.state_space import StateSpace, mass_above_element_kg, state_space


def truth_of(scenario: Scenario) -> Truth:
    """The truth of a scenario, without simulating it: takes well under a second a run."""
    layouts = plans(scenario)
    return assemble_truth(layouts, [driven_state_space(layout, run)[1] for run, layout in enumerate(layouts)])


def assemble_truth(layouts: list[Plan], driven: list[StateSpace]) -> Truth:
    """The truth from the plan of each run and its state-space model with the shaker attached.

    The bare airframe is that of the first run.
    """
    bare = bare_rig(layouts[0])
    return Truth(
        scenario=layouts[0].scenario.name,
        rigid_body=rigid_body(bare),
        bare=bare_modes(layouts[0], bare),
        runs=tuple(range(1, len(layouts) + 1)),
        as_tested=tuple(
            _as_tested(layout, run, model) for run, (layout, model) in enumerate(zip(layouts, driven, strict=True))
        ),
        coupled=tuple(_coupled(layout, model) for layout, model in zip(layouts, driven, strict=True)),
    )


def limit_hz(scenario: Scenario) -> float:
    """Highest mode in the truth: far above the swept band, so that what is left out matters little inside it."""
    return max(12.0 * scenario.excitation.band_hz[1], 100.0)


def felt_from_hz(scenario: Scenario) -> float:
    """An octave below the swept band: what swings more slowly is in the records by its tail alone."""
    return 0.5 * scenario.excitation.band_hz[0]


def driven_state_space(layout: Plan, run: int) -> tuple[Rig, StateSpace]:
    """The complete rig of a run (counted from 0) and its state-space model at all points."""
    rig = driven_rig(layout, run)
    return rig, state_space(layout, rig, layout.points)


def bare_modes(layout: Plan, bare: Rig) -> ModalModel:
    """The modes of the bare airframe at all points, with the drive points of the shakers as references."""
    return _modes_seen(layout, bare, layout.points, _drives(layout))


def modes_as_tested(layout: Plan, run: int, driven: StateSpace) -> ModalModel:
    """The modes as the sensors of a run (from 0) feel them, at all points, the shakers' drive points as references.

    ``driven`` is the run's state-space model with the shaker attached.
    """
    return _modes_felt(layout, gauged_rig(layout, run, driven.linear.equilibrium))


def _modes_felt(layout: Plan, rig: Rig) -> ModalModel:
    above_kg = 0.0 if layout.strike is not None else mass_above_element_kg(layout)
    return _modes_seen(layout, rig, layout.points, _drives(layout), above_kg)


def _drives(layout: Plan) -> range:
    return range(len(layout.grid), len(layout.points))


def _modes_seen(
    layout: Plan, rig: Rig, points: tuple[MeasurementPoint, ...], references: Sequence[int], above_kg: float = 0.0
) -> ModalModel:
    linear = linearised_at(rig, points)
    if above_kg:
        linear = _seen_from_the_gauges(linear, tilt_rows(rig, layout.drives), len(layout.grid), above_kg)
    poles, vectors = eigenpairs(linear)
    kept = vectors[:, np.abs(poles) <= 2 * np.pi * limit_hz(layout.scenario)]
    labels = mode_labels(layout.parts, rig.model, linear.mass, kept)
    # Without gravity, as for the bare airframe, there is nothing to feel of it.
    tilt = tilt_rows(rig, points) if rig.model.opt.gravity.any() else None
    dofs = tuple(p.dof for p in points)
    limit, felt_from = limit_hz(layout.scenario), felt_from_hz(layout.scenario)
    return modal_model(linear, dofs, tuple(references), limit, labels, tilt, (poles, vectors), felt_from)


def _seen_from_the_gauges(
    linear: LinearModel, tilt: NDArray[np.float64], first_drive: int, above_kg: float
) -> LinearModel:
    """The structure that the measured forces act on: what lies above a gauge belongs to it sideways only.

    The inertia of that mass along the gauge, and the weight that the gauge feels as it tilts (rows ``tilt``
    (shakers, nv)), are between the stinger's push and the measured force, and so not part of the structure.
    """
    rows = linear.displacement[first_drive : first_drive + len(tilt)]
    return replace(
        linear, mass=linear.mass - above_kg * rows.T @ rows, stiffness=linear.stiffness - above_kg * rows.T @ tilt
    )


def _as_tested(layout: Plan, run: int, driven: StateSpace) -> ModalModel:
    """The modes as a run's sensors feel them, with the least standard deviations that the run allows."""
    rig = gauged_rig(layout, run, driven.linear.equilibrium)
    modes = forced = _modes_felt(layout, rig)
    if layout.strike is not None:
        # The truth keeps one reference for all runs, wherever the hammer roves; what it allows to know does not. Which
        # way along the axis a hit goes is a sign, on which nothing of that hangs.
        at = [p.dof.unsigned for p in layout.points].index(layout.strike.dof.unsigned)
        forced = _modes_seen(layout, rig, layout.points, [at])
    std_hz, std_ratio = least_deviations(layout, run, driven, forced)
    return replace(modes, natural_frequency_std_hz=std_hz, damping_ratio_std=std_ratio)


def _coupled(layout: Plan, model: StateSpace) -> ModalModel:
    """Oscillating poles of the driven rig, coil and all, with shapes and residues as the sensors feel them.

    The inputs are commands: residues are of displacement over volts, or over newtons of the hammer.
    """
    poles, left, vectors = scipy.linalg.eig(model.state_matrix, left=True)
    keep = np.flatnonzero((poles.imag > 0) & (np.abs(poles) <= 2 * np.pi * limit_hz(layout.scenario)))
    keep = keep[np.argsort(np.abs(poles[keep]))]
    seen = (model.output_matrix[: len(layout.points)] @ vectors[:, keep]).T / poles[keep, None] ** 2
    largest = seen[np.arange(keep.size), np.argmax(np.abs(seen), axis=1)]
    left, vectors = left[:, keep].conj().T, vectors[:, keep].T
    pushed = (left @ model.inputs) / (left * vectors).sum(axis=1)[:, None]
    moved = vectors[:, : model.linear.freedoms] @ model.linear.displacement[: len(layout.points)].T
    tails = np.abs(poles[keep]) < 2 * np.pi * felt_from_hz(layout.scenario)
    return ModalModel(
        natural_frequency_hz=np.abs(poles[keep]) / (2 * np.pi),
        damping_ratio=-poles[keep].real / np.abs(poles[keep]),
        shapes=seen / largest[:, None],
        dofs=tuple(p.dof for p in layout.points),
        references=tuple(p.dof for p in layout.forces),
        residues=np.where(tails[:, None], moved, seen)[:, :, None] * pushed[:, None, :],
        method="truth",
    )
