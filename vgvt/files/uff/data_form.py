"""Data form of a dataset 58: how many numbers of which kind follow, over which abscissa."""

from __future__ import annotations

from dataclasses import dataclass

from vgvt.files.uff.fields import apart, real, whole

_ORDINATES = {2: (False, False), 4: (True, False), 5: (False, True), 6: (True, True)}
_WIDTHS = (10, 10, 10, 13, 13, 13)


@dataclass(frozen=True, slots=True)
class DataForm:
    """Record 7 of a dataset 58; ``minimum`` and ``increment`` count only where the abscissa is even."""

    double: bool
    complex: bool
    samples: int
    even: bool
    minimum: float
    increment: float

    @classmethod
    def from_line(cls, line: str) -> DataForm:
        """Parse record 7; ValueError that says which field is wrong."""
        ordinate, samples, spacing, minimum, increment, _ = apart(line, _WIDTHS)
        try:
            kind, count, even = whole(ordinate), whole(samples), whole(spacing)
            start, step = real(minimum), real(increment)
        except ValueError:
            raise ValueError(f"record 7 is no data form: {line.strip()!r}") from None
        if kind not in _ORDINATES:
            raise ValueError(f"ordinate data type {kind} is none of 2, 4, 5 and 6")
        if count < 0 or even not in (0, 1):
            raise ValueError(f"record 7 is no data form: {line.strip()!r}")
        return cls(*_ORDINATES[kind], samples=count, even=even == 1, minimum=start, increment=step)

    @property
    def numbers_a_sample(self) -> int:
        """Abscissa where it is uneven, then real part, then imaginary part where the ordinate is complex."""
        return 1 + (not self.even) + self.complex

    @property
    def binary_bytes(self) -> int:
        """Size of the numbers in a dataset 58b."""
        return self.samples * self.numbers_a_sample * (8 if self.double else 4)

    @property
    def widths(self) -> tuple[int, ...]:
        """Columns of the numbers in a line of text."""
        if not self.double:
            return (13,) * 6
        if self.even:
            return (20,) * 4
        return (13, 20, 20) if self.complex else (13, 20, 13, 20)
