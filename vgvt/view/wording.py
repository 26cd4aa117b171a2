"""Remarks as people read them, the same in the terminal and on the page."""

from __future__ import annotations

import re

_UNITS = {"hz": "Hz", "db": "dB", "percent": "%", "s": "s", "n": "N", "kg": "kg"}
_FLAG = re.compile(r"[a-z][a-z0-9_]*(=\S+)?")


def remark_in_words(remark: str) -> str:
    """Machine flags like ``prominence_db=28.4; runs_disagree`` as words with units; other text stays."""
    return "; ".join(_flag_in_words(part) for part in remark.split("; "))


def _flag_in_words(flag: str) -> str:
    if not _FLAG.fullmatch(flag):
        return flag
    key, _, value = flag.partition("=")
    words = key.split("_")
    unit = _UNITS.get(words[-1], "") if value and len(words) > 1 else ""
    return " ".join(filter(None, (*(words[:-1] if unit else words), value, unit)))
