"""Tables, lists and numbers of a reconciliation's page as HTML."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from vgvt.view.html_page import escaped


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], words: Sequence[int] = ()) -> str:
    """Cells are HTML already; columns in ``words`` are text, and fold."""
    kinds = ["remark ink" if k in words else "" for k in range(len(heads))]
    head = "".join(f'<th class="{kind}">{escaped(text)}</th>' for kind, text in zip(kinds, heads, strict=True))
    body = "".join(
        "<tr>" + "".join(f'<td class="{kind}">{cell}</td>' for kind, cell in zip(kinds, row, strict=True)) + "</tr>"
        for row in rows
    )
    return f'<div class="scroll"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def listed(lines: Iterable[str]) -> str:
    """A list of lines of text."""
    return '<ul class="plain">' + "".join(f"<li>{escaped(line)}</li>" for line in lines) + "</ul>"


def number(value: float | None, form: str) -> str:
    """A number in a form; empty where there is none."""
    return "" if value is None or not np.isfinite(value) else format(value, form)


def percent(value: float | None) -> str:
    """A share in per cent; empty where there is none."""
    return "" if value is None else f"{100 * value:.2f}"


def improvement(pair: tuple[float, float]) -> str:
    """A value before and after, coloured where it has changed for the better or the worse."""
    kind = "found" if pair[1] < pair[0] - 0.05 else "missed" if pair[1] > pair[0] + 0.05 else ""
    return f'<span class="{kind}">{pair[0]:.1f} → {pair[1]:.1f}</span>'
