"""What the first paper's tables 2 and 3 claim, mode by mode, and which true mode of the virtual aircraft is like it.

A. Gupta, P. J. Seiler, B. P. Danowsky, Ground Vibration Tests on a Flexible Flying Wing Aircraft, AIAA 2016-1753.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Claimed:
    """A mode of the paper: its number, the kind that the text gives it, and by either method its Hz and its test.

    Hz are as printed, tests are named as the bundled scenarios are; a method that did not find the mode has none.
    ``counterpart`` is the label of the true mode of that kind, '' where the virtual aircraft has none near.
    """

    aircraft: str
    number: int
    kind: str
    quadrature: tuple[str, str] | None
    cfdd: tuple[str, str] | None
    counterpart: str


_LIKE_THE_FIRST = "bending, like the first symmetric"
CLAIMED = (
    Claimed("Sköll", 1, _LIKE_THE_FIRST, ("7.23", "skoll-gvt1"), ("7.23", "skoll-gvt1"), "1st symmetric bending"),
    Claimed("Sköll", 2, _LIKE_THE_FIRST, ("8.17", "skoll-gvt1"), ("8.14", "skoll-gvt1"), ""),
    Claimed("Sköll", 3, "bending", ("15.58", "skoll-gvt1"), ("15.58", "skoll-gvt1"), "1st antisymmetric bending"),
    Claimed("Sköll", 4, "bending", ("26.10", "skoll-gvt1"), ("26.02", "skoll-gvt1"), "2nd symmetric bending"),
    Claimed("Sköll", 1, _LIKE_THE_FIRST, ("7.24", "skoll-gvt2"), ("7.28", "skoll-gvt2"), "1st symmetric bending"),
    Claimed("Sköll", 2, _LIKE_THE_FIRST, ("8.18", "skoll-gvt2"), ("8.19", "skoll-gvt2"), ""),
    Claimed("Hati", 1, "bending", ("7.95", "hati-symmetric"), ("7.96", "hati-symmetric"), "1st symmetric bending"),
    Claimed("Hati", 2, "bending", None, ("13.83", "hati-symmetric"), ""),
    Claimed("Hati", 3, "torsion", ("15.96", "hati-symmetric"), ("15.97", "hati-symmetric"), ""),
    Claimed("Hati", 4, "bending", ("19.22", "hati-symmetric"), ("19.07", "hati-unsymmetric"), ""),
    Claimed("Hati", 5, "bending", ("32.0", "hati-symmetric"), ("31.9", "hati-symmetric"), "2nd symmetric bending"),
)
SPLIT_HZ = (7.23, 8.17)
"""The two modes of Sköll that, the paper believes, unequal wings have split from one."""
