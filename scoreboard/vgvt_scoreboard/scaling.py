"""How well a claim knows the size of a mode's response to a force: its modal scaling."""

from __future__ import annotations

import numpy as np

from vgvt.data import ModalModel


def scaling_error_percent(true_model: ModalModel, i: int, claimed: ModalModel, j: int) -> float | None:
    """100 (|q| - 1), q the least-squares factor between claimed and true residues of one mode; None if not stated.

    Both models must have the same DOFs in the same order; references that they share are compared.
    The residue of a proportionally damped mode is phi_o phi_r / (2i omega_d m), so |q| is the true over
    the claimed modal mass for shapes of the same size (ISO 7626-1; Ewins, Modal Testing, 2000, chapter 2).
    """
    if true_model.residues is None or claimed.residues is None:
        return None
    known = {d.unsigned: k for k, d in enumerate(true_model.references)}
    pairs = [
        (known[d.unsigned], k, d.direction.sign * true_model.references[known[d.unsigned]].direction.sign)
        for k, d in enumerate(claimed.references)
        if d.unsigned in known
    ]
    if not pairs:
        return None
    true = np.concatenate([true_model.residues[i, :, a] for a, _, _ in pairs])
    said = np.concatenate([claimed.residues[j, :, b] * sign for _, b, sign in pairs])
    stated = np.isfinite(said) & np.isfinite(true)
    power = float(np.vdot(true[stated], true[stated]).real)
    if power == 0:
        return None
    return float(100 * (abs(np.vdot(true[stated], said[stated])) / power - 1))
