"""The stabilisation diagram of a claim, and its modes as a table that is a figure."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING, Any

import numpy as np

from vgvt.data import FrequencyResponseSet, ModalModel, PoleCandidate
from vgvt.data.mode_numbers import claim_numbers
from vgvt.view.decimation import peak_keeping_index
from vgvt.view.theme import MEASURED_COLOUR, Style, style_of, template
from vgvt.view.wording import remark_in_words

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

_FAINT = "rgba(128,136,148,0.75)"
_TABLE_COLUMNS = ("mode", "frequency, Hz", "± Hz", "damping, %", "± %", "remark")
_TABLE_WIDTHS = (0.6, 1.2, 0.9, 1.1, 0.9, 4.0)


def stabilisation_figure(
    claim: ModalModel,
    frf: FrequencyResponseSet | None = None,
    band_hz: tuple[float, float] | None = None,
    style: Style | None = None,
) -> Figure:
    """Every pole that the method considered over frequency and model order, with the sigma plot behind.

    Filled markers are poles of claimed modes, open ones were dropped; unstable
    poles are in the legend and hidden at first. ValueError for a claim without candidates.
    """
    from plotly.graph_objects import Figure

    if not claim.candidates:
        raise ValueError("the claim names no candidates")
    style = style or style_of(0)
    if band_hz is None:
        frequency = [c.frequency_hz for c in claim.candidates]
        band_hz = (min(frequency), max(frequency))
    figure = Figure()
    figure.update_layout(template=template(), height=460, hovermode="closest")
    if frf is not None:
        _sigma(figure, frf.band(*band_hz))
    inside = [c for c in claim.candidates if band_hz[0] <= c.frequency_hz <= band_hz[1]]
    unstable = [c for c in inside if c.damping_ratio <= 0]
    dropped = [c for c in inside if not c.kept and c.damping_ratio > 0]
    _poles(figure, unstable, "unstable", {"symbol": "x-thin-open", "color": _FAINT, "size": 5}, "legendonly")
    _poles(figure, dropped, "dropped", {"symbol": "circle-open", "color": _FAINT, "size": 6}, True)
    kept = {"symbol": style.symbol, "color": style.colour, "size": 7}
    _poles(figure, [c for c in inside if c.kept], "of a claimed mode", kept, True)
    orders = [c.order for c in claim.candidates]
    # The later axis is drawn above the other: poles shall not hide behind the sigma plot.
    figure.update_layout(
        xaxis={"title": {"text": "frequency, Hz"}, "range": list(band_hz)},
        yaxis2={
            "title": {"text": "model order"}, "range": [min(orders) - 1.5, max(orders) + 1.5],
            "side": "left", "overlaying": "y", "tickmode": "auto",
        },
    )  # fmt: skip
    return figure


def _sigma(figure: Figure, frf: FrequencyResponseSet) -> None:
    """The sigma plot on an axis of its own that shows no numbers: it says where, not how much."""
    sigma = np.maximum(frf.sigma(), 1e-300)
    keep = peak_keeping_index(np.log(sigma), 1600)
    figure.add_scatter(
        x=frf.frequency_hz[keep].astype(np.float32), y=sigma[keep].astype(np.float32), mode="lines",
        name="sigma plot", hoverinfo="skip", line={"color": MEASURED_COLOUR, "width": 1.2}, opacity=0.6,
    )  # fmt: skip
    top, low = float(np.log10(sigma.max())), float(np.log10(np.percentile(sigma, 0.5)))
    figure.update_layout(
        yaxis={
            "type": "log", "range": [max(low, top - 5) - 0.1, top + 0.1],
            "showticklabels": False, "ticks": "", "showgrid": False, "showline": False,
        }
    )  # fmt: skip


def _poles(figure: Figure, poles: list[PoleCandidate], name: str, marker: dict[str, Any], visible: bool | str) -> None:
    if not poles:
        return
    figure.add_scatter(
        x=[round(p.frequency_hz, 4) for p in poles], y=[p.order for p in poles], mode="markers", name=name, yaxis="y2",
        marker=marker, visible=visible, hoverinfo="text",
        hovertext=[f"{p.frequency_hz:.3f} Hz, {100 * p.damping_ratio:.2f} %, order {p.order}<br>"
                   f"{html.escape(p.reason, quote=False)}" for p in poles],
    )  # fmt: skip


def mode_table_figure(claim: ModalModel) -> Figure:
    """The claimed modes as a table: frequency and damping with their standard deviations, and the method's remarks."""
    from plotly.graph_objects import Figure, Table

    rows = [
        (*claim_numbers(claim, k), remark_in_words("; ".join(claim.flags[k]) if claim.flags else ""))
        for k in range(len(claim))
    ]
    cells = [[html.escape(text, quote=False) for text in column] for column in zip(*rows, strict=True)]
    align = ["right"] * 5 + ["left"]
    line = "rgba(128,136,148,0.35)"
    figure = Figure(
        Table(
            columnwidth=list(_TABLE_WIDTHS),
            header={"values": [f"<b>{c}</b>" for c in _TABLE_COLUMNS], "align": align, "fill": {"color": "#eef1f5"},
                    "line": {"color": line}, "height": 28},
            cells={"values": cells or [[] for _ in _TABLE_COLUMNS], "align": align, "fill": {"color": "#ffffff"},
                   "line": {"color": line}, "height": 26},
        )
    )  # fmt: skip
    figure.update_layout(template=template(), height=28 + 26 * max(len(claim), 1) + 30)
    return figure
