"""Local rational estimates of all responses of a campaign, on lines so far apart that their errors are their own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, Dof, InputError
from vgvt.signals.assemble import Key, ResponseEstimate
from vgvt.signals.local_rational import RunLines, local_rational_fit, rational_half_width
from vgvt.signals.plan import Plan
from vgvt.signals.several_forces import check_independent
from vgvt.signals.usable import UsableRun

_LEAST_FILLED = 0.5  # of the excited lines, whose windows the forces must fill

_Spectrum = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, eq=False)
class _RunSpectra:
    """One run: the step of its lines, its forces (R, L), and its responses (L,) by label, one channel each."""

    run: int
    step_hz: float
    references: tuple[Dof, ...]
    forces: _Spectrum
    responses: Mapping[Dof, _Spectrum]


def rational_estimates(
    campaign: Campaign, runs: tuple[UsableRun, ...], plan: Plan, order: int, half_width: int
) -> tuple[dict[Key, ResponseEstimate], Plan, str]:
    """Estimates of every response, the plan with the lines that they are on, and a remark on how far these lie apart.

    Responses that were measured in the same runs are fitted together. ``half_width`` is widened to what
    the forces need. InputError for forces that are copies of one another or that leave
    most of the excited lines without a force.
    """
    spectra = [_spectra(run, plan) for run in runs]
    groups = _groups(spectra)
    needed = [rational_half_width(len(refs), len(members), order) for refs, members, _ in groups]
    half_width = max(half_width, *needed)
    stride = (2 * half_width + 1) // (order + 1)
    plan = replace(plan, frequency_hz=plan.frequency_hz[plan.lines][::stride])
    plan = replace(plan, lines=np.arange(plan.frequency_hz.size))
    estimates: dict[Key, ResponseEstimate] = {}
    for references, members, labels in groups:
        lines = [
            RunLines(m.step_hz, m.forces, np.array([m.responses[label] for label in labels])) for m in members
        ]  # fmt: skip
        fit = local_rational_fit(lines, plan.frequency_hz, order, half_width)
        check_independent(campaign, references, fit.power, plan.frequency_hz)
        _check_filled(campaign, fit.values, plan.frequency_hz)
        for label, values, variance in zip(labels, fit.values, fit.variance, strict=True):
            estimates[label, references] = ResponseEstimate(members[0].run, values, variance, None)
    said = f"frequency responses are local fits over {2 * half_width + 1} lines of a record, one every {stride} lines"
    return estimates, plan, said


def _spectra(run: UsableRun, plan: Plan) -> _RunSpectra:
    cut = plan.cuts[run.run]
    own = replace(plan, frequency_hz=cut.frequency_hz(run.sample_rate_hz))
    # Records of any length have the same noise on a line by this scale, and weigh alike.
    scale = 1 / np.sqrt(run.samples)
    references, forces = own.forces(run)
    responses: dict[Dof, _Spectrum] = {}
    for channel, samples in zip(run.responses, run.response_samples, strict=True):
        # Of two sensors at one place the first counts here; averages of both would be no response of either.
        responses.setdefault(plan.label(channel), own.spectrum(run.run, channel, samples)[0] * scale)
    return _RunSpectra(run.run, run.sample_rate_hz / run.samples, references, forces[:, 0] * scale, responses)


def _groups(spectra: list[_RunSpectra]) -> list[tuple[tuple[Dof, ...], list[_RunSpectra], list[Dof]]]:
    """References, runs and responses that belong together: those measured in the same runs under the same forces."""
    where: dict[Key, list[int]] = {}
    for index, run in enumerate(spectra):
        for label in run.responses:
            where.setdefault((label, run.references), []).append(index)
    groups: dict[tuple[tuple[Dof, ...], tuple[int, ...]], list[Dof]] = {}
    for (label, references), indices in where.items():
        groups.setdefault((references, tuple(indices)), []).append(label)
    return [(refs, [spectra[i] for i in members], labels) for (refs, members), labels in groups.items()]


def _check_filled(campaign: Campaign, values: NDArray[np.complex128], frequency_hz: NDArray[np.float64]) -> None:
    excited = (frequency_hz >= campaign.band_hz[0]) & (frequency_hz <= campaign.band_hz[1])
    filled = np.isfinite(values[:, :, excited]).all(axis=(0, 1))
    if filled.size and filled.mean() < _LEAST_FILLED:
        raise InputError(
            campaign.name,
            f"the forces fill {100 * filled.mean():.0f} % of the lines between {campaign.band_hz[0]:g} and "
            f"{campaign.band_hz[1]:g} Hz well enough to be told apart by local fits",
            "use 'h1' with segment_s, or drive the shakers with signals that fill the band",
        )
