"""Tables of named things for people; those of modes and scores are in vgvt.view."""

from __future__ import annotations

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text


def items_table(items: Sequence[dict[str, object]], columns: Sequence[str]) -> Table:
    """One row an item, one column a key; headings are the keys in words."""
    table = Table(box=SIMPLE_HEAD)
    for column in columns:
        table.add_column(column.replace("_hz", "_Hz").replace("_", " "))
    for item in items:
        table.add_row(*(Text(str(item.get(column, ""))) for column in columns))
    return table
