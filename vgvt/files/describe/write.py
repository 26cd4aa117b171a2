"""A draft becomes a sidecar on disk; one without a gap has been read with all its records before it has its name."""

from __future__ import annotations

from pathlib import Path

from vgvt.data import InputError
from vgvt.files.atomically import replacing
from vgvt.files.describe.draft import Description, Draft
from vgvt.files.describe.sidecar_text import missing, sidecar_text
from vgvt.files.measured_records import read_measured
from vgvt.files.sidecar import Sidecar
from vgvt.files.strict import load_table


def write_sidecar(draft: Draft, sidecar: Path, folder: Path) -> Description:
    """Write a sidecar of records that lie in ``folder``; InputError where it has no gap and does not load."""
    gaps = missing(draft)
    with replacing(sidecar) as temporary:
        temporary.write_text(sidecar_text(draft), encoding="utf-8")
        if not gaps:
            _check_that_it_loads(temporary, sidecar, folder)
    return Description(sidecar, draft.name, draft.band_hz, draft.channels, draft.runs, gaps, draft.remarks)


def _check_that_it_loads(temporary: Path, sidecar: Path, folder: Path) -> None:
    """InputError, in the name that the sidecar will have, unless it can be read with all its records."""
    try:
        read_measured(load_table(temporary, Sidecar), folder)
    except InputError as error:
        raise InputError(error.where.replace(str(temporary), str(sidecar)), error.problem, error.advice) from error
