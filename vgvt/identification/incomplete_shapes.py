"""Where a claimed shape is not known, in words: which modes at which DOFs, and what would tell it."""

from __future__ import annotations

import numpy as np

from vgvt.data import ModalModel

INCOMPLETE = "shape_incomplete"
_SHOWN = 8
_WHY = "the runs that measured there do not tie to the rest of the shape"
_ADVICE = "measure there with the same drive point, or keep one sensor in its place in all runs and use 'auto'"


def unknown_parts(model: ModalModel) -> tuple[str, ...]:
    """Advice on modes that carry the flag ``shape_incomplete``: where they are zero they are unknown.

    A number has to stand in the shape there, and it says nothing. Modes alike are told together.
    """
    flags = model.flags or ((),) * len(model)
    rows = [
        tuple(np.flatnonzero(shape == 0)) if INCOMPLETE in own else ()
        for shape, own in zip(model.shapes, flags, strict=True)
    ]
    told = []
    for where in dict.fromkeys(row for row in rows if row):
        at = [f"{f:.3f}" for f, row in zip(model.natural_frequency_hz, rows, strict=True) if row == where]
        which = f"the mode at {at[0]}" if len(at) == 1 else f"the modes at {_listed(at)}"
        places = _listed([str(model.dofs[d]) for d in where])
        told.append(f"the shape of {which} Hz is unknown, and stands as zero, at {places}: {_WHY}; {_ADVICE}")
    return tuple(told)


def _listed(names: list[str]) -> str:
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return ", ".join(names[:_SHOWN]) + more
