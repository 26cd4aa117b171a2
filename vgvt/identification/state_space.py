"""A modal model with residues as a state-space model for control design."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError, ModalModel, Quantity

if TYPE_CHECKING:
    from control import StateSpace

_QUANTITIES = {Quantity.DISPLACEMENT: 0, Quantity.VELOCITY: 1, Quantity.ACCELERATION: 2}


def to_state_space(model: ModalModel, quantity: Quantity = Quantity.ACCELERATION) -> StateSpace:
    """The modal model as ``control.StateSpace``: inputs its references in N, outputs its DOFs in SI units, continuous.

    ``quantity`` chooses what the outputs are: displacement (receptance), velocity (mobility) or
    acceleration (accelerance); the frequency response is that of ``vgvt.data.synthesise``. A mode
    takes two real states for each independent column of its residues: two for a linear structure,
    whose residue matrix has rank one. The modes are all there is: what lies outside
    the identified band is missing, the rigid body above all. InputError for a model
    without residues or modes, or for a quantity that is no motion.

    With residues U V over DOFs and references, x' = [[Re p, Im p], [-Im p, Re p]] x + 2 [Re V; -Im V] f and
    y = [Re U, Im U] x; derivatives are C A with C B straight through, Ewins, Modal Testing, 2nd ed., 2000,
    section 2.7. A force makes no velocity jump, so C B is zero for a receptance. Errors of
    identified residues leave some of it, s C B in the accelerance, which no state space holds: it is left out.
    """
    if model.residues is None or not len(model):
        what = "no modes" if not len(model) else "no residues, so it says nothing about the size of a response"
        raise InputError("state space", f"the modal model has {what}", "use a method that states residues, such as era")
    if quantity not in _QUANTITIES:
        raise InputError("state space", f"{quantity.name} is no motion", "give displacement, velocity or acceleration")
    from control import StateSpace

    a, b, c, labels = _modal_form(model)
    d = np.zeros((c.shape[0], b.shape[1]))
    for _ in range(_QUANTITIES[quantity]):
        c, d = c @ a, c @ b
    names = {
        "inputs": [str(r) for r in model.references],
        "outputs": [str(dof) for dof in model.dofs],
        "states": labels,
    }
    return StateSpace(a, b, c, d, **names)


def _modal_form(
    model: ModalModel,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], list[str]]:
    """A, B, C of the receptance in real block-diagonal form, and a label for every state."""
    assert model.residues is not None
    blocks: list[NDArray[np.float64]] = []
    inputs: list[NDArray[np.float64]] = []
    outputs: list[NDArray[np.float64]] = []
    labels: list[str] = []
    for mode, (pole, residue) in enumerate(zip(model.poles, model.residues, strict=True)):
        block = np.array([[pole.real, pole.imag], [-pole.imag, pole.real]])
        for part, (left, right) in enumerate(_rank_one_parts(residue)):
            blocks.append(block)
            inputs.append(2 * np.array([right.real, -right.imag]))
            outputs.append(np.array([left.real, left.imag]).T)
            labels += [f"mode{mode + 1}_{part + 1}_{axis}" for axis in ("a", "b")]
    size = 2 * len(blocks)
    a = np.zeros((size, size))
    for i, block in enumerate(blocks):
        a[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = block
    return a, np.vstack(inputs), np.hstack(outputs), labels


def _rank_one_parts(
    residue: NDArray[np.complex128],
) -> list[tuple[NDArray[np.complex128], NDArray[np.complex128]]]:
    """Columns and rows whose products add up to a residue matrix (D, R)."""
    u, s, vh = np.linalg.svd(residue, full_matrices=False)
    keep = max(1, int((s > 1e-12 * s[0]).sum())) if s[0] > 0 else 1
    return [(u[:, k] * np.sqrt(s[k]), vh[k] * np.sqrt(s[k])) for k in range(keep)]
