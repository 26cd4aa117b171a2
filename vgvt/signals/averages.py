"""The averages that an estimate is made of: their length, window and overlap, and where the first begins."""

from __future__ import annotations

import json
from dataclasses import dataclass

from vgvt.data import Campaign, InputError

BLOCKS_NOTE = "blocks"
_PARTS = 8  # of a record without bursts; with half an overlap they are 15 averages


@dataclass(frozen=True, slots=True)
class Averages:
    """Segments of ``segment_s`` with a fractional ``overlap`` from ``lead_in_s`` on; None for whole records."""

    segment_s: float | None = None
    window: str = "hann"
    overlap: float = 0.5
    lead_in_s: float = 0.0


def averages_of_notes(campaign: Campaign) -> Averages | None:
    """The bursts that a campaign's notes tell of, None without any; InputError for a note that cannot be read.

    A burst starts and ends at rest: nothing leaks, and a window would only cost averages. What came before the
    first, ``lead_in_s`` of silence, belongs to none: counted in, it would cut every burst in two.
    """
    if BLOCKS_NOTE not in campaign.notes:
        return None
    try:
        note = json.loads(campaign.notes[BLOCKS_NOTE])
        block_s, lead_in_s = float(note["block_s"]), float(note.get("lead_in_s", 0.0))
        if not (block_s > 0 and 0 <= lead_in_s < float("inf")):
            raise ValueError("block_s must be positive and lead_in_s not negative")
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"{campaign.name}, note {BLOCKS_NOTE!r}",
            f"cannot be read ({error})",
            'write it like {"block_s": 8.0, "lead_in_s": 1.0}',
        ) from error
    return Averages(block_s, "boxcar", 0.0, lead_in_s)


def overlapping_parts(campaign: Campaign) -> Averages:
    """Parts of an eighth of the shortest record under a window, each half over the next."""
    return Averages(min(record.duration_s for record in campaign.runs) / _PARTS)
