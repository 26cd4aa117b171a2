"""BibTeX of what an identification rests on."""

from __future__ import annotations

import re
from collections.abc import Iterable

from vgvt.identification.protocol import Identifier

_ENTRY_START = re.compile(r"^@\w+\s*\{\s*([^,\s]+)\s*,", re.MULTILINE)


def bibtex_entries(text: str) -> dict[str, str]:
    """The entries of a BibTeX text by key; ValueError when there is none."""
    starts = list(_ENTRY_START.finditer(text))
    if not starts:
        raise ValueError("no BibTeX entry: a citation starts with @article{key, or similar at the start of a line")
    ends = [m.start() for m in starts[1:]] + [len(text)]
    return {m.group(1): text[m.start() : end].strip() for m, end in zip(starts, ends, strict=True)}


def bibliography(identifiers: Iterable[Identifier | type[Identifier]]) -> str:
    """BibTeX of everything the identifiers cite, each key once, in order of key."""
    entries: dict[str, str] = {}
    for identifier in identifiers:
        entries.update(bibtex_entries(identifier.citation))
    return "\n\n".join(entries[key] for key in sorted(entries)) + ("\n" if entries else "")
