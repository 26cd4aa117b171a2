"""The formats that are written, by the ending of a file's name."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path

from vgvt.data import Geometry, InputError
from vgvt.files.storable import check_nodes


class Form(StrEnum):
    """A format; the value is that of ``format`` in a sidecar, where it has one."""

    CAMPAIGN = "nc"
    UNIVERSAL = "uff"
    MATLAB = "mat"
    TEXT = "csv"

    @property
    def in_words(self) -> str:
        """What people call it."""
        return {"nc": "campaign.nc", "uff": "Universal File", "mat": "MAT file", "csv": "CSV"}[self.value]


LARGEST_NODE = {Form.CAMPAIGN: 2**63 - 1, Form.UNIVERSAL: 10**10 - 1, Form.MATLAB: 2**53}
"""What formats have room for: 64 bits, ten columns, whole numbers in doubles. Text has room for all."""
UNIVERSAL_ENDINGS = (".uff", ".unv", ".ufb", ".bunv")
ENDINGS = {
    ".nc": Form.CAMPAIGN,
    **dict.fromkeys(UNIVERSAL_ENDINGS, Form.UNIVERSAL),
    ".mat": Form.MATLAB,
    ".csv": Form.TEXT,
}


def form_of(path: Path) -> Form:
    """The format that a name ends in; InputError with the endings there are."""
    form = ENDINGS.get(path.suffix.lower())
    if form is not None:
        return form
    listed = ", ".join(list(ENDINGS)[:-1]) + f" or {list(ENDINGS)[-1]}"
    what = f"no format ends in {path.suffix!r}" if path.suffix else "its name has no ending, which says the format"
    raise InputError(str(path), what, f"give a name that ends in {listed}")


def check_room(geometry: Geometry, form: Form, path: Path) -> None:
    """InputError where a format has no room for a node's number."""
    if form in LARGEST_NODE:
        check_nodes(geometry, path, LARGEST_NODE[form], f"a {form.in_words}")
