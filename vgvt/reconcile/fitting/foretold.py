"""What a prediction foretells of data that no fit has seen, whose own gains no other record can tell."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.question.problem import Problem

ComplexArray = NDArray[np.complex128]
# Standard deviations that a tolerance reaches.
_WITHIN = 3.0


def foretold(problem: Problem, predicted: ComplexArray) -> ComplexArray:
    """A prediction (C, L), each held-out channel's own gain left open within its tolerance.

    No other record can tell that gain, whatever the model: a fit without it would be blamed for it.
    """
    found = predicted.copy()
    for nuisance in problem.nuisances:
        own = np.flatnonzero(nuisance.rows)
        if nuisance.kind != "gain" or own.size != 1 or not problem.split.held[own[0]]:
            continue
        sigma = problem.measured.sigma[own[0]]
        here = found[own[0]] / sigma
        missing = problem.measured.values[own[0]] / sigma - here
        # |missing - a here|² + (a / sd)² / 2, the square sum of complex values against the score's.
        share = (here.conj() @ missing).real / ((here.conj() @ here).real + 0.5 / nuisance.sd**2)
        # Many lines leave the prior no say: beyond its tolerance a gain is a miss, whatever they prefer.
        found[own[0]] *= 1 + float(np.clip(share, -_WITHIN * nuisance.sd, _WITHIN * nuisance.sd))
    return found


def held_out_chi2(problem: Problem, predicted: ComplexArray) -> float | None:
    """χ² per held-out value of what a prediction (C, L) foretells; None where nothing is held out."""
    measured, held = problem.measured, problem.split.held
    if not held.any():
        return None
    return float(np.mean(np.abs((foretold(problem, predicted) - measured.values)[held] / measured.sigma[held]) ** 2))
