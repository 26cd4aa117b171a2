"""Consistent-mode indicators of the eigensystem realization algorithm: EMAC and CMI.

Pappa, Elliott and Schenk, Consistent-mode indicator for the eigensystem
realization algorithm, J. Guidance 16(5), 1993. The third of the family, MPC, is
``vgvt.data.modal_phase_collinearity``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.data import modal_phase_collinearity
from vgvt_identifiers.data_correlation import CorrelatedRealisation
from vgvt_identifiers.hankel import Realisation, Roots

_DECAY = 2.0
_LARGEST_PHASE = np.pi / 4


def extended_modal_amplitude_coherence(model: Realisation, roots: Roots) -> NDArray[np.float64]:
    """EMAC (n,) of every root of a realisation, 1 for a mode that decays as its root says.

    The singular vectors hold every mode's own amplitude at later rows and
    columns; it is compared with z^k times the first one, in size and phase, and
    weighted over the responses by the square of the shape. The paper compares at the last row.
    Here it is the one at which the mode has decayed by e^-2, if that comes earlier, as
    nothing but noise is left of a well damped mode at the end.
    """
    coherence = np.zeros(roots.values.size)
    shapes, driven = model.shapes(roots), roots.left @ model.b
    for i, z in enumerate(roots.values):
        late = _late(z)
        row, column = min(late, model.rows - 1), min(late, model.columns - 1)
        seen = model.impulse[:, row : row + model.columns] @ (model.right / model.scale) @ roots.right[:, i]
        out = _agreement(shapes[i] * z**row, seen)
        weight = np.abs(shapes[i]) ** 2
        into = _agreement(driven[i] * z**column, (model.right[column] * model.scale) @ roots.left[i])
        coherence[i] = float((out * weight).sum() / max(weight.sum(), np.finfo(float).tiny) * into)
    return coherence


def correlated_amplitude_coherence(model: CorrelatedRealisation, roots: Roots) -> NDArray[np.float64]:
    """The same indicator (n,) for a realisation of correlations, whose first factor holds every mode's z^k."""
    coherence = np.zeros(roots.values.size)
    scale = np.sqrt(model.singular_values[: model.a.shape[0]])
    ahead = (model.u * scale @ roots.right).T.reshape(roots.values.size, -1, model.columns)
    behind = (model.v * scale @ roots.left.T).T.reshape(roots.values.size, -1, model.columns)
    for i, z in enumerate(roots.values):
        late = _late(z)
        block = min(late // model.lag, ahead.shape[1] - 1)
        place = min(late - model.lag * block, model.columns - 1)
        out = _agreement(ahead[i, 0, :1] * z ** (model.lag * block + place), ahead[i, block, place : place + 1])
        into = np.ones(1)
        if behind.shape[1] > 1:
            weight = np.abs(behind[i, 0]) ** 2
            into = (_agreement(behind[i, 0] * z**model.lag, behind[i, 1]) * weight).sum() / weight.sum()
        coherence[i] = float((out * into).item())
    return coherence


def consistent_mode_indicator(emac: NDArray[np.float64], shapes: NDArray[np.complex128]) -> NDArray[np.float64]:
    """CMI (n,) = EMAC (n,) times the modal phase collinearity of ``shapes`` (n, R)."""
    return np.asarray(emac * modal_phase_collinearity(shapes))


def _late(root: complex) -> int:
    """Samples after which a mode has decayed by e^-2, at least one."""
    return max(1, int(_DECAY / max(-np.log(min(abs(root), 1 - 1e-12)), 1e-9)))


def _agreement(expected: NDArray[np.complex128], seen: NDArray[np.complex128]) -> NDArray[np.float64]:
    """1 where two amplitudes are equal, less for a ratio or a phase that differs, 0 from 45 degrees on."""
    small, large = np.minimum(np.abs(expected), np.abs(seen)), np.maximum(np.abs(expected), np.abs(seen))
    ratio = np.divide(small, large, out=np.zeros_like(small), where=large > 0)
    phase = np.abs(np.angle(seen * np.conj(expected)))
    return np.asarray(ratio * np.maximum(1 - phase / _LARGEST_PHASE, 0))
