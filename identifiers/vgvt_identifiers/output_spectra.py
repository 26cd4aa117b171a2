"""Spectral density matrices of the responses and their singular values, as frequency domain decomposition wants them.

Two kinds are built. With a force, G = H S_ff H^H with S_ff = 1 at every reference: responses of
roving runs were never measured together, so their only consistent cross spectrum is the
one through the force of their own run; one force gives rank one, two give rank two.
Without a force, Welch's matrix of sensors that were measured together; it peaks where
excitation and structure together do, at combined resonances of shaker and aircraft.
Brincker, Zhang and Andersen, Modal identification from ambient responses, IMAC, 2000.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Channel, Dof, Quantity
from vgvt.signals.spectra import Segmentation, segment_spectra, welch_segments
from vgvt_identifiers.spectra import CampaignSpectra, RunSpectra

DIFFERENTIATIONS = {Quantity.ACCELERATION: 0, Quantity.VELOCITY: 1, Quantity.DISPLACEMENT: 2}
_KERNEL_STEPS = 8


@dataclass(frozen=True, slots=True, eq=False)
class Decomposition:
    """Singular values (P, K) and vectors (K, D, P) of a spectral density matrix of accelerations over K lines.

    ``relative_std`` (P, K) is the standard deviation of the logarithm of a singular value,
    ``noise`` (P, K) what noise adds to it on average. Neighbouring lines share
    errors: ``shared_lines`` of them are worth one. ``window`` is what every line was
    averaged with: offsets in Hz and weights, (J,) each, or None for whole records.
    """

    frequency_hz: NDArray[np.float64]
    dofs: tuple[Dof, ...]
    values: NDArray[np.float64]
    vectors: NDArray[np.complex128]
    relative_std: NDArray[np.float64]
    noise: NDArray[np.float64]
    shared_lines: float = 1.0
    window: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ReferenceMatrix:
    """Accelerances (D, R, K) of every response for every reference, their variance (D, R, K), and remarks."""

    frequency_hz: NDArray[np.float64]
    dofs: tuple[Dof, ...]
    references: tuple[Dof, ...]
    values: NDArray[np.complex128]
    variance: NDArray[np.float64]
    remarks: tuple[str, ...]


def reference_matrix(spectra: CampaignSpectra) -> ReferenceMatrix:
    """The responses that were measured with every reference, joined over the runs (repeats weighted by the force).

    Responses that lack a reference are left out with a remark; when none has them
    all, the reference with the most responses is used alone. ``12-Z`` and ``12+Z`` are one response.
    """
    signs: dict[Dof, Dof] = {}
    for dof in (d for run in spectra.runs for d in (run.reference, *run.responses)):
        signs.setdefault(dof.unsigned, dof)
    cells: dict[tuple[Dof, Dof], list[tuple[RunSpectra, int, int]]] = {}
    for run in spectra.runs:
        reference = signs[run.reference.unsigned]
        for row, dof in enumerate(run.responses):
            label = signs[dof.unsigned]
            turned = label.direction.sign * dof.direction.sign
            turned *= reference.direction.sign * run.reference.direction.sign
            cells.setdefault((label, reference), []).append((run, row, turned))
    references = tuple(dict.fromkeys(r for _, r in cells))
    dofs = tuple(dict.fromkeys(d for d, _ in cells))
    complete = tuple(d for d in dofs if all((d, r) in cells for r in references))
    remarks: list[str] = []
    if not complete:
        best = max(references, key=lambda r: sum((d, r) in cells for d in dofs))
        remarks.append(f"no response was measured with all references: only the runs with reference {best} are used")
        references, complete = (best,), tuple(d for d in dofs if (d, best) in cells)
    elif len(complete) < len(dofs):
        lost = ", ".join(str(d) for d in dofs if d not in complete)
        remarks.append(f"{lost} left out: not measured with every reference")
    joined = [[_joined(cells[d, r]) for r in references] for d in complete]
    return ReferenceMatrix(
        spectra.frequency_hz,
        complete,
        references,
        np.array([[values for values, _ in row] for row in joined]),
        np.array([[variance for _, variance in row] for row in joined]),
        tuple(remarks),
    )


def _joined(parts: list[tuple[RunSpectra, int, int]]) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Mean over repeats of one response, weighted by the power of their forces, and its variance, (K,) each."""
    weight = np.array([np.abs(run.force) ** 2 for run, _, _ in parts])
    weight = weight / np.maximum(weight.sum(axis=0), 1e-300)
    values = np.sum(
        [w * sign * run.accelerance[row] for w, (run, row, sign) in zip(weight, parts, strict=True)], axis=0
    )
    variance = np.sum([w**2 * run.variance[row] for w, (run, row, _) in zip(weight, parts, strict=True)], axis=0)
    return np.asarray(values), np.asarray(variance)


def force_referenced(matrix: ReferenceMatrix) -> Decomposition:
    """Singular values of G = H H^H on every line; the errors of H carried over to first order."""
    left, singular, right = np.linalg.svd(matrix.values.transpose(2, 0, 1), full_matrices=False)
    spread = np.where(np.isfinite(matrix.variance), matrix.variance, 0.0).transpose(2, 0, 1)
    noise = np.einsum("kdr,kpr->pk", spread, np.abs(right) ** 2)
    own = np.einsum("kdp,kdr,kpr->pk", np.abs(left) ** 2, spread, np.abs(right) ** 2)
    size = np.maximum(singular.T, 1e-150)
    return Decomposition(
        frequency_hz=matrix.frequency_hz,
        dofs=matrix.dofs,
        values=size**2,
        vectors=left,
        relative_std=np.sqrt(2 * own) / size,
        noise=noise,
    )


def output_only(
    channels: tuple[Channel, ...],
    samples: NDArray[np.float64],
    sample_rate_hz: float,
    band_hz: tuple[float, float],
    segment_s: float,
) -> Decomposition:
    """Singular values of Welch's matrix of responses (D, N) measured together, as accelerations, Hann windows.

    With n independent averages the logarithm of a singular value scatters by 1/sqrt(n).
    """
    cut = welch_segments(samples.shape[1], round(segment_s * sample_rate_hz))
    lines = cut.frequency_hz(sample_rate_hz)
    keep = (lines > 0) & (lines >= band_hz[0]) & (lines <= band_hz[1])
    frequency = lines[keep]
    spectra = np.array(
        [
            segment_spectra(x, cut)[:, keep] * (2j * np.pi * frequency) ** DIFFERENTIATIONS[c.quantity]
            for c, x in zip(channels, samples, strict=True)
        ]
    )
    density = np.einsum("dsk,esk->kde", spectra, spectra.conj()) * (
        2 / (sample_rate_hz * float(cut.window @ cut.window) * cut.segments)
    )
    left, values, _ = np.linalg.svd(density, hermitian=True)
    averages = cut.effective_averages()
    scatter = np.full(values.T.shape, 1 / np.sqrt(averages))
    return Decomposition(
        frequency_hz=frequency,
        dofs=tuple(c.dof for c in channels if c.dof is not None),
        values=np.maximum(values.T, 1e-300),
        vectors=left,
        relative_std=scatter,
        noise=np.zeros_like(scatter),
        shared_lines=_shared_lines(cut.window),
        window=_kernel(cut, sample_rate_hz),
    )


def _shared_lines(window: NDArray[np.float64]) -> float:
    """Lines that are worth one: sum over lags of the squared coherence that a window makes between lines."""
    power = np.abs(np.fft.fft(window**2)) ** 2
    return float(power[:4].sum() * 2 / power[0] - 1)


def _kernel(cut: Segmentation, sample_rate_hz: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Offsets in Hz and weights (J,) by which a window smears a density, out to four lines on each side."""
    padded = np.abs(np.fft.fft(cut.window, _KERNEL_STEPS * cut.length)) ** 2
    reach = 4 * _KERNEL_STEPS
    index = np.arange(-reach, reach + 1)
    weights = padded[index]
    return index * sample_rate_hz / (_KERNEL_STEPS * cut.length), weights / weights.sum()
