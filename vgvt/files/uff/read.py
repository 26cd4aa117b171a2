"""A Universal File as a whole: its time histories, and what it states about places and units."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from vgvt.data import InputError
from vgvt.files.uff.cut import Dataset, cut_file
from vgvt.files.uff.geometry import UffGeometry, read_geometry
from vgvt.files.uff.time_history import FUNCTIONS, TIME_RESPONSE, TimeHistory, function_type, time_history
from vgvt.files.uff.units import UnitSystem

_FUNCTION, _UNITS = 58, 164


@dataclass(frozen=True, slots=True, eq=False)
class UniversalFile:
    """What a Universal File states; samples and places are decoded when they are asked for."""

    path: Path
    histories: tuple[TimeHistory, ...]
    """The time histories, in order of appearance: column 1 is the first."""
    others: dict[str, int]
    """How many functions of other kinds there are, by their names."""
    units: UnitSystem | None
    """None where the file has no dataset 164."""
    datasets: tuple[Dataset, ...]

    def geometry(self) -> UffGeometry:
        """Nodes, trace lines and coordinate systems, which records do not need; InputError when they are damaged."""
        return read_geometry(self.datasets, self.path)

    @property
    def other_functions(self) -> str:
        """``12 of frequency response function``, or an empty text."""
        return ", ".join(f"{count} of {kind}" for kind, count in self.others.items())


def read_uff(path: Path) -> UniversalFile:
    """Read the headers of a Universal File.

    InputError when the file is missing, empty, truncated, damaged or of another kind.
    """
    datasets = cut_file(path)
    histories: list[TimeHistory] = []
    others: Counter[str] = Counter()
    units = None
    for dataset in datasets:
        if dataset.number == _FUNCTION:
            kind = function_type(dataset, path)
            if kind == TIME_RESPONSE:
                histories.append(time_history(dataset, path, len(histories) + 1))
            else:
                others[FUNCTIONS.get(kind, f"function type {kind}")] += 1
        elif dataset.number == _UNITS:
            try:
                units = UnitSystem.from_lines(dataset.lines)
            except ValueError as error:
                where = f"{path}, dataset {dataset.place} of the file (164)"
                raise InputError(where, f"damaged: {error}", "export or copy the file again") from error
    return UniversalFile(path, tuple(histories), dict(others), units, datasets)


def require_histories(file: UniversalFile) -> None:
    """InputError, which says what the file holds instead, unless it holds time histories."""
    if file.histories:
        return
    if file.others:
        raise InputError(
            str(file.path),
            f"no time histories (function type 1), but functions of other kinds: {file.other_functions}",
            "export the time histories that they were made from; where they are over time after all, "
            "their function type (record 6) is to be 1",
        )
    raise InputError(str(file.path), "no functions (datasets 58)", "export the time histories along with the geometry")
