"""Frequency responses of a reduced structure by complex modal superposition, roving masses by Woodbury's identity."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# Share of a coordinate's inertia beyond which its motion is not in the modes. Of a gauge that swings on clay within
# them a ten-thousandth is left to higher ones, and with a strong dashpot that is a tenth of a per cent of A/F: left
# out beyond some size of the clay, it would be a step that no fit gets over. Of a small absorber it is far less, and
# kept it would hide what that does behind what the modes left out do.
_LEFT_OUT = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Matrices:
    """Z = K + iωC - ω²M over m coordinates with the push ``drive`` (m,) and rows ``axis``, ``tilt`` (C, m).

    Accelerations are (-ω² axis + tilt) q. ``spare`` (C,) is the static flexibility, m/N, that the coordinates
    miss between drive and rows.
    """

    mass: Array
    damping: Array
    stiffness: Array
    drive: Array
    axis: Array
    tilt: Array
    spare: Array


@dataclass(frozen=True, slots=True, eq=False)
class Poles:
    """Poles and vectors of a reduced structure: q(ω) of an input h is vectors ((left h) / (iω - poles))."""

    poles: ComplexArray
    vectors: ComplexArray
    left: ComplexArray
    reciprocal: ComplexArray

    def modal(self, inputs: Array) -> ComplexArray:
        """Modal coordinates (inputs, L, 2m) answering to inputs (inputs, m)."""
        return np.asarray((inputs @ self.left.T)[:, None, :] * self.reciprocal)


def poles_of(matrices: Matrices, omega: Array) -> Poles:
    """Diagonalise a reduced structure for the lines ``omega`` (L,), rad/s."""
    m = matrices.drive.size
    inverse = np.linalg.inv(matrices.mass)
    system = np.zeros((2 * m, 2 * m))
    system[:m, m:] = np.eye(m)
    system[m:, :m] = -inverse @ matrices.stiffness
    system[m:, m:] = -inverse @ matrices.damping
    poles, vectors = np.linalg.eig(system)
    left = np.linalg.inv(vectors)[:, m:] @ inverse
    return Poles(poles, vectors[:m], left, 1.0 / (1j * omega[:, None] - poles))


def accelerances(
    matrices: Matrices,
    omega: Array,
    runs: tuple[NDArray[np.intp], ...],
    masses_kg: tuple[Array, ...],
    known: Poles | None = None,
) -> ComplexArray:
    """Accelerance (C, L) of every row, those of one run loaded by the run's point masses.

    ``runs`` give the rows of each run, ``masses_kg`` (rows of the run,) the masses that move with them
    beyond what is in the mass matrix (zeros: none). ``known`` are the poles of the matrices at these lines.
    """
    poles = poles_of(matrices, omega) if known is None else known
    square = omega**2
    to_axis = matrices.axis @ poles.vectors
    to_tilt = matrices.tilt @ poles.vectors
    pushed = poles.modal(matrices.drive[None])[0]
    moved = to_axis @ pushed.T + matrices.spare[:, None]
    out = -square * moved + to_tilt @ pushed.T
    loaded = [(rows, mass) for rows, mass in zip(runs, masses_kg, strict=True) if mass.any()]
    for size in {rows.size for rows, _ in loaded}:
        # Runs of as many sensors together: they are many, and each of them is little work.
        of = np.array([rows for rows, _ in loaded if rows.size == size])
        inertia = square[:, None] * np.array([mass for rows, mass in loaded if rows.size == size])[:, None, :]
        given = (matrices.axis[of] @ poles.left.T)[:, None]
        # Displacement and reading at row a for a unit force at row b, (runs, L, a, b): residues first, then all lines.
        flexible, reading = (_at_lines(poles, to[of][:, :, None] * given) for to in (to_axis, to_tilt))
        reading = reading - square[:, None, None] * flexible
        system = np.eye(size) - flexible * inertia[:, :, None, :]
        displaced = _solved(system, moved[of].transpose(0, 2, 1)[..., None])
        out[of] += (reading @ (inertia[..., None] * displaced))[..., 0].transpose(0, 2, 1)
    return np.asarray(out)


def _solved(system: ComplexArray, right: ComplexArray) -> ComplexArray:
    """Solutions (…, a, 1) of systems (…, a, a) next to the identity: of one or two sensors a run by Cramer's rule.

    Thousands of them are most of a prediction, and a general solver takes each by itself.
    """
    if system.shape[-1] == 1:
        return np.asarray(right / system)
    if system.shape[-1] == 2:
        (a, b), (c, d) = (tuple(system[..., i, k] for k in (0, 1)) for i in (0, 1))
        x, y = right[..., 0, 0], right[..., 1, 0]
        return np.asarray(
            np.stack([d * x - b * y, a * y - c * x], axis=-1)[..., None] / (a * d - b * c)[..., None, None]
        )
    return np.asarray(np.linalg.solve(system, right))


def _at_lines(poles: Poles, residues: ComplexArray) -> ComplexArray:
    """Sums over poles at all lines (runs, L, a, b) of residues (runs, a, b, 2m)."""
    runs, a, b, count = residues.shape
    found = poles.reciprocal @ residues.reshape(-1, count).T
    return np.asarray(found.reshape(-1, runs, a, b).transpose(1, 0, 2, 3))


@dataclass(frozen=True, slots=True, eq=False)
class Slopes:
    """Derivatives of :class:`Matrices` and of the runs' masses in some parameters, each with a leading axis (k,).

    ``masses_kg`` (k, C) are those of the point masses, by row; ``spare`` (k, C) is None where that is held.
    """

    mass: Array
    damping: Array
    stiffness: Array
    drive: Array
    axis: Array
    tilt: Array
    masses_kg: Array
    spare: Array | None = None


def by_rate(rate: Array, slopes: Array) -> Array:
    """Slopes (k, …) of amounts as those of scores, whose rates are (k,)."""
    return np.asarray(rate.reshape(-1, *[1] * (slopes.ndim - 1)) * slopes)


def loaded_by(matrices: Matrices, rows: NDArray[np.intp], mass: Array) -> Matrices:
    """The structure with the point masses (rows,) of a run, kg."""
    axis = matrices.axis[rows]
    return replace(matrices, mass=matrices.mass + (axis.T * mass) @ axis) if mass.any() else matrices


def reduction(mass: Array, stiffness: Array, drive: Array, limit_rad_per_s: float, always: NDArray[np.bool_]) -> Array:
    """Basis (n, m): undamped modes up to a limit, and what they leave out of the coordinates ``always`` (n,).

    Modes are those of the structure without what a gauge reads besides the force at ``drive`` (n,): half of that made
    symmetric is no aircraft's stiffness. At least twelve are kept. A coordinate whose motion is in them already adds
    nothing.
    """
    heavy = (mass + mass.T) / 2
    bare = unfelt(stiffness, drive)
    squares, shapes = scipy.linalg.eigh((bare + bare.T) / 2, heavy)
    count = max(12, int(np.searchsorted(squares, limit_rad_per_s**2)))
    basis = np.asarray(shapes[:, :count])
    if always.any() and count < mass.shape[0]:
        # In units of each coordinate's own inertia, of which the modes left out hold some share.
        own = np.eye(mass.shape[0])[:, always] / np.sqrt(np.diag(heavy)[always])
        missing = own - basis @ (basis.T @ heavy @ own)
        shares, turned = np.linalg.eigh(missing.T @ heavy @ missing)
        kept = shares > _LEFT_OUT
        basis = np.hstack([basis, missing @ turned[:, kept] / np.sqrt(shares[kept])])
    return basis


def unfelt(stiffness: Array, drive: Array) -> Array:
    """The stiffness (n, n) without what a gauge reads of it besides the force at ``drive`` (n,)."""
    return np.asarray(stiffness + np.outer(drive, _felt(stiffness, drive)))


def _felt(stiffness: Array, drive: Array) -> Array:
    """What a gauge reads of each coordinate (n,) besides the force at ``drive`` (n,), but for what reads like it.

    The only part of a stiffness that is not symmetric is ``-drive felt``; what of ``felt`` is along the drive looks
    like a spring there.
    """
    size = float(drive @ drive)
    return np.asarray((stiffness - stiffness.T) @ drive / size) if size > 0 else np.zeros(drive.size)
