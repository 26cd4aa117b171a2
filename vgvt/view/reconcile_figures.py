"""The figures of a reconciliation's page: residual maps, evidence, z(ω), calibrated parameters, response overlays."""

from __future__ import annotations

import html
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vgvt.view.decimation import break_wraps
from vgvt.view.reconcile_account import Account, CandidateRow, PlaceRow
from vgvt.view.theme import MEASURED_COLOUR, NEGATIVE_COLOUR, POSITIVE_COLOUR, TRUTH_COLOUR, template

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

_CELLS = 60
_LABEL_WIDTH = 22
"""Characters of a line of a candidate's name: on a telephone its bar needs the room."""
_OVER_BARS = "#1b1f24"
_ROW_PX = 15
_NAMED_ROW_PX = 32
"""A row with its name above it."""
_SCALE = [[0.0, "#f4f7fb"], [0.25, "#fbe3c8"], [0.5, "#f2a766"], [0.75, "#c9511f"], [1.0, "#5c1a0b"]]
_STANDING = {
    "named": (TRUTH_COLOUR, "named"),
    "lead": (TRUTH_COLOUR, "comes nearest: a lead and no name"),
    "equivalent": ("#56B4E9", "equivalent: explains the data as well"),
    "refused by held-out data": ("#D55E00", "refused: held-out data, or the place<br>that is left, speak against it"),
    "no plausible thing": (
        "#D55E00",
        "no plausible thing: off the aircraft, or<br>of a frequency that it does not have",
    ),
    "beaten": (MEASURED_COLOUR, "beaten"),
    "too little evidence": ("#c3c8cf", "too little evidence"),
    "its fit had not ended": ("#e4e7eb", "its fit had not ended"),
}
_DECADES: dict[str, Any] = {"dtick": 1, "tickformat": "~g", "minor": {"showgrid": False, "ticks": "outside"}}


def residual_map_figure(account: Account) -> Figure:
    """χ² per degree of freedom over frequency and channels: before and after, or calibrated alone."""
    from plotly.subplots import make_subplots

    # Words that fit over a map of a hundred pixels, as beside each other on a telephone.
    states = account.states
    figure = make_subplots(
        rows=1,
        cols=len(states),
        shared_yaxes=True,
        horizontal_spacing=0.02,
        subplot_titles=[name for name, _ in states],
    )
    edges = np.linspace(account.frequency_hz[0], account.frequency_hz[-1], _CELLS + 1)
    names = [_channel_name(c.label, c.held) for c in account.channels]
    shown = [
        binned(np.abs(state.predicted - account.measured) ** 2 / account.sigma**2, account.frequency_hz, edges)
        for _, state in states
    ]
    # Whole decades, the same for both: a few wild cells must not make the rest pale.
    most = max(1.0, *(float(np.nanquantile(cells, 0.99)) for cells in shown))
    top = max(1, int(np.ceil(np.log10(most))))
    for k, cells in enumerate(shown):
        figure.add_heatmap(
            z=np.log10(np.maximum(cells, 0.1)), x=(edges[1:] + edges[:-1]) / 2, y=names, zmin=0, zmax=top,
            colorscale=_SCALE, showscale=k == 0, customdata=cells,
            hovertemplate="%{y}, %{x:.2f} Hz: %{customdata:.2f}<extra></extra>",
            colorbar={
                "title": {"text": "χ² per dof<br>&nbsp;", "side": "top"}, "tickvals": list(range(top + 1)),
                "ticktext": ["≤ 1", *(f"{10**d:g}" for d in range(1, top)), f"≥ {10**top:g}"],
                "thickness": 12, "outlinewidth": 0,
            },
            row=1, col=k + 1,
        )  # fmt: skip
    figure.update_xaxes(showgrid=False, showline=False)
    figure.add_annotation(
        text="frequency, Hz", x=0.5, y=0, xref="paper", yref="paper", yshift=-24, yanchor="top", showarrow=False,
        font={"size": 13},
    )  # fmt: skip
    figure.update_yaxes(autorange="reversed", showgrid=False, showline=False, ticks="", dtick=1)
    figure.update_layout(template=template(), height=max(_ROW_PX * len(names), 150) + 110, margin={"t": 34, "b": 54})
    return figure


def binned(values: NDArray[np.float64], frequency_hz: NDArray[np.float64], edges: NDArray[np.float64]) -> NDArray[Any]:
    """Means of values (C, L) over cells of frequency, (C, cells); NaN where no line falls."""
    index = np.clip(np.searchsorted(edges, frequency_hz, side="right") - 1, 0, len(edges) - 2)
    count = np.bincount(index, minlength=len(edges) - 1).astype(float)
    sums = np.array([np.bincount(index, weights=row, minlength=len(edges) - 1) for row in values])
    return np.asarray(np.divide(sums, count, out=np.full(sums.shape, np.nan), where=count > 0))


def evidence_figure(rows: tuple[CandidateRow, ...], needed_nats: float, most: int = 12) -> Figure | None:
    """Evidence of the candidates of one round, best first, against what a name needs; None without any."""
    from plotly import graph_objects as go

    if not rows:
        return None
    shown = sorted(rows, key=lambda r: -r.gain_nats)[:most]
    # A bar of a thousand nats must not hide one of ten: the axis is linear up to one, logarithmic beyond.
    length = [np.sign(r.gain_nats) * np.log10(1 + abs(r.gain_nats)) for r in shown]
    labels = _distinct([r.label for r in shown])
    names, wrapped = [_plain(n) for n in labels], [wrap(n, _LABEL_WIDTH, break_on_hyphens=False) for n in labels]
    figure = go.Figure()
    for standing, (colour, words) in _STANDING.items():
        mine = [k for k, r in enumerate(shown) if r.standing == standing]
        if mine:
            figure.add_bar(
                y=[names[k] for k in mine], x=[length[k] for k in mine], orientation="h", name=words,
                marker={"color": colour}, text=[f"{shown[k].gain_nats:.1f}" for k in mine], textposition="none",
                hovertemplate="%{y}: %{text} nats<extra></extra>",
            )  # fmt: skip
    marks = [np.sign(r.lasting_nats) * np.log10(1 + abs(r.lasting_nats)) if r.converged else 0.0 for r in shown]
    # What a fit that was broken off comes to by this measure is a bound, and none that it could have reached.
    ended = [k for k, r in enumerate(shown) if r.converged]
    figure.add_scatter(
        y=[names[k] for k in ended], x=[marks[k] for k in ended], mode="markers", name="where errors of the model last",
        marker={"symbol": "diamond", "size": 10, "color": "#ffffff", "line": {"color": _OVER_BARS, "width": 1.6}},
        text=[f"{shown[k].lasting_nats:.1f}" for k in ended], hovertemplate="%{y}: %{text} nats<extra></extra>",
    )  # fmt: skip
    needed = float(np.log10(1 + needed_nats))
    for name, row, end in zip(names, shown, np.maximum(length, marks), strict=True):
        # Beyond the mark and the dashed line too, which would cover it.
        figure.add_annotation(
            text=f"{row.gain_nats:.{0 if row.gain_nats >= 1000 else 1}f}", x=max(float(end), needed), y=name,
            xanchor="left", xshift=8, showarrow=False,
        )  # fmt: skip
    # Dark on white, so that it is seen on paper and bars of any colour.
    for line in ({"color": "#ffffff", "width": 3.5}, {"color": _OVER_BARS, "width": 1.8, "dash": "dash"}):
        figure.add_vline(x=needed, line=line)
    longest = max(1.0, needed, *length, *marks)
    powers = [t for t in (1, 10, 100, 1000, 10000, 100000) if np.log10(1 + t) <= longest]
    # As many as a telephone has room for.
    powers = powers[1::2] if len(powers) > 4 else powers[1:] if len(powers) > 2 else powers
    ticks = [*(-t for t in powers), 0, *powers]
    figure.update_xaxes(
        title_text="gain of evidence, nats",
        tickvals=[np.sign(t) * np.log10(1 + abs(t)) for t in ticks],
        ticktext=[f"{t:g}" if abs(t) < 1000 else f"{t // 1000:g}k" for t in ticks], tickangle=0,
        range=[1.25 * min(0.0, *length, *marks), 1.4 * longest],
    )  # fmt: skip
    figure.update_yaxes(
        categoryorder="array", categoryarray=names, autorange="reversed", showgrid=False, ticks="", tickvals=names,
        ticktext=["<br>".join(_plain(line) for line in lines) for lines in wrapped],
    )  # fmt: skip
    row_px = 10 + 16 * max(len(lines) for lines in wrapped)
    figure.update_layout(template=template(), height=row_px * len(shown) + 150, bargap=0.25, showlegend=True)
    return figure


def stiffness_figure(place: PlaceRow, frequency_hz: NDArray[np.float64]) -> Figure | None:
    """Magnitude and phase of z(ω), force over motion at a place, (L,) Hz, and the law it resembles; None without z."""
    from plotly.subplots import make_subplots

    if place.stiffness is None:
        return None
    figure = make_subplots(rows=2, cols=1, shared_xaxes=True, vertical_spacing=0.04, row_heights=[0.62, 0.38])
    z = place.stiffness
    _curves(figure, frequency_hz, z, "free force over motion", MEASURED_COLOUR, "solid", points=True)
    law = _law(place, 2 * np.pi * frequency_hz)
    if law is not None:
        _curves(figure, frequency_hz, law, f"{place.type} of {place.size:.3g} {place.unit}", POSITIVE_COLOUR, "dash")
    elif place.type == "resonant":
        figure.add_vline(x=place.size, line={"color": POSITIVE_COLOUR, "dash": "dash", "width": 1.5})
    unit = "N m/rad" if place.turns else "N/m"
    figure.update_yaxes(
        row=1,
        col=1,
        type="log",
        title_text=f"|z|, {unit}",
        **(_DECADES | {"exponentformat": "power", "tickformat": None}),
    )
    figure.update_yaxes(row=2, col=1, title_text="phase, °", range=[-185, 185], tickvals=[-180, -90, 0, 90, 180])
    figure.update_xaxes(row=2, col=1, title_text="frequency, Hz")
    figure.update_layout(template=template(), height=420)
    return figure


def _law(place: PlaceRow, omega: NDArray[np.float64]) -> NDArray[np.complex128] | None:
    laws = {"stiffness": np.ones_like(omega), "mass": -(omega**2), "damper": 1j * omega}
    return np.asarray(place.size * laws[place.type], dtype=complex) if place.type in laws else None


def overlay_figure(account: Account, channel: int) -> Figure:
    """Magnitude, phase and distance in standard deviations of one response: measured and models."""
    from plotly.subplots import make_subplots

    figure = make_subplots(rows=3, cols=1, shared_xaxes=True, vertical_spacing=0.03, row_heights=[0.52, 0.24, 0.24])
    f, measured = account.frequency_hz, account.measured[channel]
    _curves(figure, f, measured, "measured", MEASURED_COLOUR, "solid", width=2.4)
    styles = ((POSITIVE_COLOUR, "dash"), (NEGATIVE_COLOUR, "solid"))
    for (name, state), (colour, dash) in zip(account.states, styles, strict=False):
        _curves(figure, f, state.predicted[channel], name, colour, dash)
        away = np.abs(state.predicted[channel] - measured) / account.sigma[channel]
        figure.add_scatter(
            x=f.astype(np.float32), y=np.maximum(away, 0.03).astype(np.float32), mode="lines", name=name,
            legendgroup=name, showlegend=False, line={"color": colour, "dash": dash, "width": 1.2}, row=3, col=1,
            hovertemplate="%{x:.3f} Hz: %{y:.2f} sd<extra>" + name + "</extra>",
        )  # fmt: skip
    figure.add_hline(y=1.0, line={"color": MEASURED_COLOUR, "dash": "dot", "width": 1}, row=3, col=1)
    figure.update_yaxes(row=1, col=1, type="log", title_text="|A/F|, (m/s²)/N", **_DECADES)
    figure.update_yaxes(row=2, col=1, title_text="phase, °", range=[-185, 185], tickvals=[-180, -90, 0, 90, 180])
    figure.update_yaxes(row=3, col=1, type="log", title_text="error, sd", **_DECADES)
    figure.update_xaxes(row=3, col=1, title_text="frequency, Hz")
    figure.update_layout(template=template(), height=620)
    return figure


def posterior_figure(account: Account) -> Figure | None:
    """Calibrated quantities in standard deviations of what the scenario states, with their own; None without any.

    One that the scenario states no tolerance of is left to the table: it has no such standard deviation.
    """
    from plotly import graph_objects as go

    rows = [r for r in account.posterior if r.tolerance and (abs(r.score) > 0.5 or r.score_std < 0.5)]
    if not rows:
        return None
    names = [_plain(r.words) for r in rows]
    figure = go.Figure()
    figure.add_vrect(x0=-1, x1=1, fillcolor="rgba(128,136,148,0.16)", line_width=0, layer="below")
    for at in (-3, 3):
        figure.add_vline(x=at, line={"color": POSITIVE_COLOUR, "dash": "dash", "width": 1.2})
    beyond = [abs(r.score) > 3 for r in rows]
    figure.add_scatter(
        x=[r.score for r in rows], y=names, mode="markers", marker={"opacity": 0}, showlegend=False, hoverinfo="skip",
        error_x={
            "type": "data", "array": [r.score_std if r.fresh_std is None else r.fresh_std for r in rows],
            "thickness": 4, "width": 0, "color": MEASURED_COLOUR,
        },
    )  # fmt: skip
    figure.add_scatter(
        x=[r.score for r in rows], y=names, mode="markers", showlegend=False,
        error_x={
            "type": "data", "array": [r.score_std for r in rows], "thickness": 1.2, "width": 3,
            "color": MEASURED_COLOUR,
        },
        marker={
            "color": [POSITIVE_COLOUR if b else NEGATIVE_COLOUR for b in beyond], "size": 8,
            "symbol": ["diamond" if b else "circle" for b in beyond],
        },
        text=[r.change for r in rows], hovertemplate="%{y}: %{x:.2f} sd, %{text}<extra></extra>",
    )  # fmt: skip
    # Above its row a name costs no width: beside the rows names leave a telephone nothing to draw on.
    for name in names:
        figure.add_annotation(
            text=name, x=0, xref="paper", xanchor="left", y=name, yshift=12, showarrow=False, font={"size": 12}
        )
    figure.update_yaxes(range=[len(rows) - 0.5, -0.9], showgrid=True, ticks="", dtick=1, showticklabels=False)
    figure.update_xaxes(title_text="distance, in stated standard deviations", zeroline=True)
    figure.update_layout(
        template=template(), height=_NAMED_ROW_PX * len(rows) + 100, margin={"l": 8, "r": 8, "t": 8, "b": 60}
    )
    return figure


def _curves(
    figure: Figure,
    frequency_hz: NDArray[np.float64],
    values: NDArray[np.complex128],
    name: str,
    colour: str,
    dash: str,
    *,
    width: float = 1.5,
    points: bool = False,
) -> None:
    """Magnitude into the first row, phase into the second."""
    style: dict[str, Any] = {"line": {"color": colour, "dash": dash, "width": width}, "mode": "lines"}
    if points:
        style = {"mode": "markers", "marker": {"color": colour, "size": 4}}
    size = np.abs(values)
    figure.add_scatter(
        x=frequency_hz.astype(np.float32), y=np.maximum(size, 1e-30).astype(np.float32), name=name, legendgroup=name,
        hovertemplate="%{x:.3f} Hz: %{y:.4g}<extra>" + name + "</extra>", row=1, col=1, **style,
    )  # fmt: skip
    phase = np.degrees(np.angle(values))
    x, y = (frequency_hz, phase) if points else break_wraps(frequency_hz, phase)
    figure.add_scatter(
        x=x.astype(np.float32), y=y.astype(np.float32), name=name, legendgroup=name, showlegend=False,
        connectgaps=False, hoverinfo="skip", row=2, col=1, **style,
    )  # fmt: skip


def _distinct(names: list[str]) -> list[str]:
    """The same names, later ones of the same wording numbered."""
    return [n if names.index(n) == k else f"{n} ({names[: k + 1].count(n)})" for k, n in enumerate(names)]


def _channel_name(label: str, held: str) -> str:
    return f"{_plain(label)}{' ◆' if held == 'run' else ' ◇' if held == 'channel' else ''}"


def _plain(text: str) -> str:
    """Text that plotly shows as it is, without its own markup."""
    return html.escape(text, quote=False)
