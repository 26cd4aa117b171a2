"""A terminal table that gives up its least important columns before it cuts anything."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rich.box import SIMPLE_HEAD
from rich.cells import cell_len
from rich.table import Table
from rich.text import Text

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions

_WORDS_MIN_WIDTH = 16  # prose may fold, but not into a ribbon of single words


@dataclass(frozen=True, slots=True)
class FittedTable:
    """A rich renderable: one row a tuple of texts, columns without content left out.

    ``whole`` columns never fold; ``words`` columns fold between words; ``expendable``
    names the columns that go, first to last, while the rest does not fit the width.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[str | Text, ...], ...]
    whole: frozenset[str]
    expendable: tuple[str, ...] = ()
    right: frozenset[str] = frozenset()
    title: str = ""
    caption: str = ""

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Table | Text]:
        """The table for the width at hand."""
        shown = [k for k in range(len(self.columns)) if any(str(row[k]) for row in self.rows)]
        narrow = False
        for name in self.expendable:
            if self._least_width(shown, narrow) <= options.max_width:
                break
            narrow = True
            shown = [k for k in shown if self.columns[k] != name]
        # Title and caption apart: in the table rich would fold them to its width.
        if self.title:
            yield Text(self.title, style="italic", overflow="fold")
        if self.rows:
            yield self._table(shown, narrow)
        if self.caption:
            yield Text(self.caption, style="dim", overflow="fold")

    def _table(self, shown: Sequence[int], narrow: bool) -> Table:
        table = Table(box=SIMPLE_HEAD, collapse_padding=narrow, pad_edge=not narrow)
        for k in shown:
            name = self.columns[k]
            table.add_column(
                Text(_heading(name, narrow and name in self.right)),
                justify="right" if name in self.right else "left",
                no_wrap=name in self.whole,
                min_width=self._least_column(k, narrow) if name in self.whole else None,
                overflow="fold",
            )
        for row in self.rows:
            table.add_row(*(_as_text(row[k]) for k in shown))
        return table

    def _least_width(self, shown: Sequence[int], narrow: bool) -> int:
        between = 2 if narrow else 3
        return 1 + sum(self._least_column(k, narrow) + between for k in shown)

    def _least_column(self, k: int, narrow: bool) -> int:
        name = self.columns[k]
        texts = [str(row[k]) for row in self.rows]
        heading = _heading(name, narrow and name in self.right).splitlines()
        if name not in self.whole:
            return min(_WORDS_MIN_WIDTH, max(cell_len(text) for text in (*texts, *heading)))
        return max(cell_len(text) for text in (*texts, *heading))


def _heading(name: str, stacked: bool) -> str:
    return name.replace(" ", "\n") if stacked else name


def _as_text(cell: str | Text) -> Text:
    return Text(cell) if isinstance(cell, str) else cell
