"""A modal model as a labelled dataset: complex shapes, residues and what is said about them."""

from __future__ import annotations

import json
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vgvt.data import Dof, ModalModel, Outcome
from vgvt.files.netcdf import field

if TYPE_CHECKING:
    import xarray

_ARRAYS: dict[str, tuple[str, ...]] = {
    "natural_frequency_hz": ("mode",),
    "damping_ratio": ("mode",),
    "shapes": ("mode", "dof"),
    "natural_frequency_std_hz": ("mode",),
    "damping_ratio_std": ("mode",),
    "modal_mass_kg": ("mode",),
    "residues": ("mode", "dof", "reference"),
}
_TEXTS = ("labels", "flags", "advice", "settings")


def modal_dataset(model: ModalModel) -> xarray.Dataset:
    """The dataset of a modal model; arrays that are None are left out."""
    import xarray

    arrays = {name: (dims, getattr(model, name)) for name, dims in _ARRAYS.items() if getattr(model, name) is not None}
    labels = {
        "dofs": json.dumps([d.label for d in model.dofs]),
        "references": json.dumps([d.label for d in model.references]),
        "method": model.method,
        "outcome": model.outcome.value,
        "output_only": int(model.output_only),
    }
    return xarray.Dataset(arrays, attrs=labels | {name: json.dumps(getattr(model, name)) for name in _TEXTS})


def model_hash(model: ModalModel) -> str:
    """SHA-256 over every label and number of a modal model, the same however it is stored."""
    digest = sha256()
    facts: list[Any] = [[d.label for d in model.dofs], [d.label for d in model.references]]
    facts += [
        model.method,
        model.outcome.value,
        model.labels,
        model.flags,
        model.advice,
        sorted(model.settings.items()),
    ]
    # Only where it says something: the hashes of files from before there was such a word must stay.
    facts += ["output only"] * model.output_only
    digest.update(json.dumps(facts).encode())
    for name in _ARRAYS:
        array = getattr(model, name)
        if array is not None:
            digest.update(json.dumps([name, array.shape]).encode())
            digest.update(np.ascontiguousarray(array, dtype="<c16" if np.iscomplexobj(array) else "<f8").data)
    return digest.hexdigest()


def modal_model(path: Path, dataset: xarray.Dataset, group: str) -> ModalModel:
    """The modal model of a dataset; InputError names what is missing, ValueError what does not fit together."""

    def text(name: str) -> Any:
        return json.loads(field(path, dataset, name, group))

    required = ("natural_frequency_hz", "damping_ratio", "shapes")
    arrays: dict[str, Any] = {
        name: np.asarray(field(path, dataset, name, group))
        for name in _ARRAYS
        if name in dataset.variables or name in required
    }
    return ModalModel(
        **arrays,
        dofs=tuple(Dof.from_label(label) for label in text("dofs")),
        references=tuple(Dof.from_label(label) for label in text("references")),
        labels=tuple(text("labels")),
        flags=tuple(tuple(remarks) for remarks in text("flags")),
        method=str(field(path, dataset, "method", group)),
        outcome=Outcome(field(path, dataset, "outcome", group)),
        advice=tuple(text("advice")),
        settings=text("settings"),
        output_only=bool(dataset.attrs.get("output_only", 0)),
    )
