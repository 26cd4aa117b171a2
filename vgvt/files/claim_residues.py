"""The residues of a claim as JSON, and back."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Dof, ModalModel


def residue_document(model: ModalModel) -> dict[str, Any] | None:
    """References, and residues of the receptance as nested lists over modes, DOFs and references; None without any."""
    if model.residues is None:
        return None
    return {
        "references": [reference.label for reference in model.references],
        "real_m_per_n_s": model.residues.real.tolist(),
        "imag_m_per_n_s": model.residues.imag.tolist(),
    }


def read_residues(
    document: dict[str, Any] | None, modes: int, dofs: int
) -> tuple[tuple[Dof, ...], NDArray[np.complex128] | None]:
    """References and residues (modes, dofs, references); ValueError when they are not of that shape or not finite."""
    if document is None:
        return (), None
    if not isinstance(document, dict) or not isinstance(document.get("references"), list):
        raise ValueError("expected references, real_m_per_n_s and imag_m_per_n_s")
    references = tuple(Dof.from_label(str(label)) for label in document["references"])
    if len({reference.unsigned for reference in references}) < len(references):
        raise ValueError("a reference is listed twice; opposite directions are one DOF")
    parts = []
    for key in ("real_m_per_n_s", "imag_m_per_n_s"):
        try:
            part = np.array(document.get(key), dtype=float).reshape(modes, dofs, len(references))
        except (TypeError, ValueError, OverflowError):
            shape = f"{modes} modes x {dofs} DOFs x {len(references)} references"
            raise ValueError(f"{key} is no list of numbers of {shape}") from None
        parts.append(part)
    residues = parts[0] + 1j * parts[1]
    if not np.isfinite(residues).all():
        raise ValueError("a residue is not a finite number")
    return references, residues
