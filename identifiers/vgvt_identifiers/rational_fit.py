"""Common-denominator rational fit of many frequency responses in a window of frequency.

H_o(s) = sum_n c_on / (s - p_n) + background_o(f) + leakage_o(s) / F(s)

The poles p are common to all rows, everything else belongs to a row and is
linear. The background, orthogonal polynomials in a scaled frequency, takes up
the modes outside the window and the conjugate poles. The leakage term has the
same poles: it is the response left over when a record is cut while the
structure still moves. Poles start from vector fitting (Gustavsen and Semlyen,
IEEE Trans. Power Delivery 14(3), 1999) and end by variable projection
(Golub and Pereyra, SIAM J. Numer. Anal. 10(2), 1973) with Kaufman's Jacobian;
leakage after Pintelon, Schoukens and Vandersteen, Automatica 33(5), 1997.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.rational_problem import (
    LEAKAGE_BACKGROUND,
    Block,
    RationalProblem,
    columns,
    mirror,
    pole_columns,
    projected,
)

__all__ = ["Block", "RationalFit", "fit_rational", "pole_evidence"]

_RELOCATIONS = 8
_STEPS = 40


@dataclass(frozen=True, slots=True, eq=False)
class RationalFit:
    """Poles (N,) in rad/s with the standard deviation (N,) of their real and imaginary parts, and per block the rest.

    ``residues`` holds (R, N) per block, ``fitted`` the smooth responses (R, K)
    without the leakage, ``chi_square`` the weighted squared error per degree of freedom.
    """

    poles: NDArray[np.complex128]
    pole_std: NDArray[np.float64]
    residues: tuple[NDArray[np.complex128], ...]
    backgrounds: tuple[NDArray[np.complex128], ...]
    fitted: tuple[NDArray[np.complex128], ...]
    errors: tuple[NDArray[np.complex128], ...]
    chi_square: float
    converged: bool
    centre_rad_s: float
    half_width_rad_s: float
    mirrored: bool

    def at(self, frequency_hz: float, block: int) -> NDArray[np.complex128]:
        """The smooth responses (R,) of one block at any frequency of the window."""
        x = (2 * np.pi * frequency_hz - self.centre_rad_s) / self.half_width_rad_s
        scaled = (self.poles - 1j * self.centre_rad_s) / self.half_width_rad_s
        images = mirror(scaled, self.centre_rad_s / self.half_width_rad_s) if self.mirrored else None
        row = columns(np.array([x]), scaled, images, self.backgrounds[block].shape[1] - self._mirrors())[0]
        return np.asarray(np.hstack([self.residues[block] / self.half_width_rad_s, self.backgrounds[block]]) @ row)

    def _mirrors(self) -> int:
        return self.poles.size if self.mirrored else 0


def fit_rational(
    frequency_hz: NDArray[np.float64],
    blocks: tuple[Block, ...],
    start_poles: NDArray[np.complex128],
    background: int = 4,
    mirrored: bool = False,
    relocate: bool = True,
    steps: int = _STEPS,
) -> RationalFit:
    """Fit of the blocks over ``frequency_hz`` (K,) with as many poles as ``start_poles`` (N,), rad/s.

    ``background`` is the number of background polynomials; ``mirrored`` adds
    the conjugate poles, for windows that reach close to 0 Hz; ``relocate`` starts
    with vector fitting, for poles that are only roughly known; at most ``steps`` follow. ValueError when
    there are fewer lines than unknowns of a row.
    """
    omega = 2 * np.pi * frequency_hz
    centre, half = float(omega[0] + omega[-1]) / 2, float(omega[-1] - omega[0]) / 2
    unknowns = start_poles.size * (2 + 2 * mirrored) + background + LEAKAGE_BACKGROUND
    if frequency_hz.size < unknowns:
        raise ValueError(f"{frequency_hz.size} lines cannot hold {unknowns} unknowns a row")
    problem = RationalProblem.of((omega - centre) / half, blocks, background, centre / half if mirrored else None)
    z = _stable((start_poles - 1j * centre) / half)
    if relocate:
        z = _relocated(problem, z)
    z, converged = _polished(problem, z, steps)
    return _solution(problem, z, centre, half, converged)


def pole_evidence(
    frequency_hz: NDArray[np.float64], blocks: tuple[Block, ...], fit: RationalFit, background: int
) -> NDArray[np.float64]:
    """Worth of every pole (N,): twice the log likelihood it adds, less what its unknowns may fit of noise.

    Schwarz, Estimating the dimension of a model, Annals of Statistics 6(2), 1978.
    Above zero a pole is worth keeping. The rest of the fit is not moved when a
    pole is taken out, so the evidence of poles that can replace each other is too high.
    """
    omega = 2 * np.pi * frequency_hz
    centre, half = fit.centre_rad_s, fit.half_width_rad_s
    problem = RationalProblem.of((omega - centre) / half, blocks, background, centre / half if fit.mirrored else None)
    z = (fit.poles - 1j * centre) / half
    full = problem.cost(z)
    rows = sum(b.values.shape[0] for b in blocks)
    per_row = 1 + fit.mirrored + sum(b.leakage is not None for b in blocks) / len(blocks)
    penalty = (2 + 2 * rows * per_row) * np.log(2 * rows * omega.size)
    rest = np.array([problem.cost(np.delete(z, i)) for i in range(z.size)])
    return np.asarray(2 * (rest - full) / max(fit.chi_square, 1e-300) - penalty)


def _stable(z: NDArray[np.complex128]) -> NDArray[np.complex128]:
    return np.asarray(-np.maximum(np.abs(z.real), 1e-12) + 1j * z.imag)


def _relocated(problem: RationalProblem, z: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Vector fitting: the zeros of sigma(s) become the next poles, as long as the error falls."""
    best, best_cost = z, problem.cost(z)
    for _ in range(_RELOCATIONS):
        left: list[NDArray[np.complex128]] = []
        right: list[NDArray[np.complex128]] = []
        poles = pole_columns(problem.x, z)
        for stack, design in problem.designs(z):
            basis = np.linalg.qr(design)[0]
            stacked = (stack.data[:, :, :, None] * poles[:, None, :]).reshape(*stack.data.shape[:2], -1)
            for matrix, out, shape in ((stacked, left, (-1, z.size)), (stack.data, right, (-1,))):
                out.append((matrix - projected(basis, matrix)).reshape(*shape))
        sigma = -np.linalg.lstsq(np.vstack(left), np.concatenate(right), rcond=None)[0]
        moved = np.linalg.eigvals(np.diag(z) - np.outer(np.ones(z.size), sigma))
        z = _stable(moved.astype(np.complex128))
        cost = problem.cost(z)
        if cost >= best_cost * (1 - 1e-6):
            break
        best, best_cost = z, cost
    return np.asarray(best[np.argsort(best.imag)])


def _pole_std(problem: RationalProblem, z: NDArray[np.complex128], chi_square: float) -> NDArray[np.float64]:
    """Standard deviation (N,) of the real and of the imaginary part of z, the larger of two estimates.

    One takes all errors as independent, the other (White, Econometrica 48, 1980)
    lets the rows of a run share theirs, as noise of the force makes them do.
    """
    gram, meat = np.zeros((z.size, z.size), complex), np.zeros((z.size, z.size), complex)
    for error, slopes in problem.linearised(z):
        jacobian = slopes.reshape(-1, z.size)
        gram += jacobian.conj().T @ jacobian
        score = (slopes.conj() * error[..., None]).sum(axis=2).reshape(-1, z.size)
        meat += score.T @ score.conj()
    inverse = np.linalg.pinv(gram)
    independent = np.diag(inverse).real * chi_square
    shared = np.diag(inverse @ meat @ inverse.conj().T).real
    return np.asarray(np.sqrt(np.maximum(np.maximum(independent, shared), 0) / 2))


def _polished(problem: RationalProblem, z: NDArray[np.complex128], steps: int) -> tuple[NDArray[np.complex128], bool]:
    """Levenberg-Marquardt on the projected error, poles kept in the left half plane."""
    damping = 1e-3
    cost, gram, gradient = problem.normal_equations(z)
    for _ in range(steps):
        scale = np.diag(np.maximum(np.diag(gram).real, 1e-300))
        step = -np.linalg.solve(gram + damping * scale, gradient)
        trial = z + step
        if np.all(trial.real < 0):
            trial_cost, trial_gram, trial_gradient = problem.normal_equations(trial)
            if trial_cost <= cost:
                fall = cost - trial_cost
                small = np.all(np.abs(step) < 1e-6 * np.abs(z.real)) or fall < 1e-6 * cost
                z, cost, gram, gradient = trial, trial_cost, trial_gram, trial_gradient
                damping = max(damping / 10, 1e-12)
                if small:
                    return z, True
                continue
        damping *= 10
        if damping > 1e8:
            return z, bool(np.all(np.abs(step) < 1e-4 * np.abs(z.real)))
    return z, False


def _solution(
    problem: RationalProblem, z: NDArray[np.complex128], centre: float, half: float, converged: bool
) -> RationalFit:
    order = np.argsort(z.imag)
    z = z[order]
    cost = problem.cost(z)
    residues: list[NDArray[np.complex128]] = []
    backgrounds: list[NDArray[np.complex128]] = []
    fitted: list[NDArray[np.complex128]] = []
    errors: list[NDArray[np.complex128]] = []
    freedom = 0
    images = 0 if problem.mirror_at is None else z.size
    every = [d for stack, design in problem.designs(z) for d in zip(design, stack.data, strict=True)]
    for block, (design, data) in zip(problem.blocks, every, strict=True):
        found = np.linalg.lstsq(design, data, rcond=None)[0].astype(np.complex128)
        smooth = z.size + images + problem.background
        unscale = 1 / (block.weight[:, None] * block.row_scale)
        residues.append((found[: z.size] / block.row_scale).T * half)
        backgrounds.append((found[z.size : smooth] / block.row_scale).T)
        fitted.append(((design[:, :smooth] @ found[:smooth]) * unscale).T)
        errors.append(((data - design @ found) * unscale).T)
        freedom += (design.shape[0] - design.shape[1]) * data.shape[1]
    chi_square = cost / max(freedom - z.size, 1)
    return RationalFit(
        poles=z * half + 1j * centre,
        pole_std=_pole_std(problem, z, chi_square) * half,
        residues=tuple(residues),
        backgrounds=tuple(backgrounds),
        fitted=tuple(fitted),
        errors=tuple(errors),
        chi_square=chi_square,
        converged=converged,
        centre_rad_s=centre,
        half_width_rad_s=half,
        mirrored=problem.mirror_at is not None,
    )
