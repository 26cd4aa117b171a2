"""Frequency response functions synthesised from a modal model.

H(iw) = sum_r R_r / (iw - p_r) + conj(R_r) / (iw - conj(p_r)) is the receptance; Ewins, Modal
Testing: Theory, Practice and Application, 2nd ed., 2000, section 2.7.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.data.channel import Quantity
from vgvt.data.frf import FrequencyResponseSet
from vgvt.data.modal import ModalModel

_DERIVATIVES = {Quantity.DISPLACEMENT: 0, Quantity.VELOCITY: 1, Quantity.ACCELERATION: 2}


def modal_contributions(
    model: ModalModel,
    frequency_hz: NDArray[np.float64],
    quantity: Quantity = Quantity.ACCELERATION,
    added_decay_rad_per_s: float = 0.0,
) -> NDArray[np.complex128]:
    """What each mode alone adds to every FRF, shape (modes, responses, references, frequency), SI.

    ``quantity`` chooses receptance (displacement), mobility or accelerance. ``added_decay_rad_per_s`` is that of an
    exponential window, through which responses are seen along s = added + iω.
    ValueError when the model has no residues or the quantity is no motion.
    """
    if model.residues is None:
        raise ValueError("the modal model states no residues, so no FRF can be synthesised from it")
    if quantity not in _DERIVATIVES:
        raise ValueError(f"FRFs are synthesised of displacement, velocity or acceleration, not {quantity.name}")
    s = added_decay_rad_per_s + 2j * np.pi * np.asarray(frequency_hz, dtype=float)
    pole = model.poles[:, None]
    residue = model.residues[..., None]
    upper = (1 / (s - pole))[:, None, None, :]
    lower = (1 / (s - pole.conj()))[:, None, None, :]
    return np.asarray((residue * upper + residue.conj() * lower) * s ** _DERIVATIVES[quantity])


def synthesise(
    model: ModalModel,
    frequency_hz: NDArray[np.float64],
    quantity: Quantity = Quantity.ACCELERATION,
    runs: tuple[int, ...] | None = None,
    added_decay_rad_per_s: float = 0.0,
) -> FrequencyResponseSet:
    """The FRFs of a modal model at all its DOFs and references over ``frequency_hz`` (F,), accelerance by default.

    ``runs`` labels each response with a run; left out, all belong to run 0. With ``added_decay_rad_per_s`` they are
    seen through an exponential window. ValueError as for :func:`modal_contributions`.
    """
    frequency = np.asarray(frequency_hz, dtype=float)
    return FrequencyResponseSet(
        responses=model.dofs,
        references=model.references,
        frequency_hz=frequency,
        values=modal_contributions(model, frequency, quantity, added_decay_rad_per_s).sum(axis=0),
        runs=runs if runs is not None else (0,) * len(model.dofs),
        quantity=quantity,
        added_decay_rad_per_s=added_decay_rad_per_s,
    )
