"""TDMS files as npTDMS writes them, and the bench's sidecar turned to them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from nptdms import ChannelObject, TdmsWriter

Row = tuple[str, np.ndarray, Mapping[str, Any]]
WAVEFORM = {"wf_increment": 0.01, "wf_start_offset": 0.0, "unit_string": "V"}


def write_tdms(path: Path, groups: Mapping[str, Sequence[Row]], segments: int = 1) -> None:
    """Groups of channels (name, samples (N,), properties), cut into as many segments as a recorder may write."""
    with TdmsWriter(str(path)) as writer:
        for part in range(segments):
            writer.write_segment(
                ChannelObject(group, name, np.array_split(samples, segments)[part], dict(properties))
                for group, rows in groups.items()
                for name, samples, properties in rows
            )


def rows_of(volts: np.ndarray, names: Sequence[str] = ("F", "A1", "A2"), **properties: Any) -> list[Row]:
    """One run of samples (N, channels) as volts at 100 Hz, with other properties where they are given."""
    return [(name, volts[:, k], WAVEFORM | properties) for k, name in enumerate(names)]


def cut_sidecar(text: str) -> str:
    """The bench's sidecar for TDMS: its variables are left to the test."""
    return (
        text.replace('format = "mat"', 'format = "tdms"')
        .replace('samples = "data"\ntime_s = "t"\n', "")
        .replace(".mat", ".tdms")
    )
