"""One claim from the modes of single runs: which belong together, one pole each, shapes over all DOFs.

Roving sensors carry their mass along, so a mode moves a little from run to run;
the force is measured in every run, so residues of different runs compare as they are.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Dof, ModalModel, Outcome
from vgvt_identifiers.common_modes import RunModes, common_modes
from vgvt_identifiers.joint_poles import joint_parameters
from vgvt_identifiers.modal_scaling import scaled_shapes
from vgvt_identifiers.named_dofs import named_once, places
from vgvt_identifiers.reciprocity import with_driven_points
from vgvt_identifiers.weighted_mean import weighted_mean

__all__ = ["MergedPole", "RunModes", "merged_claim", "merged_pole"]


@dataclass(frozen=True, slots=True, eq=False)
class MergedPole:
    """One pole over runs: frequency and damping ratio with standard deviations, scatter between runs, remarks."""

    natural_frequency_hz: float
    damping_ratio: float
    natural_frequency_std_hz: float
    damping_ratio_std: float
    flags: tuple[str, ...]


def merged_claim(
    run_modes: tuple[RunModes, ...],
    *,
    tolerance: float = 0.02,
    least_mac: float = 0.5,
    fewest_runs: int = 1,
    poles: Literal["per-run", "common"] = "per-run",
    groups: NDArray[np.intp] | None = None,
    flags: tuple[tuple[str, ...], ...] = (),
    advice: tuple[str, ...] = (),
) -> ModalModel:
    """The modal model (M modes over all DOFs) of the modes of every run.

    Modes of different runs are one mode when their poles differ by no more than
    ``tolerance`` of the frequency (or three of their standard deviations) and, at the DOFs that both
    measured, their shapes have a MAC of ``least_mac``; no two of one run are. Modes in fewer than
    ``fewest_runs`` runs are left out. With ``poles`` common every run must list
    the same poles in the same order, estimated together: nothing is averaged. ``groups`` (M, runs), where
    known, give each mode's index in every run, -1 where it lacks it, in the order of their ``flags``.
    DOFs and references along opposite directions are the same, named as first seen. Where more DOFs were driven than
    measured the shapes cover those too.
    """
    known = tuple(m for m in run_modes if m.poles.size)
    if not known:
        return ModalModel.empty(Outcome.NOTHING_FOUND, advice or ("no run shows a mode",), dofs=_dofs(run_modes))
    if poles == "common":
        groups = np.tile(np.arange(known[0].poles.size)[:, None], (1, len(known)))
        merged = [_first_pole(known[0], mode) for mode in range(known[0].poles.size)]
    else:
        groups = common_modes(known, tolerance, least_mac) if groups is None else groups
        groups = groups[(groups >= 0).sum(axis=1) >= min(fewest_runs, len(known))]
        merged = merged_poles(known, groups)
    if not merged:
        why = f"no mode is seen in {fewest_runs} runs"
        return ModalModel.empty(Outcome.NOTHING_FOUND, (*advice, why), dofs=_dofs(run_modes))
    order = np.argsort([p.natural_frequency_hz for p in merged], kind="stable")
    merged, groups = [merged[i] for i in order], groups[order]
    own = [flags[i] for i in order] if flags else [()] * len(merged)
    dofs, references = _dofs(known), named_once(m.reference for m in known)
    omega = np.array([2 * np.pi * p.natural_frequency_hz for p in merged])
    damped = omega * np.sqrt(1 - np.minimum(np.array([p.damping_ratio for p in merged]), 1) ** 2)
    shapes, mass, residues, partial = scaled_shapes(
        *_residue_table(known, groups, dofs, references), damped, dofs, references
    )
    model = ModalModel(
        natural_frequency_hz=omega / (2 * np.pi),
        damping_ratio=np.array([p.damping_ratio for p in merged]),
        shapes=shapes,
        dofs=dofs,
        natural_frequency_std_hz=np.array([p.natural_frequency_std_hz for p in merged]),
        damping_ratio_std=np.array([p.damping_ratio_std for p in merged]),
        modal_mass_kg=mass if np.isfinite(mass).any() else None,
        references=references,
        residues=residues,
        flags=tuple(
            (*f, *p.flags, *(("shape_incomplete",) if cut else ()))
            for f, p, cut in zip(own, merged, partial, strict=True)
        ),
        advice=advice,
    )
    return with_driven_points(model)


def merged_poles(run_modes: tuple[RunModes, ...], groups: NDArray[np.intp]) -> list[MergedPole]:
    """The pole of every mode of ``groups`` (M, runs), all of them at once where the runs state covariances."""
    merged = [merged_pole(run_modes, group) for group in groups]
    joint = joint_parameters(run_modes, groups)
    return merged if joint is None else [_joined(p, *joint, mode) for mode, p in enumerate(merged)]


def _joined(pole: MergedPole, mean: NDArray[np.float64], std: NDArray[np.float64], mode: int) -> MergedPole:
    """The pole with the joint ``mean`` and ``std`` (2, M) of one mode where these are known."""
    if np.isfinite(mean[0, mode]):
        pole = replace(pole, natural_frequency_hz=float(mean[0, mode]), natural_frequency_std_hz=float(std[0, mode]))
    if np.isfinite(mean[1, mode]) and mean[1, mode] > 0:
        pole = replace(pole, damping_ratio=float(mean[1, mode]), damping_ratio_std=float(std[1, mode]))
    return pole


def merged_pole(run_modes: tuple[RunModes, ...], group: NDArray[np.intp]) -> MergedPole:
    """The pole of one mode, ``group`` (runs,) giving its place in every run, -1 where that run lacks it.

    The mean is that of ``weighted_mean``, for frequency and damping ratio each.
    """
    placed = [(m, int(i)) for m, i in zip(run_modes, group, strict=True) if i >= 0]
    seen = [(m, i) for m, i in placed if not np.isinf(m.frequency_std_hz[i])] or placed
    pole = np.array([m.poles[i] for m, i in seen])
    frequency, damping = np.abs(pole) / (2 * np.pi), -pole.real / np.abs(pole)
    std_hz = np.array([m.frequency_std_hz[i] for m, i in seen])
    mean_hz, mean_std_hz, scatter_hz = weighted_mean(frequency, std_hz)
    ratio, ratio_std, _ = weighted_mean(damping, np.array([m.damping_ratio_std[i] for m, i in seen]))
    flags = []
    if len(run_modes) > 1:
        flags.append(f"seen_in={len(seen)}/{len(run_modes)}")
    if len(seen) > 1:
        flags.append(f"run_scatter_hz={float(frequency.std(ddof=1)):.4f}")
        if scatter_hz > ratio * mean_hz / 2:
            flags.append("runs_disagree")
    return MergedPole(mean_hz, ratio, mean_std_hz, ratio_std, tuple(flags))


def _first_pole(modes: RunModes, which: int) -> MergedPole:
    pole = modes.poles[which]
    ratio = float(-pole.real / abs(pole))
    std_hz, std_ratio = float(modes.frequency_std_hz[which]), float(modes.damping_ratio_std[which])
    return MergedPole(float(abs(pole)) / (2 * np.pi), ratio, std_hz, std_ratio, ())


def _dofs(run_modes: tuple[RunModes, ...]) -> tuple[Dof, ...]:
    """Every response DOF once, in the order in which the runs are listed."""
    return named_once(dof for modes in run_modes for dof in modes.responses)


def _residue_table(
    run_modes: tuple[RunModes, ...], groups: NDArray[np.intp], dofs: tuple[Dof, ...], references: tuple[Dof, ...]
) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Mean residues (M, D, R) of what was measured more than once, and how often each was, (M, D, R)."""
    place, driven = places(dofs), places(references)
    total = np.zeros((len(groups), len(dofs), len(references)), complex)
    count = np.zeros(total.shape)
    for run, modes in enumerate(run_modes):
        column, turned = driven[modes.reference.unsigned]
        turned *= modes.reference.direction.sign
        for row, dof in enumerate(modes.responses):
            where, sign = place[dof.unsigned]
            sign *= turned * dof.direction.sign
            for mode, member in enumerate(groups[:, run]):
                if member >= 0:
                    total[mode, where, column] += modes.residues[member, row] * sign
                    count[mode, where, column] += 1
    return np.asarray(total / np.maximum(count, 1)), count
