"""The figures of the scoreboard page."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vgvt.view.theme import style_of, template

if TYPE_CHECKING:
    import pandas
    from plotly.graph_objects import Figure

_LEVELS = np.array([0.2, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99])


def bound_figure(table: pandas.DataFrame) -> Figure | None:
    """Root-mean-square frequency error of each mode against its Cramér–Rao bound, in Hz; None without any bound."""
    from plotly import graph_objects as go

    figure, places = go.Figure(), _places(table)
    ends: list[float] = []
    for entry, part in _found(table).groupby("entry", sort=True):
        points = []
        for (scenario, label), rows in part.groupby(["scenario", "label"], dropna=False):
            bound = _rms(_float(rows["frequency_bound_hz"]))
            error = _rms(_float(rows["claimed_hz"] - rows["true_hz"]))
            if bound > 0 and error > 0:
                points.append((bound, error, f"{scenario}: {label}, {len(rows)} campaigns"))
        if not points:
            continue
        x, y, words = zip(*points, strict=True)
        ends += [min(x), max(x)]
        figure.add_scatter(
            x=x, y=y, text=words, mode="markers", name=str(entry), marker=_marker(places[entry]), hovertemplate=_HOVER
        )
    if not ends:
        return None
    line = [min(ends) / 2, max(ends) * 2]
    figure.add_scatter(
        x=line, y=line, mode="lines", name="bound", line={"color": "#82888f", "dash": "dash", "width": 1}
    )
    laid_out = _laid_out(figure, "Cramér–Rao bound, Hz", "root-mean-square error, Hz", log=True)
    # Many decades: powers of ten alone.
    laid_out.update_xaxes(dtick=1, exponentformat="power")
    laid_out.update_yaxes(dtick=1, exponentformat="power")
    return laid_out


def calibration_figure(table: pandas.DataFrame) -> Figure | None:
    """Share of stated intervals that hold the truth against their level; None where no entry states any."""
    from plotly import graph_objects as go
    from scipy.stats import norm

    figure, places = go.Figure(), _places(table)
    for entry, part in _found(table).groupby("entry", sort=True):
        z = np.abs(_float(part["claimed_hz"] - part["true_hz"]) / _float(part["frequency_std_hz"]))
        z = z[np.isfinite(z)]
        if z.size < 5:
            continue
        share = (z[:, None] <= norm.ppf((1 + _LEVELS) / 2)).mean(axis=0)
        style = style_of(places[entry])
        figure.add_scatter(
            x=_LEVELS,
            y=share,
            mode="lines+markers",
            name=f"{entry} ({z.size})",
            line={"color": style.colour, "dash": style.dash},
            marker=_marker(places[entry]),
        )
    if not figure.data:
        return None
    figure.add_scatter(
        x=[0, 1], y=[0, 1], mode="lines", name="honest", line={"color": "#82888f", "dash": "dash", "width": 1}
    )
    return _laid_out(figure, "stated level", "share that holds the truth", log=False)


def front_figure(table: pandas.DataFrame) -> Figure | None:
    """Median seconds an identification against the median error over bound, one point per entry."""
    from plotly import graph_objects as go

    places, points = _places(table), []
    for entry, part in table.groupby("entry", sort=True):
        found = _found(part)
        ratio = np.abs(_float(found["claimed_hz"] - found["true_hz"]) / _float(found["frequency_bound_hz"]))
        ratio = ratio[np.isfinite(ratio)]
        seconds = _float(part.drop_duplicates(["scenario", "seed_number"])["wall_s"])
        seconds = seconds[np.isfinite(seconds)]
        # Neither has a place on a logarithmic axis.
        if ratio.size and seconds.size and np.median(ratio) > 0 and np.median(seconds) > 0:
            points.append((str(entry), places[entry], float(np.median(seconds)), float(np.median(ratio))))
    if not points:
        return None
    names, numbers, x, y = zip(*points, strict=True)
    across, up = _log_axis(x), _log_axis(y)
    figure = go.Figure()
    for name, number, seconds_each, over_bound in zip(names, numbers, x, y, strict=True):
        figure.add_scatter(
            x=[seconds_each],
            y=[over_bound],
            text=[name if len(name) <= _LONGEST else name[: _LONGEST - 1] + "…"],
            mode="markers+text",
            textposition=f"top {_inward(seconds_each, across['range'])}",
            cliponaxis=False,
            name=name,
            marker=_marker(number),
            showlegend=False,
            customdata=[name],
            hovertemplate="%{customdata}: %{x:.2f} s, %{y:.2f} times the bound<extra></extra>",
        )
    laid_out = _laid_out(figure, "median time, s", "median error over bound", log=True)
    laid_out.update_xaxes(**across)
    laid_out.update_yaxes(**up)
    return laid_out


_LONGEST = 28
"""Characters of a name written beside a point; hovering tells all of a longer one."""


def _log_axis(values: tuple[float, ...]) -> dict[str, Any]:
    """A logarithmic axis between round numbers with room around the values: 1, 2, 5, or powers of ten over many."""
    low, high = np.log10(min(values)) - 0.08, np.log10(max(values)) + 0.08
    steps = np.log10([1.0, 2.0, 5.0]) if high - low <= 3 else np.zeros(1)
    ticks = np.unique((np.arange(np.floor(low) - 1, np.ceil(high) + 2)[:, None] + steps).ravel())
    ticks = ticks[np.searchsorted(ticks, low, side="right") - 1 : np.searchsorted(ticks, high) + 1]
    numbers = [float(f"{10**t:.3g}") for t in ticks]
    return {
        "range": [float(ticks[0]), float(ticks[-1])],
        "tickvals": numbers,
        "ticktext": [f"{n:g}" for n in numbers],
        "dtick": None,
    }


def _inward(value: float, log_range: list[float]) -> str:
    """Which way a label grows so that it stays in the chart: away from the nearer side."""
    share = (np.log10(value) - log_range[0]) / (log_range[1] - log_range[0])
    return "right" if share < 0.34 else "left" if share > 0.66 else "center"


_HOVER = "%{text}<br>bound %{x:.2e} Hz, error %{y:.2e} Hz<extra></extra>"


def _found(table: pandas.DataFrame) -> pandas.DataFrame:
    return table[table["status"] == "found"]


def _float(column: Any) -> NDArray[np.float64]:
    return np.asarray(column.astype("Float64").to_numpy(dtype=float, na_value=np.nan))


def _rms(values: NDArray[np.float64]) -> float:
    values = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(values**2))) if values.size else 0.0


def _places(table: pandas.DataFrame) -> dict[Any, int]:
    """Every entry's place in the alphabet, so that it looks the same in all figures."""
    return {entry: k for k, entry in enumerate(sorted(table["entry"].unique()))}


def _marker(place: int) -> dict[str, Any]:
    """Styles repeat after six entries: the next six have hollow symbols, then dotted ones."""
    style, round_ = style_of(place), place // 6
    symbol = style.symbol + ("", "-open", "-open-dot", "-dot")[round_ % 4]
    return {"color": style.colour, "symbol": symbol, "size": 8, "opacity": 0.8}


def _laid_out(figure: Figure, x_title: str, y_title: str, log: bool) -> Figure:
    kind = "log" if log else "linear"
    # Digits within a decade too, for axes that span less than one.
    axis = {"type": kind, "dtick": "D2"} if log else {"type": kind, "range": [0, 1.02]}
    figure.update_layout(template=template(), height=440)
    figure.update_xaxes(title_text=x_title, **axis)
    figure.update_yaxes(title_text=y_title, **axis)
    return figure
