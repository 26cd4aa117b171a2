"""Runs and frequency responses as MAT files (version 5) that MATLAB, Octave and scipy read."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, FrequencyResponseSet, Geometry, InputError, Record

SAMPLES, TIME = "samples", "time_s"
"""The variables that a sidecar names."""
_LARGEST_BYTES = 2**31


def run_variables(campaign: Campaign, record: Record) -> dict[str, Any]:
    """One run as MATLAB's ``modalfrf`` takes it: samples (N, channels), the rest beside it, lists as cells."""
    channels = record.channels
    return {
        SAMPLES: record.samples.T,
        TIME: record.time_s[:, None],
        "sample_rate_hz": record.sample_rate_hz,
        "run": float(record.run),
        "channel": _cells(channel.name for channel in channels),
        "quantity": _cells(channel.quantity.name.lower() for channel in channels),
        "unit": _cells(channel.unit for channel in channels),
        "role": _cells(channel.role.value for channel in channels),
        "dof": _cells("" if channel.dof is None else channel.dof.label for channel in channels),
        "sensitivity_v_per_unit": np.array([[channel.sensitivity_v_per_unit] for channel in channels]),
        "range_v": np.array([[channel.range_v] for channel in channels]),
        "overloaded": _cells(record.overloaded),
        "campaign": campaign.name,
        "band_hz": np.array([campaign.band_hz], dtype=float),
        "notes": _cells([*(f"{key}: {text}" for key, text in campaign.notes.items()), *record.notes]),
        **_places(campaign.geometry),
    }


def response_variables(frf: FrequencyResponseSet, name: str, geometry: Geometry) -> dict[str, Any]:
    """Frequency responses as ``modalfrf`` gives and ``modalfit`` takes them: (lines, responses, references)."""
    found: dict[str, Any] = {
        "frf": frf.values.transpose(2, 0, 1),
        "frequency_hz": frf.frequency_hz[:, None],
        "response": _cells(dof.label for dof in frf.responses),
        "reference": _cells(dof.label for dof in frf.references),
        "quantity": frf.quantity.name.lower(),
        "unit": f"({frf.quantity.si_unit})/N",
        "run": np.array([[float(run)] for run in frf.runs]),
        "campaign": name,
        **_places(geometry),
    }
    for key, array in (("coherence", frf.coherence), ("variance", frf.variance)):
        found |= {} if array is None else {key: array.transpose(2, 0, 1)}
    return found


def write_mat(path: Path, variables: dict[str, Any], final: Path) -> None:
    """Write variables into ``path``; InputError, in the name of ``final``, where one is larger than the format has."""
    import scipy.io

    for name, array in variables.items():
        if isinstance(array, np.ndarray) and array.nbytes >= _LARGEST_BYTES:
            raise InputError(
                str(final),
                f"a MAT file of version 5 holds 2 GiB a variable, and {name} has {array.nbytes / 2**30:.1f} GiB",
                "write a .uff or .nc in its place",
            )
    scipy.io.savemat(path, variables, appendmat=False, do_compression=True, oned_as="column")


def _places(geometry: Geometry) -> dict[str, Any]:
    lines = np.empty((len(geometry.lines), 1), dtype=object)
    for k, line in enumerate(geometry.lines):
        lines[k, 0] = np.array([line], dtype=float)
    return {
        "node": np.array(geometry.nodes, dtype=float)[:, None],
        "position_m": np.asarray(geometry.positions_m, dtype=float),
        "lines": lines,
    }


def _cells(texts: Iterable[str]) -> NDArray[np.object_]:
    """A column of texts as a cell array (K, 1)."""
    return np.array(list(texts), dtype=object).reshape(-1, 1)
