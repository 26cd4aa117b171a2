"""One truth for a roving campaign: the average over its runs.

Roving accelerometers carry their mass along, so every run tests a slightly
different aircraft; a claim made from all runs is scored against their average.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError, ModalModel, TrueModes, Truth
from vgvt_scoreboard.pairing import pair_modes


@dataclass(frozen=True, slots=True, eq=False)
class MergedTruth:
    """The average modal model and, per mode (M,), its spread.

    ``frequency_spread_hz`` and ``damping_spread`` are standard deviations over
    the runs; ``runs_matched`` counts the runs a mode was recognised in;
    ``index`` is its place in the first run's model of the truth. ``joined_mac`` is the MAC with the true shape that
    the best merging of the runs could reach, see :func:`joined_mac`.
    """

    model: ModalModel
    frequency_spread_hz: NDArray[np.float64]
    damping_spread: NDArray[np.float64]
    runs_matched: NDArray[np.intp]
    index: NDArray[np.intp]
    joined_mac: NDArray[np.float64]


def merge_truth(truth: Truth, which: TrueModes = TrueModes.AS_TESTED) -> MergedTruth:
    """Average the truth as tested, or with the shaker, over the runs, modes recognised by pole distance and MAC.

    The modes are those of the first run; each further run adds to the modes it is paired with.
    Shapes are averaged after a complex least-squares scaling to the first run's, residues as they
    are. InputError when the truth holds no run.
    """
    runs = truth.of_runs(which)
    if not runs:
        raise InputError(f"truth of {truth.scenario}", "it holds no run", "simulate the scenario again")
    first = runs[0]
    members: list[list[tuple[ModalModel, int]]] = [[(first, i)] for i in range(len(first))]
    for run in runs[1:]:
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
        natural_frequency_std_hz=_combined_limit(members, order, lambda m: m.natural_frequency_std_hz),
        damping_ratio_std=_combined_limit(members, order, lambda m: m.damping_ratio_std),
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
        joined_mac=np.array([joined_mac(group) for group in members])[order],
    )


def joined_mac(runs: list[tuple[ModalModel, int]]) -> float:
    """The MAC that a shape pieced together from roving runs can reach, from (model, mode) of every run.

    Pieces of a shape are joined by the force: each carries the participation of the drive point in its run.
    On a node line the roving sensors change that in size and even in sign. With participations of mean m and
    standard deviation s over the runs, pieces of equal power give 1 / (1 + (s/m)²); of several references the
    best counts. 1 where the truth states no residues.
    """
    target = runs[0][0].shapes[runs[0][1]]
    participations = []
    for model, j in runs:
        if model.residues is None or not model.references:
            return 1.0
        shape = model.shapes[j]
        aligned = shape * np.sign(np.vdot(shape, target).real or 1.0)
        participations.append(aligned.conj() @ model.residues[j] / np.vdot(shape, shape).real)
    table = np.array(participations)
    mean, spread = np.abs(table.mean(axis=0)), table.std(axis=0)
    share = np.divide(mean**2, mean**2 + spread**2, out=np.zeros(mean.shape), where=mean + spread > 0)
    return float(share.max())


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


def _combined_limit(
    members: list[list[tuple[ModalModel, int]]],
    order: NDArray[np.intp],
    stated_by: Callable[[ModalModel], NDArray[np.float64] | None],
) -> NDArray[np.float64] | None:
    """The least standard deviation of each mode that all runs together allow, (M,): information adds up."""
    limits = [[stated[j] for m, j in group if (stated := stated_by(m)) is not None] for group in members]
    if any(len(stated) < len(group) for stated, group in zip(limits, members, strict=True)):
        return None
    with np.errstate(divide="ignore"):
        # A run that does not sweep the mode states no limit, NaN, and adds nothing.
        information = np.array([np.nansum(1 / np.square(stated)) for stated in limits])
        return np.asarray(1 / np.sqrt(information))[order]
