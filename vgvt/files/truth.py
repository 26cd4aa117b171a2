"""The sealed truth of a synthetic campaign; identifiers may not import this module."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vgvt._version import __version__
from vgvt.data import InputError, ModalModel, RigidBodyProperties, Truth
from vgvt.files.modal_dataset import modal_dataset, modal_model, model_hash
from vgvt.files.netcdf import check_content, check_format, field, read_group, write_groups

if TYPE_CHECKING:
    import xarray

FORMAT = "vgvt truth"
FORMAT_VERSION = 3
_FIRST_WITH_HASH = 2


def write_truth(path: str | Path, truth: Truth) -> None:
    """Write the truth, whole or not at all; InputError when the place cannot be written."""
    import xarray

    root = xarray.Dataset(
        {
            "centre_of_gravity_m": ("axis", np.asarray(truth.rigid_body.centre_of_gravity_m, dtype=float)),
            "inertia_kg_m2": (("axis", "other_axis"), np.asarray(truth.rigid_body.inertia_kg_m2, dtype=float)),
        },
        attrs={
            "format": FORMAT,
            "format_version": FORMAT_VERSION,
            "vgvt_version": __version__,
            "scenario": truth.scenario,
            "mass_kg": float(truth.rigid_body.mass_kg),
            "runs": np.array(truth.runs, dtype=np.int64),
            "content_sha256": content_hash(truth),
        },
    )
    groups = {"/": root, "bare": modal_dataset(truth.bare)}
    for run, tested, coupled in zip(truth.runs, truth.as_tested, truth.coupled, strict=True):
        groups |= {f"as_tested_{run}": modal_dataset(tested), f"coupled_{run}": modal_dataset(coupled)}
    write_groups(path, groups)


def read_truth(path: str | Path) -> Truth:
    """Read the truth; InputError when the file is missing, damaged, of another kind or not what was written.

    Files of version 1 have no hash and are taken as they are. Up to version 2 the residues as tested, and the shapes
    with the shaker attached, are those of the displacement, where sensors that tilt feel gravity as well.
    """
    path = Path(path)
    root = read_group(path)
    check_format(path, root, FORMAT, FORMAT_VERSION)
    try:
        truth = _truth(path, root)
        found = content_hash(truth)
    except InputError:
        raise
    except (ValueError, TypeError, KeyError, AttributeError, OverflowError) as error:
        raise InputError(str(path), f"damaged: {error}", "simulate again") from error
    has_hash = "content_sha256" in root.attrs or int(field(path, root, "format_version")) >= _FIRST_WITH_HASH
    if has_hash:
        check_content(path, root, found)
    return truth


def content_hash(truth: Truth) -> str:
    """SHA-256 over everything that a truth says, the same for the same truth however it is stored."""
    body = truth.rigid_body
    facts = [
        truth.scenario,
        [int(run) for run in truth.runs],
        float(body.mass_kg),
        np.asarray(body.centre_of_gravity_m, dtype=float).tolist(),
        np.asarray(body.inertia_kg_m2, dtype=float).tolist(),
        [model_hash(model) for model in (truth.bare, *truth.as_tested, *truth.coupled)],
    ]
    return hashlib.sha256(json.dumps(facts).encode()).hexdigest()


def _truth(path: Path, root: xarray.Dataset) -> Truth:
    runs = tuple(int(run) for run in np.atleast_1d(field(path, root, "runs")))

    def model(group: str) -> ModalModel:
        return modal_model(path, read_group(path, group), group)

    return Truth(
        scenario=str(field(path, root, "scenario")),
        rigid_body=RigidBodyProperties(
            mass_kg=float(field(path, root, "mass_kg")),
            centre_of_gravity_m=field(path, root, "centre_of_gravity_m"),
            inertia_kg_m2=field(path, root, "inertia_kg_m2"),
        ),
        bare=model("bare"),
        runs=runs,
        as_tested=tuple(model(f"as_tested_{run}") for run in runs),
        coupled=tuple(model(f"coupled_{run}") for run in runs),
    )
