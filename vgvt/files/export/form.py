"""The formats that are written, by the ending of a file's name."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path

from vgvt.data import InputError


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
