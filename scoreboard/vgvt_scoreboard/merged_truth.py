"""One truth for a roving campaign: the average over its runs.

Roving accelerometers carry their mass along, so every run tests a slightly
different aircraft; a claim made from all runs is scored against their average.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError, ModalModel, Truth
from vgvt_scoreboard.pairing import pair_modes


@dataclass(frozen=True, slots=True, eq=False)
class MergedTruth:
    """The average modal model and, per mode (M,), its spread.

    ``frequency_spread_hz`` and ``damping_spread`` are standard deviations over
    the runs; ``runs_matched`` counts the runs a mode was recognised in;
    ``index`` is its place in ``Truth.as_tested[0]``.
    """

    model: ModalModel
    frequency_spread_hz: NDArray[np.float64]
    damping_spread: NDArray[np.float64]
    runs_matched: NDArray[np.intp]
    index: NDArray[np.intp]


def merge_truth(truth: Truth) -> MergedTruth:
    """Average the as-tested truth over the runs, modes recognised by pole distance and MAC.

    The modes are those of the first run; each further run adds to the modes it is paired with.
    Shapes are averaged after a complex least-squares scaling to the first run's, residues as they
    are. InputError when the truth holds no run.
    """
    if not truth.as_tested:
        raise InputError(f"truth of {truth.scenario}", "it holds no run", "simulate the scenario again")
    first = truth.as_tested[0]
    members: list[list[tuple[ModalModel, int]]] = [[(first, i)] for i in range(len(first))]
    for run in truth.as_tested[1:]:
        seen = run.at(first.dofs)
        for i, j in pair_modes(first, seen).pairs:
            members[i].append((seen, j))

    frequency = [np.array([m.natural_frequency_hz[j] for m, j in group]) for group in members]
    damping = [np.array([m.damping_ratio[j] for m, j in group]) for group in members]
    mean_hz = np.array([f.mean() for f in frequency])
    order = np.argsort(mean_hz, kind="stable")
    average = replace(
        first,
        natural_frequency_hz=mean_hz[order],
        damping_ratio=np.array([d.mean() for d in damping])[order],
        shapes=np.array([_mean_shape(group) for group in members]).reshape(first.shapes.shape)[order],
        residues=_mean_residues(first, members, order),
        natural_frequency_std_hz=_combined_limit(members, order),
        damping_ratio_std=None,
        modal_mass_kg=None,
        labels=tuple(first.labels[i] for i in order) if first.labels else (),
        flags=tuple(first.flags[i] for i in order) if first.flags else (),
    )
    return MergedTruth(
        model=average,
        frequency_spread_hz=np.array([f.std() for f in frequency])[order],
        damping_spread=np.array([d.std() for d in damping])[order],
        runs_matched=np.array([len(group) for group in members], dtype=np.intp)[order],
        index=order.astype(np.intp),
    )


def _mean_shape(group: list[tuple[ModalModel, int]]) -> NDArray[np.complex128]:
    target = group[0][0].shapes[group[0][1]]
    scaled = []
    for model, j in group:
        shape = model.shapes[j]
        power = np.vdot(shape, shape).real
        scaled.append(shape * (np.vdot(shape, target) / power if power > 0 else 1.0))
    return np.asarray(np.mean(scaled, axis=0), dtype=complex)


def _mean_residues(
    first: ModalModel, members: list[list[tuple[ModalModel, int]]], order: NDArray[np.intp]
) -> NDArray[np.complex128] | None:
    if first.residues is None:
        return None
    mean = [np.mean([m.residues[j] for m, j in group if m.residues is not None], axis=0) for group in members]
    return np.asarray(mean, dtype=complex).reshape(first.residues.shape)[order]


def _combined_limit(members: list[list[tuple[ModalModel, int]]], order: NDArray[np.intp]) -> NDArray[np.float64] | None:
    """The smallest standard deviation of each frequency that all runs together allow, (M,): information adds up."""
    limits = [[m.natural_frequency_std_hz[j] for m, j in g if m.natural_frequency_std_hz is not None] for g in members]
    if any(len(stated) < len(group) for stated, group in zip(limits, members, strict=True)):
        return None
    with np.errstate(divide="ignore"):
        # A run that does not sweep the mode states no limit, NaN, and adds nothing.
        information = np.array([np.nansum(1 / np.square(stated)) for stated in limits])
        return np.asarray(1 / np.sqrt(information))[order]
