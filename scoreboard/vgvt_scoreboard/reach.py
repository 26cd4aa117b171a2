"""Which modes a test can see: those about which it holds enough information.

A shaker on a node line leaves a mode unmoved; not to report it is no mistake.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.data import ModalModel, modal_contributions

DAMPING_KNOWN_WITHIN = 0.10
"""A mode is reachable where the best unbiased method could know its damping ratio this well (relative deviation)."""

UNREACHED_BELOW = 0.02
"""Share of the total sigma below which a mode counts as unreached, where the truth states no limit."""


def reachable(model: ModalModel) -> NDArray[np.bool_]:
    """True for every mode that the test holds enough information about, shape (M,).

    The standard deviations of a merged truth are the Cramér–Rao bounds of the whole campaign: a damping ratio
    known within 10 % is enough. Where that of the damping is not stated it is taken from the frequency's,
    std(ζ)/ζ = std(f)/(ζ f), as for a mode alone. A truth without any is judged by :func:`sigma_share`, 2 % and more;
    without residues too, every mode counts as reachable.
    """
    limit = model.damping_ratio_std
    if limit is None and model.natural_frequency_std_hz is not None:
        limit = model.natural_frequency_std_hz / model.natural_frequency_hz
    if limit is not None:
        return np.asarray(limit / model.damping_ratio <= DAMPING_KNOWN_WITHIN)
    share = sigma_share(model)
    return np.asarray(np.isnan(share) | (share >= UNREACHED_BELOW))


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
