"""Which stable poles the responses need, and which of two fits: more than its unknowns may fit of noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.residues import Residues, fit_residues
from vgvt_identifiers.spectra import RunSpectra
from vgvt_identifiers.stabilisation import Stabilisation


@dataclass(frozen=True, slots=True)
class Misfit:
    """Weighted squared error of a fit of all runs, with the numbers of its real unknowns and equations."""

    cost: float
    unknowns: int
    equations: int

    def is_worth_less_than(self, other: Misfit) -> bool:
        """Whether the other fit of the same responses is the better one by Schwarz's criterion.

        Noise is as large as the closer of the two says.
        """
        scale = min(fit.cost / max(fit.equations - fit.unknowns, 1) for fit in (self, other))
        penalty = (self.unknowns - other.unknowns) * float(np.log(self.equations))
        return self.cost - other.cost + scale * penalty > 0


def misfit(runs: tuple[RunSpectra, ...], fits: tuple[Residues, ...]) -> Misfit:
    """The misfit of the residues of all runs together."""
    cost, unknowns, equations = 0.0, 0, 0
    for run, fit in zip(runs, fits, strict=True):
        lines = 2 * int((np.abs(run.force) > 0).sum())
        cost += float(fit.chi_square.sum()) * (lines - fit.unknowns)
        unknowns += fit.chi_square.size * fit.unknowns
        equations += fit.chi_square.size * lines
    return Misfit(cost, unknowns, equations)


def significant(
    frequency_hz: NDArray[np.float64], runs: tuple[RunSpectra, ...], stable: Stabilisation, transient: bool
) -> tuple[Stabilisation, tuple[Residues, ...]]:
    """The stabilisation without clusters whose residues could be noise, one by one, and the residues of the rest.

    A mode must add more to twice the log likelihood than its unknowns may fit
    of noise: Schwarz, Estimating the dimension of a model, Annals of Statistics 6(2), 1978.
    """
    rows = sum(len(run.responses) for run in runs)
    unknowns, equations = 2 + 2 * rows, 2 * rows * frequency_hz.size
    while True:
        poles = np.array([c.pole_rad_s for c in stable.modes], dtype=complex)
        residues = tuple(fit_residues(run, frequency_hz, poles, transient=transient) for run in runs)
        if not poles.size:
            return stable, residues
        worth = 2 * sum((np.abs(r.residues) ** 2 / r.std**2).sum(axis=0) for r in residues)
        least = int(np.argmin(worth))
        if worth[least] > unknowns * np.log(equations):
            return stable, residues
        cluster = stable.modes[least]
        why = f"{cluster.frequency_hz:.4g} Hz: stable, but its residues are no larger than noise makes them"
        stable = stable.without(cluster, why)
