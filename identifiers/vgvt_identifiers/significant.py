"""Which stable poles the responses need: residues larger than noise alone would make them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.residues import Residues, fit_residues
from vgvt_identifiers.spectra import RunSpectra
from vgvt_identifiers.stabilisation import Stabilisation


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
