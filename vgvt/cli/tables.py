"""Tables of named things for people; those of modes and scores are in vgvt.view."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vgvt.view.fitted_table import FittedTable


def items_table(
    items: Sequence[dict[str, object]], columns: Sequence[str], expendable: Sequence[str] = ()
) -> FittedTable:
    """One row an item, one column a key; headings are the keys in words.

    The first column is never folded; the ``expendable`` ones go where the terminal is narrow.
    """
    from vgvt.view.fitted_table import FittedTable

    return FittedTable(
        columns=tuple(_heading(column) for column in columns),
        rows=tuple(tuple(str(item.get(column, "")) for column in columns) for item in items),
        whole=frozenset((_heading(columns[0]), *map(_heading, expendable))),
        expendable=tuple(_heading(column) for column in expendable),
    )


def _heading(key: str) -> str:
    return key.replace("_hz", "_Hz").replace("_", " ")
