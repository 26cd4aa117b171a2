"""What an object shows of itself at a prompt or in a notebook: a few lines, however much it holds."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

_LONGEST = 240
_ROWS, _ITEMS = 10, 4


def counted(count: int, what: str) -> str:
    """``1 run``, ``2 runs``, ``no runs``."""
    return f"{count or 'no'} {what}{'' if count == 1 else 's'}"


def more(count: int) -> str:
    """What stands for what was cut off."""
    return f"… and {count} more"


def listed(items: Collection[object], most: int = _ITEMS) -> str:
    """The first of some items, and how many more there are; "none" of none."""
    first = ", ".join(str(item) for _, item in zip(range(most), items, strict=False))
    return f"{first} {more(len(items) - most)}" if len(items) > most else first or "none"


def cut(text: str, longest: int = _LONGEST) -> str:
    """A text in one line, its end left out where it is long."""
    line = " ".join(text.split())
    return line if len(line) <= longest else f"{line[: longest - 1]}…"


def brief(thing: object) -> str:
    """The first line of what an object shows: what it is, as part of another one."""
    return repr(thing).partition("\n")[0]


def headed(head: str, lines: Iterable[str] = (), most: int = _ROWS) -> str:
    """``<head>``, and the first of some lines below it, each of them cut."""
    below = [cut(line) for line in lines]
    rest = [more(len(below) - most)] if len(below) > most else []
    return "\n".join((f"<{cut(head)}>", *below[:most], *rest))


def in_columns(
    heads: Sequence[str], rows: Sequence[Sequence[str]], words: Collection[str] = (), most: int = _ROWS
) -> str:
    """A table of the first rows, columns without content left out; numbers end, and ``words`` begin, in one place."""
    first = rows[:most]
    columns = [(heads[k], [row[k] for row in first]) for k in range(len(heads)) if any(row[k] for row in first)]
    aligned = []
    for head, cells in columns:
        width = max(map(len, (head, *cells)))
        aligned.append([cell.ljust(width) if head in words else cell.rjust(width) for cell in (head, *cells)])
    lines = ["  ".join(cells).rstrip() for cells in zip(*aligned, strict=True)]
    return "\n".join((*lines, more(len(rows) - most)) if len(rows) > most else lines)
