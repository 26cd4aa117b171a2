"""The law of a thing that has no name, over frequency: real and imaginary part, how well they are known, what it is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vgvt.view.reconcile_account import NamelessRow
from vgvt.view.theme import MEASURED_COLOUR, NEGATIVE_COLOUR, POSITIVE_COLOUR, template

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

_BAND = "rgba(128,136,148,0.28)"
# Of the largest value: a band that is wider, where nothing tells the law, would leave none of it to be seen.
_WIDEST = 3.0


def law_figure(found: NamelessRow) -> Figure:
    """Both parts of a law (L,) over frequency in Hz, each with its band, and what it reads as, where that is simple."""
    from plotly.subplots import make_subplots

    figure = make_subplots(rows=2, cols=1, shared_xaxes=True, vertical_spacing=0.06)
    line = found.frequency_hz.astype(np.float32)
    parts = (("real", found.law.real, found.std.real), ("imaginary", found.law.imag, found.std.imag))
    widest = _WIDEST * float(np.abs(found.law).max())
    for row, (name, value, told) in enumerate(parts, start=1):
        std = np.minimum(told, widest)
        figure.add_scatter(
            x=np.concatenate([line, line[::-1]]),
            y=np.concatenate([value + std, (value - std)[::-1]]).astype(np.float32),
            fill="toself", fillcolor=_BAND, line={"width": 0}, mode="lines", hoverinfo="skip",
            name="one standard deviation", showlegend=row == 1, row=row, col=1,
        )  # fmt: skip
        figure.add_scatter(
            x=line, y=value.astype(np.float32), mode="lines", line={"color": NEGATIVE_COLOUR, "width": 2},
            name="fitted", showlegend=row == 1, hovertemplate="%{x:.2f} Hz: %{y:.4g}<extra>" + name + "</extra>",
            row=row, col=1,
        )  # fmt: skip
        if found.read is not None:
            read = found.read.real if row == 1 else found.read.imag
            figure.add_scatter(
                x=line, y=read.astype(np.float32), mode="lines", showlegend=row == 1, hoverinfo="skip",
                name="as it reads", line={"color": POSITIVE_COLOUR, "width": 1.8, "dash": "dash"}, row=row, col=1,
            )  # fmt: skip
        figure.add_hline(y=0.0, line={"color": MEASURED_COLOUR, "width": 1, "dash": "dot"}, row=row, col=1)
        figure.update_yaxes(title_text=f"{name}{f', {found.unit}' if found.unit else ''}", row=row, col=1)
    figure.update_xaxes(title_text="frequency, Hz", row=2, col=1)
    figure.update_layout(template=template(), height=420)
    return figure
