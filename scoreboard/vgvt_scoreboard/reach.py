"""Which modes a test can see: each mode's own share of the sigma plot at its natural frequency.

A shaker on a node line leaves a mode unmoved; not to report it is no mistake.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.data import ModalModel, modal_contributions

UNREACHED_BELOW = 0.02
"""Share of the total sigma below which a mode counts as unreached."""


def sigma_share(model: ModalModel) -> NDArray[np.float64]:
    """Peak accelerance of each mode alone over that of all modes together at its frequency, shape (M,).

    Both are largest singular values over the DOFs and references of ``model``, at the natural
    frequency of the mode. A model without residues answers NaN: nothing can be said.
    """
    if model.residues is None or not len(model):
        return np.full(len(model), np.nan)
    share = np.zeros(len(model))
    for r, frequency in enumerate(model.natural_frequency_hz):
        if frequency > 0:
            alone = modal_contributions(model, np.array([frequency]))[..., 0]
            total = np.linalg.norm(alone.sum(axis=0), 2)
            share[r] = np.linalg.norm(alone[r], 2) / total if total > 0 else 0.0
    return share


def reachable(model: ModalModel) -> NDArray[np.bool_]:
    """True for every mode whose share is at least 2 % or unknown, shape (M,)."""
    share = sigma_share(model)
    return np.asarray(np.isnan(share) | (share >= UNREACHED_BELOW))
