"""A beam of four cells that the whole loop takes seconds for, and a campaign of it on disk."""

from __future__ import annotations

from pathlib import Path

from vgvt.data import Campaign

BEAM = """
extends = "teaching-beam"
name = "coarse-beam"
summary = "A coarse beam in four runs of two sensors."

[[airframe.beam]]
name = "beam"
cells = 4

[tolerances]
segments = 0

[acquisition]
sample_rate_hz = 100.0
runs = [[1, 2], [3, 4], [5, 6], [7, 8]]

[excitation]
start_hz = 2.0
stop_hz = 25.0
duration_s = 20.0
"""


def written(folder: Path, campaign: Campaign) -> Path:
    """The campaign as a file in a folder."""
    from vgvt.files import write_campaign

    path = folder / "measured.nc"
    write_campaign(path, campaign)
    return path
