"""Datasets 58 and 58b, functions at nodal degrees of freedom; those over time are read, the others named."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Direction, Dof, InputError
from vgvt.files.uff.cut import Dataset
from vgvt.files.uff.data_form import DataForm
from vgvt.files.uff.fields import among_names, in_columns, whole

TIME_RESPONSE = 1
FUNCTIONS = {
    0: "general or unknown function",
    1: "time response",
    2: "auto spectrum",
    3: "cross spectrum",
    4: "frequency response function",
    5: "transmissibility",
    6: "coherence",
    7: "auto correlation",
    8: "cross correlation",
    9: "power spectral density",
    10: "energy spectral density",
    12: "spectrum",
    18: "mode indicator function",
    24: "shock response spectrum",
    25: "finite impulse response filter",
    26: "multiple coherence",
    27: "order function",
}
_DOF_WIDTHS = (5, 10, 5, 10, 11, 10, 4, 11, 10, 4)
_DOF_NAMES = (4, 7)  # which of them are names
_AXIS_WIDTHS = (10, 5, 5, 5, 21, 21)
_AGAIN = "export or copy the file again"
_IEEE = 2
_BYTE_ORDERS = {1: "<", 2: ">"}


@dataclass(frozen=True, slots=True, eq=False)
class TimeHistory:
    """One time history as its dataset states it; the numbers are decoded when they are asked for."""

    where: str
    """The file and which of its time histories, for messages."""
    identification: tuple[str, ...]
    """The five lines of free text, empty where they say NONE."""
    response: Dof | None
    """In the axes of the file; None where it states no node."""
    quantity_code: int
    """Specific data type of the ordinate."""
    unit: str
    """Label of the ordinate's unit; empty where there is none."""
    abscissa_code: int
    abscissa_unit: str
    form: DataForm
    dataset: Dataset

    def samples(self) -> NDArray[np.floating]:
        """The ordinate (N,) in the precision of the file; InputError when it is complex, damaged or not as long."""
        if self.form.complex:
            raise InputError(
                self.where,
                "its samples are complex numbers, and a time history has real ones",
                "export the time history itself (function type 1, ordinate data type 2 or 4)",
            )
        with np.errstate(over="ignore"):  # what is beyond the precision is infinite, and is told as not finite
            return self._numbers()[:, -1].astype(np.float64 if self.form.double else np.float32, copy=False)

    def abscissa_s(self) -> NDArray[np.float64]:
        """The time axis (N,) where the file writes it out; InputError when it is damaged."""
        return self._numbers()[:, 0].astype(np.float64)

    def _numbers(self) -> NDArray[np.floating]:
        """Everything (N, numbers a sample) that the dataset holds."""
        form, count = self.form, self.form.samples * self.form.numbers_a_sample
        if self.dataset.binary:
            order = _byte_order(self.dataset.identifier, self.where)
            numbers = np.frombuffer(self.dataset.body, dtype=f"{order}f{8 if form.double else 4}", count=count)
        else:
            numbers = _of_text(bytes(self.dataset.body), form.widths, count, self.where)
        return numbers.reshape(form.samples, form.numbers_a_sample)


def function_type(dataset: Dataset, path: Path) -> int:
    """What kind of function a dataset 58 holds; InputError when the header is damaged."""
    field = among_names(dataset.lines[5], _DOF_WIDTHS, _DOF_NAMES)[0]
    try:
        return whole(field)
    except ValueError:
        raise _damaged(f"{path}, dataset {dataset.place} of the file (58)", "function type", field) from None


def time_history(dataset: Dataset, path: Path, column: int) -> TimeHistory:
    """A dataset 58 of function type 1 as the ``column``-th of its file; InputError when its header is damaged."""
    where = f"{path}, time history {column}"
    dof = among_names(dataset.lines[5], _DOF_WIDTHS, _DOF_NAMES)
    abscissa, ordinate = (in_columns(line, _AXIS_WIDTHS) for line in dataset.lines[7:9])
    try:
        form = DataForm.from_line(dataset.lines[6])
    except ValueError as error:
        raise InputError(where, f"damaged: {error}", _AGAIN) from error
    return TimeHistory(
        where=where,
        identification=tuple(_said(line) for line in dataset.lines[:5]),
        response=_dof(dof[5], dof[6], where),
        quantity_code=_code(ordinate[0], "ordinate's data type", where),
        unit=_said(ordinate[5]),
        abscissa_code=_code(abscissa[0], "abscissa's data type", where),
        abscissa_unit=_said(abscissa[5]),
        form=form,
        dataset=dataset,
    )


def _of_text(text: bytes, widths: tuple[int, ...], count: int, where: str) -> NDArray[np.float64]:
    """Numbers (N,) of a dataset that is text: between blanks, or in columns where they touch."""
    text = text.replace(b"D", b"E").replace(b"d", b"e")
    numbers = _parsed(text.split())
    if numbers is None or numbers.size < count:
        lines = text.decode("latin-1").splitlines()
        numbers = _parsed([field.encode("latin-1") for line in lines for field in in_columns(line, widths) if field])
    if numbers is None:
        raise InputError(where, "damaged: something that is no number stands among its samples", _AGAIN)
    # A last line is filled up with zeros by some programs.
    filled = numbers[count:]
    if numbers.size < count or filled.size >= len(widths) or filled.any():
        raise InputError(where, f"truncated or damaged: {numbers.size} numbers where its header says {count}", _AGAIN)
    return numbers[:count]


def _parsed(words: list[bytes]) -> NDArray[np.float64] | None:
    """The numbers (N,) that words stand for, None where one of them is no number."""
    if not words:
        return np.empty(0)
    try:
        return np.array(words, dtype=np.bytes_).astype(np.float64)
    except ValueError:
        return None


def _byte_order(identifier: str, where: str) -> str:
    """How the bytes of a dataset 58b are ordered; InputError for numbers of machines that are no longer built."""
    try:
        order, floats = (whole(field) for field in in_columns(identifier[7:], (6, 6)))
    except ValueError:
        raise _damaged(where, "line of a dataset 58b", identifier.strip()) from None
    if order not in _BYTE_ORDERS or floats != _IEEE:
        raise InputError(
            where,
            f"byte order {order} and floating-point format {floats} are not those of IEEE numbers (1 or 2, and 2)",
            "export it as text (58), or in IEEE format",
        )
    return _BYTE_ORDERS[order]


def _dof(node: str, direction: str, where: str) -> Dof | None:
    """The degree of freedom of two fields, None for node 0; InputError for a direction that there is not."""
    try:
        number, code = whole(node), whole(direction)
        return Dof(number, Direction(code)) if number > 0 else None
    except ValueError:
        raise _damaged(where, "response node and direction", f"{node} {direction}") from None


def _code(field: str, what: str, where: str) -> int:
    try:
        return whole(field)
    except ValueError:
        raise _damaged(where, what, field) from None


def _said(text: str) -> str:
    """Free text, empty where the format's word for nothing stands."""
    said = text.strip()
    return "" if said.upper() == "NONE" else said


def _damaged(where: str, what: str, found: str) -> InputError:
    return InputError(where, f"damaged: {found!r} is no {what}", _AGAIN)
