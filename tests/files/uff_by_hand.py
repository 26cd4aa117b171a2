"""Universal Files written by their public description, record by record, without any library that knows them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

DELIMITER = "    -1\n"


def head(
    count: int,
    *,
    dof: tuple[int, int] = (1, 3),
    code: int = 12,
    unit: str = "m/s2",
    ordinate: int = 4,
    spacing: int = 1,
    increment: float = 0.01,
    minimum: float = 0.0,
    function: int = 1,
    abscissa: int = 17,
    abscissa_unit: str = "s",
) -> str:
    """The eleven header lines of a dataset 58: five of text, then records 6 to 11."""
    axis = "{:10d}{:5d}{:5d}{:5d} {:20s} {:20s}\n"
    return (
        "a test\nNONE\n01-Mar-24 12:00:00\nNONE\nNONE\n"
        + f"{function:5d}{0:10d}{0:5d}{0:10d} {'NONE':10s}{dof[0]:10d}{dof[1]:4d} {'NONE':10s}{0:10d}{0:4d}\n"
        + f"{ordinate:10d}{count:10d}{spacing:10d}{minimum:13.5E}{increment:13.5E}{0.0:13.5E}\n"
        + axis.format(abscissa, 0, 0, 0, "Time", abscissa_unit)
        + axis.format(code, 0, 0, 0, "NONE", unit)
        + axis.format(0, 0, 0, 0, "NONE", "NONE") * 2
    )


def numbers(values: Sequence[float] | np.ndarray, ordinate: int = 4) -> str:
    """Record 12 of evenly spaced real samples: 4E20.12 in double precision, 6E13.5 in single."""
    a_line, form = (4, "{:20.12E}") if ordinate in (4, 6) else (6, "{:13.5E}")
    texts = [form.format(value) for value in values]
    return "".join("".join(texts[k : k + a_line]) + "\n" for k in range(0, len(texts), a_line))


def text_58(values: Sequence[float] | np.ndarray, **fields: object) -> str:
    """A whole dataset 58."""
    ordinate = int(fields.get("ordinate", 4))  # type: ignore[call-overload]
    return DELIMITER + f"{58:6d}\n" + head(len(values), **fields) + numbers(values, ordinate) + DELIMITER


def binary_58(
    values: Sequence[float] | np.ndarray, *, order: str = "<", gap: bytes = b"", floats: int = 2, **fields: object
) -> bytes:
    """A whole dataset 58b; ``gap`` stands between the numbers and the closing line, where some programs break it."""
    double = fields.get("ordinate", 4) in (4, 6)
    raw = np.asarray(values, dtype=f"{order}f{8 if double else 4}").tobytes()
    order_code = 1 if order == "<" else 2
    first = f"{58:6d}b{order_code:6d}{floats:6d}{11:12d}{len(raw):12d}{0:6d}{0:6d}{0:12d}{0:12d}\n"
    begin = DELIMITER + first + head(len(values), **fields)
    return begin.encode() + raw + gap + DELIMITER.encode()


def nodes_2411(places: dict[int, tuple[float, float, float]], *, number: int = 2411, color: int = 11) -> str:
    """Nodes in double precision (2411, and 781, which is older); FORTRAN writes the exponent with a D."""
    rows = [
        f"{node:10d}{1:10d}{1:10d}{color:10d}\n" + "".join(f"{x:25.16E}".replace("E", "D") for x in place) + "\n"
        for node, place in places.items()
    ]
    return DELIMITER + f"{number:6d}\n" + "".join(rows) + DELIMITER


def nodes_15(places: dict[int, tuple[float, float, float]], displacement_system: int = 0) -> str:
    """Nodes in single precision."""
    rows = [
        f"{node:10d}{0:10d}{displacement_system:10d}{1:10d}" + "".join(f"{x:13.5E}" for x in place) + "\n"
        for node, place in places.items()
    ]
    return DELIMITER + f"{15:6d}\n" + "".join(rows) + DELIMITER


def lines_82(nodes: Sequence[int]) -> str:
    """A trace line, its last record filled up with zeros."""
    filled = [*nodes, *[0] * (-len(nodes) % 8)]
    rows = "".join("".join(f"{n:10d}" for n in filled[k : k + 8]) + "\n" for k in range(0, len(filled), 8))
    return DELIMITER + f"{82:6d}\n{1:10d}{len(nodes):10d}{1:10d}\nwing\n" + rows + DELIMITER


def units_164(lengths_a_metre: float, forces_a_newton: float, code: int = 9) -> str:
    """Units; by the description, divide by a factor to come to SI."""
    factors = [f"{x:25.17E}".replace("E", "D") for x in (lengths_a_metre, forces_a_newton, 1.0, 0.0)]
    return DELIMITER + f"{164:6d}\n{code:10d}{'any':20s}{2:10d}\n{''.join(factors[:3])}\n{factors[3]}\n" + DELIMITER
