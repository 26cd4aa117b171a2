"""Which time histories of Universal Files were recorded together: one run behind the other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from vgvt.data import InputError, Quantity
from vgvt.files.uff.read import UniversalFile, require_histories
from vgvt.files.uff.sample_rate import stated_rate_hz
from vgvt.files.uff.time_history import TimeHistory
from vgvt.files.uff.units import NOT_STATED, QUANTITY_OF_CODE
from vgvt.files.unit_labels import unit_of_label


@dataclass(frozen=True, slots=True, eq=False)
class FoundRun:
    """Time histories of one recording, as they stand in a file."""

    file: UniversalFile
    index: int | None
    """Which run of the file, counted from 1; None where it is the only one."""
    first: int
    """The column of its first time history in the file, counted from 1."""
    histories: tuple[TimeHistory, ...]
    sample_rate_hz: float


def quantity_of(history: TimeHistory) -> Quantity | None:
    """What was measured: by the data type, or by the unit where that says nothing; None where neither tells."""
    if history.quantity_code in NOT_STATED:
        labelled = unit_of_label(history.unit)
        return None if labelled is None else labelled[0]
    return QUANTITY_OF_CODE.get(history.quantity_code)


def find_runs(files: Sequence[UniversalFile], columns: int | None = None) -> tuple[FoundRun, ...]:
    """The runs of some files, ``columns`` time histories each; left out, the most in which no DOF comes twice.

    InputError where runs are not to be told, or differ in their number of channels.
    """
    found: list[FoundRun] = []
    before: int | None = None
    for file in files:
        require_histories(file)
        size = columns or _size_of_runs(file)
        blocks = _blocks(file.histories, size)
        if not blocks:
            raise InputError(
                str(file.path),
                f"its {len(file.histories)} time histories do not make runs of {size} each",
                "correct --columns; put runs with other numbers of channels into files of their own",
            )
        if before is not None and size != before:
            raise InputError(
                str(file.path),
                f"its runs have {size} time histories, those of the file before have {before}",
                "describe files with other channels by themselves, or say with --columns how many a run has",
            )
        before = size
        for k, block in enumerate(blocks):
            index = k + 1 if len(blocks) > 1 else None
            found.append(FoundRun(file, index, k * size + 1, block, stated_rate_hz(block[0])))
    return tuple(found)


def _size_of_runs(file: UniversalFile) -> int:
    """The largest number of time histories, next to each other, that can all have been recorded together."""
    count = len(file.histories)
    sizes = [size for size in range(count, 0, -1) if count % size == 0]
    possible = [size for size in sizes if _are_runs(_blocks(file.histories, size))]
    if not possible:
        raise InputError(
            str(file.path),
            f"its {count} time histories do not make runs alike: each with the same quantities, as many samples at "
            "the same rate in every channel, and no DOF twice",
            "put runs with other numbers of channels into files of their own, or say with --columns how many a run has",
        )
    return possible[0]


def _blocks(histories: Sequence[TimeHistory], size: int) -> list[tuple[TimeHistory, ...]]:
    """Time histories cut into as many each; none where that does not come out even."""
    if len(histories) % size:
        return []
    return [tuple(histories[k : k + size]) for k in range(0, len(histories), size)]


def _are_runs(blocks: Sequence[Sequence[TimeHistory]]) -> bool:
    quantities = [Counter(map(_kind, block)) for block in blocks]
    return all(one == quantities[0] for one in quantities) and all(map(_recorded_together, blocks))


def _recorded_together(block: Sequence[TimeHistory]) -> bool:
    shapes = {(h.form.samples, h.form.even, h.form.increment) for h in block}
    places = [(_kind(h), h.response) for h in block if h.response is not None]
    return len(shapes) == 1 and len(set(places)) == len(places)


def _kind(history: TimeHistory) -> tuple[Quantity | None, int]:
    quantity = quantity_of(history)
    return quantity, 0 if quantity is not None else history.quantity_code
