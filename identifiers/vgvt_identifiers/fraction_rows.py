"""The responses of a campaign as rows of a matrix fraction: which of them share a row over several references."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Dof
from vgvt_identifiers.matrix_fraction import FractionRows
from vgvt_identifiers.spectra import RunSpectra

_FLOOR = 1e-6  # of a response's own size: less noise than that is the round-off of the model, not of the sensor
_FEWEST_COMPLETE = 0.5

Entry = tuple[int, int]
"""A run's place among the runs and a response's place in it."""


def fraction_rows(frequency_hz: NDArray[np.float64], runs: tuple[RunSpectra, ...], leakage: bool) -> FractionRows:
    """Rows over all references of those DOFs that were measured under each, if these are half of all entries.

    Otherwise, and with one reference, every response of every run is a row of
    its own under a common scalar denominator. Without ``leakage`` records count as free of it.
    """
    references = tuple(dict.fromkeys(r.reference.unsigned for r in runs))
    entries = [(i, j) for i, run in enumerate(runs) for j in range(len(run.responses))]
    table: dict[Dof, dict[Dof, Entry]] = {}
    for i, j in entries:
        table.setdefault(runs[i].responses[j].unsigned, {}).setdefault(runs[i].reference.unsigned, (i, j))
    complete = [[row[r] for r in references] for row in table.values() if len(row) == len(references)]
    if len(complete) * len(references) < _FEWEST_COMPLETE * len(entries):
        complete = [[entry] for entry in entries]
    if len(references) == 1:
        complete = [[entry] for entry in entries]
    values = np.array([[_signed(runs, entry) for entry in row] for row in complete])
    variance = np.array([[_variance(runs, entry) for entry in row] for row in complete])
    inverse = np.array([[_inverse_force(runs[i].force) for i, _ in row] for row in complete])
    leakage = leakage and not any(run.averaged for run in runs)
    return FractionRows(frequency_hz, values, variance, inverse if leakage else inverse[:, :0])


def _signed(runs: tuple[RunSpectra, ...], entry: Entry) -> NDArray[np.complex128]:
    """A response along the positive axes, so that runs with a sensor or a shaker turned round agree."""
    run = runs[entry[0]]
    sign = run.responses[entry[1]].direction.sign * run.reference.direction.sign
    return np.asarray(sign * run.accelerance[entry[1]])


def _variance(runs: tuple[RunSpectra, ...], entry: Entry) -> NDArray[np.float64]:
    run, row = runs[entry[0]], entry[1]
    size = float(np.median(np.abs(run.accelerance[row]) ** 2))
    return np.asarray(np.maximum(run.variance[row], _FLOOR**2 * size + np.finfo(float).tiny))


def _inverse_force(force: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """1/F in units of its median; zero where there is no force."""
    alive = np.abs(force) > 1e-12 * np.abs(force).max(initial=0.0)
    inverse = np.divide(1, force, out=np.zeros_like(force), where=alive)
    return np.asarray(inverse / np.median(np.abs(inverse[alive])))
