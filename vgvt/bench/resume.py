"""What of a bench is left to do: what is not kept, and what ran out of time when it was done."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from vgvt.bench.cell import Cell, Row
from vgvt.bench.rows import ran_out_of_time
from vgvt.bench.store import Store


@dataclass(frozen=True, slots=True)
class Left:
    """A cell to work off, the ``whole`` one that it is part of, and the rows that are there of the other entries."""

    cell: Cell
    whole: Cell
    kept: tuple[Row, ...] = ()


def left_to_do(cells: Sequence[Cell], store: Store) -> tuple[list[Row], list[Left]]:
    """The rows of what is done, and what is not: first what was never done, then what ran out of time.

    A method that took too long on a busy machine may be in time on an idle one. Such entries, and they alone, are
    tried again, after the rest because they may well take their whole time once more.
    """
    rows: list[Row] = []
    new: list[Left] = []
    again: list[Left] = []
    for cell in cells:
        known = store.rows(cell)
        if known is None:
            new.append(Left(cell, cell))
            continue
        late = {row["entry"] for row in known if ran_out_of_time(row)}
        if not late:
            rows += known
            continue
        part = replace(cell, entries=tuple(entry for entry in cell.entries if entry.label in late))
        again.append(Left(part, cell, tuple(row for row in known if row["entry"] not in late)))
    return rows, new + again
