"""Forces that act at once: whether they can be told apart, and by what."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, Dof, InputError
from vgvt.signals.averages import Averages, averages_of_notes
from vgvt.signals.plan import dof_of
from vgvt.signals.rest import end_at_rest, start_at_rest
from vgvt.signals.usable import UsableRun, usable_runs

_MOST_ALIKE = 1e8
"""Condition of the forces' power matrix, each scaled to its own, beyond which they are copies of one another."""


def estimator_of_several(campaign: Campaign, runs: tuple[UsableRun, ...]) -> tuple[str, Averages]:
    """The estimator that suits runs with several forces at once, and its averages.

    Bursts are averages of their own. Repeats that start and end at rest, as sweeps with changing signs do, are
    solved on every line of the whole records. All else leaks: it takes local fits.
    """
    bursts = averages_of_notes(campaign)
    if bursts is not None:
        return "h1", bursts
    at_rest = start_at_rest(campaign, runs) and end_at_rest(runs)
    whole = at_rest and _repeats_suffice(runs) and _independent(campaign, runs)
    return ("ratio" if whole else "local_rational"), Averages()


def independent_periods(campaign: Campaign, count: int) -> bool:
    """Whether runs of ``count`` whole periods tell their forces apart at the harmonics: as many runs as forces do.

    All periods of a run have the same forces, and are one average of them.
    """
    runs, _ = usable_runs(campaign)
    return _repeats_suffice(runs) and _independent(campaign, runs, count)


def check_independent(
    campaign: Campaign, references: tuple[Dof, ...], power: NDArray[np.complex128], frequency_hz: NDArray[np.float64]
) -> None:
    """InputError when the ``power`` (R, R, L) of forces, sums of F_i F_j*, is that of copies in the excited band."""
    excited = (frequency_hz >= campaign.band_hz[0]) & (frequency_hz <= campaign.band_hz[1])
    if power.shape[0] == 1 or not excited.any():
        return
    if _alikeness(power[:, :, excited]) > _MOST_ALIKE:
        raise InputError(
            f"{campaign.name}, references {', '.join(map(str, references))}",
            "the forces are copies of one another in every average, so their responses cannot be told apart",
            "drive the shakers with independent signals, or change their phases from run to run",
        )


def _alikeness(power: NDArray[np.complex128]) -> float:
    """Median over the lines of the condition of power matrices (R, R, L), every force scaled to its own power."""
    size = np.maximum(np.sqrt(np.einsum("iil->il", power).real), np.finfo(float).tiny)
    return float(np.median(np.linalg.cond((power / (size[:, None] * size[None])).transpose(2, 0, 1))))


def _repeats_suffice(runs: tuple[UsableRun, ...]) -> bool:
    """Whether records are equally long and every response was measured in as many as forces acted in them."""
    if len({(run.samples, run.sample_rate_hz) for run in runs}) > 1:
        return False
    counts: dict[tuple[Dof, frozenset[Dof]], int] = {}
    for run in runs:
        for channel in run.responses:
            key = (dof_of(channel).unsigned, _forces_of(run))
            counts[key] = counts.get(key, 0) + 1
    return all(count >= len(forces) for (_, forces), count in counts.items())


def _forces_of(run: UsableRun) -> frozenset[Dof]:
    return frozenset(dof_of(channel).unsigned for channel in run.references)


def _independent(campaign: Campaign, runs: tuple[UsableRun, ...], every: int = 1) -> bool:
    """Whether whole-record spectra of runs of one length with the same forces tell these apart, in the excited band.

    On one line of ``every``.
    """
    lines = np.fft.rfftfreq(runs[0].samples, 1 / runs[0].sample_rate_hz)
    excited = (lines > 0) & (lines >= campaign.band_hz[0]) & (lines <= campaign.band_hz[1])
    excited &= np.arange(lines.size) % every == 0
    powers: dict[frozenset[Dof], NDArray[np.complex128]] = {}
    for run in runs:
        order = np.argsort([str(dof_of(c).unsigned) for c in run.references])
        signals = np.array([np.asarray(run.reference_samples[i], float) for i in order])
        signals *= np.array([dof_of(run.references[i]).direction.sign for i in order])[:, None]
        force = np.fft.rfft(signals - signals.mean(axis=1, keepdims=True))[:, excited]
        power = np.einsum("il,jl->ijl", force, force.conj())
        powers[_forces_of(run)] = powers.get(_forces_of(run), 0) + power
    return bool(excited.any()) and all(_alikeness(power) <= _MOST_ALIKE for power in powers.values())
