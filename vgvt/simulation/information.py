"""How well a test can know its modes at all: the Cramér-Rao bound of every frequency and damping ratio.

No unbiased estimate scatters less than the square root of the diagonal of the inverse Fisher information. What
counts as unknown decides what that is. Here it is what any method has to find that is not told the aircraft: poles
and residues of all modes in the band together, a rest of each response, and those modes outside the band whose
absence the records would show. Known are the noise's densities and, of several forces, the proportions in which they
push a mode; the rest answers to as many of them as commands are independent, as repeats tell the others. The force
is taken as it drops out along each resonance; its noise is in all responses at once.

For one mode alone with s = ζω, in a flat spectrum and noise, it is close to std(f) = sqrt(2 s / (E S)) / 2π with
S = Σ|H_o|²/G_o, E the energy density of the force (N² s²) and |H_o| the peak accelerance in noise of one-sided
density G_o; with noise G_f of the force S falls to S / (1 + G_f S). Then std(ζ)/ζ = std(f) / (ζ f).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import ModalModel
from vgvt.simulation.assembly import Plan
from vgvt.simulation.command_spectra import command_spectra
from vgvt.simulation.fisher import (
    Forces,
    Lines,
    accelerance,
    deviations,
    information_of_responses,
    lines_for,
    weighted_slopes,
)
from vgvt.simulation.force_path import ForcePath
from vgvt.simulation.noise_floor import force_noise, response_noise
from vgvt.simulation.shared_noise import shared_information
from vgvt.simulation.state_space import StateSpace
from vgvt.simulation.unknowns import unknowns

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Points = NDArray[np.intp] | tuple[int, ...]

_BEYOND = 1.15  # modes as near to the band as this factor may make the responses change within it
_TOLD_APART = 1e-6  # of their power, that commands must differ by to be more than one


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What a run would see over ``lines``: ``unknown`` are the indices of the modes whose poles it must find.

    ``background`` are the powers of s that stand for all other modes; ``forces`` what pushes the modes;
    ``noise`` (K,) of a response and ``felt`` (K,) of a force, per Hz; ``residues`` (M, D) of all modes at all points
    for the force that moves each most; ``response`` (D, R, K) the accelerances.
    """

    lines: Lines
    unknown: NDArray[np.intp]
    background: tuple[int, ...]
    forces: Forces
    noise: Array
    felt: Array
    residues: Complex
    response: Complex

    def information_by_response(self, poles: Complex, together: Points) -> Array:
        """What each point tells of the unknown ones of ``poles`` (M,), (D, 2 U, 2 U), with ``together`` measured."""
        weight = _weight(self.noise, self.felt, self.response[list(together)])
        forces = self.forces.of(self.unknown)
        gram = weighted_slopes(self.lines, poles[self.unknown], weight, self.background, forces)
        return information_of_responses(gram, self.residues[self.unknown])

    def information(self, poles: Complex, together: Points) -> Array:
        """What all of ``together`` tell of the unknown ones of ``poles`` (M,), (2 U, 2 U), without a short cut."""
        residues = self.residues[self.unknown][:, list(together)]
        felt = np.sqrt(self.felt) * self.response[list(together)]
        forces = self.forces.of(self.unknown)
        return shared_information(
            self.lines, poles[self.unknown], residues, (self.noise, felt), self.background, forces
        )


def least_deviations(layout: Plan, run: int, driven: StateSpace, modes: ModalModel) -> tuple[Array, Array]:
    """Least standard deviations of natural frequencies, Hz, and damping ratios, (M,) each, that a run (from 0) allows.

    ``modes`` have residues for the forces that the run measures. Infinite for a mode that the force or every sensor
    misses, NaN outside the swept band: what force leaks there is the window's, not the test's.
    """
    low, high = layout.scenario.excitation.recorded_band_hz
    swept = (modes.natural_frequency_hz >= low) & (modes.natural_frequency_hz <= high)
    least = np.full((2, len(modes)), np.nan)
    if swept.any():
        nodes = {p.dof for p in layout.run_points(run)}
        sensors = tuple(i for i, dof in enumerate(modes.dofs) if dof in nodes)
        seen = seen_in_run(layout, run, ForcePath.of(driven), modes, sensors)
        least[:, seen.unknown] = deviations(modes.poles[seen.unknown], seen.information(modes.poles, sensors))
        least[:, ~swept] = np.nan
    return least[0], least[1]


def seen_in_run(layout: Plan, run: int, path: ForcePath, modes: ModalModel, sensors: Points) -> Seen:
    """What a run (from 0) would see of ``modes`` with residues, with ``sensors`` (S,) among their DOFs."""
    if modes.residues is None:
        raise ValueError("modes need residues")
    low, high = layout.scenario.excitation.recorded_band_hz
    frequency, poles = modes.natural_frequency_hz, modes.poles
    lines = lines_for((low, high), poles[(frequency >= low / _BEYOND) & (frequency <= high * _BEYOND)])
    best, shares = _strongest(modes.residues[:, list(sensors)])
    residues = modes.residues[np.arange(len(modes)), :, best]
    # Several inputs whose phases change within a line count as as many forces after each other.
    products = command_spectra(layout, run, lines)
    after_each_other = path.per_input(lines.frequency_hz) @ _root(products)
    spectra = np.concatenate(np.moveaxis(after_each_other, 2, 0)).T
    commands = np.linalg.matrix_rank(products.sum(axis=0), tol=_TOLD_APART * np.trace(products.sum(axis=0)).real)
    forces = Forces(spectra, shares, np.linalg.svd(spectra, full_matrices=False)[0][:, :commands].conj().T @ spectra)
    count = after_each_other.shape[2]
    lines = Lines(np.tile(lines.frequency_hz, count), np.tile(lines.width_hz, count))
    f = lines.frequency_hz
    noise, felt = response_noise(layout, f), force_noise(layout, f)
    response = np.stack([accelerance(f, poles, modes.residues[:, :, r]) for r in range(shares.shape[1])], axis=1)
    inside, measured = np.flatnonzero((frequency >= low) & (frequency <= high)), response[list(sensors)]
    moved = np.einsum("srk,rk->sk", measured, forces.spectra)
    asked = unknowns(lines, poles, inside, _weight(noise, felt, measured), moved, forces)
    return Seen(lines, asked.modes, asked.background, forces, noise, felt, residues, response)


def _root(products: Complex) -> Complex:
    """Matrices (K, I, I) whose products with their conjugate transposes are Hermitian ones (K, I, I)."""
    values, vectors = np.linalg.eigh(products)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :])


def _strongest(residues: Complex) -> tuple[NDArray[np.intp], Complex]:
    """Of residues (M, S, R): the strongest reference of each mode, (M,), and shares (M, R) of all in it."""
    modes = np.arange(len(residues))
    best = np.argmax((np.abs(residues) ** 2).sum(axis=1), axis=1)
    strongest = residues[modes, :, best]
    power = np.maximum((np.abs(strongest) ** 2).sum(axis=1), np.finfo(float).tiny)
    shares = np.einsum("md,mdr->mr", strongest.conj(), residues) / power[:, None]
    shares[modes, best] = 1.0
    return best, shares


def _weight(noise: Array, felt: Array, measured: Complex) -> Array:
    """4 / G (K,) of a response when all that are measured, (S, R, K), share the noise of the forces."""
    return np.asarray(4 / (noise + felt * (np.abs(measured) ** 2).sum(axis=(0, 1))))
