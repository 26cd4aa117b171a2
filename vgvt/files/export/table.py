"""Runs and frequency responses as text: one heading, then a line a sample or a frequency, between commas."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Channel, FrequencyResponseSet, Record

HEADING_ROWS = 1
_DOUBLE, _SINGLE = "%.17g", "%.9g"  # what it takes to read the same number again
_TIME = "%.12g"


def write_run(path: Path, record: Record) -> None:
    """Time in seconds, then every channel in SI, in columns that are headed by name, DOF and unit."""
    digits = _SINGLE if record.samples.dtype == np.float32 else _DOUBLE
    columns = np.vstack([record.time_s, record.samples]).T
    headings = ["time [s]", *map(_heading, record.channels)]
    _write(path, headings, columns, [_TIME, *[digits] * len(record.channels)])


def write_responses(path: Path, frf: FrequencyResponseSet) -> None:
    """Frequency, then real and imaginary part of every response, and its coherence where it is known."""
    unit = f"[({frf.quantity.si_unit})/N]"
    headings, columns = ["frequency [Hz]"], [frf.frequency_hz]
    for i, response in enumerate(frf.responses):
        for j, reference in enumerate(frf.references):
            headings += [f"{part} {response}/{reference} {unit}" for part in ("real", "imag")]
            columns += [frf.values[i, j].real, frf.values[i, j].imag]
            if frf.coherence is not None:
                headings.append(f"coherence {response}/{reference}")
                columns.append(frf.coherence[i, j])
    _write(path, headings, np.column_stack(columns), [_DOUBLE] * len(columns))


def _write(path: Path, headings: Sequence[str], columns: NDArray[np.floating], form: Sequence[str]) -> None:
    first = io.StringIO()
    csv.writer(first, lineterminator="\n").writerow(headings)
    with path.open("w", encoding="utf-8", newline="") as stream:
        stream.write(first.getvalue())
        np.savetxt(stream, columns, fmt=",".join(form))


def _heading(channel: Channel) -> str:
    place = "" if channel.dof is None else f" {channel.dof}"
    # A line end in a name would be a second heading row, and a NUL makes no text of it.
    return f"{' '.join(channel.name.replace(chr(0), ' ').split())}{place} [{channel.unit}]"
