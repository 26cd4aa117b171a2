"""Frequency responses in another format, whole or not at all."""

from __future__ import annotations

from pathlib import Path

from vgvt.data import FrequencyResponseSet, Geometry, InputError
from vgvt.files.atomically import check_space, replacing
from vgvt.files.export import matlab, table, universal
from vgvt.files.export.form import Form, check_room, form_of
from vgvt.files.storable import check_numbers, check_text

_BYTES = 60  # of a complex number as text, with what stands beside it


def export_responses(
    frf: FrequencyResponseSet, path: Path, name: str, geometry: Geometry, *, text: bool = False
) -> Form:
    """Write frequency responses and their coherence, named after a campaign, as the path's ending says.

    Datasets 58 of function types 4 and 6 (26 with several references) as ``text`` or binary; in MAT ``frf`` (lines,
    responses, references), as MATLAB's modalfrf gives it; in CSV real and imaginary parts. InputError for an ending
    that is unknown or holds no frequency responses, and for what the format cannot hold: a name, the number of a node,
    numbers that 64 bits would change; OSError (ENOSPC) beforehand where the disk has no room.
    """
    form = form_of(path)
    if form is Form.CAMPAIGN:
        raise InputError(str(path), "a campaign file holds time histories alone", "give a .uff, .unv, .mat or .csv")
    check_room(geometry, form, path)
    check_text(name, f"{path}: name")
    for what, array in (("frequency", frf.frequency_hz), ("coherence", frf.coherence), ("variance", frf.variance)):
        if array is not None:
            check_numbers(array, str(path), f"values of {what}")
    for part in (frf.values.real, frf.values.imag):
        check_numbers(part, str(path), "frequency responses")
    check_space(path.parent, frf.values.size * _BYTES)
    with replacing(path) as temporary:
        if form is Form.UNIVERSAL:
            with temporary.open("wb") as stream:
                stream.writelines(universal.response_datasets(frf, name, geometry, text))
        elif form is Form.MATLAB:
            matlab.write_mat(temporary, matlab.response_variables(frf, name, geometry), path)
        else:
            table.write_responses(temporary, frf)
    return form
