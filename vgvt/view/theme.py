"""One look for every figure: colour-blind-safe, readable in print, at home on light and dark pages.

Colours after Okabe and Ito, Color universal design, 2008; every colour comes with a symbol and a
dash of its own, so no meaning hangs on colour alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from plotly.graph_objects.layout import Template

FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', 'DejaVu Sans', Arial, sans-serif"
TRUTH_COLOUR = "#009E73"
MEASURED_COLOUR = "#82888f"
POSITIVE_COLOUR = "#D55E00"
NEGATIVE_COLOUR = "#0072B2"
MAC_SCALE = [[0.0, "#f4f7fb"], [0.5, "#bcd4eb"], [0.75, "#86b3db"], [0.9, "#2b6cad"], [1.0, "#08306b"]]


@dataclass(frozen=True, slots=True)
class Style:
    """How one identifier is drawn."""

    colour: str
    symbol: str
    dash: str


_STYLES = (
    Style("#1a80c4", "circle", "solid"),
    Style("#D55E00", "diamond", "dash"),
    Style("#CC79A7", "square", "dot"),
    Style("#E69F00", "triangle-up", "dashdot"),
    Style("#56B4E9", "triangle-down", "longdash"),
    Style("#7B61C4", "pentagon", "longdashdot"),
)


def style_of(index: int) -> Style:
    """The style of the identifier at a place in the report; they repeat after six."""
    return _STYLES[index % len(_STYLES)]


@cache
def template() -> Template:
    """The plotly template; the page recolours text and grid for dark mode and print.

    One for all figures: plotly takes as long to lay a style over its own as for all the rest of a figure.
    """
    from plotly.graph_objects import Figure

    axis = {
        "gridcolor": "rgba(128,136,148,0.22)",
        "linecolor": "rgba(128,136,148,0.7)",
        "zeroline": False,
        "showline": True,
        "ticks": "outside",
        "ticklen": 4,
        "tickcolor": "rgba(128,136,148,0.7)",
        "title": {"standoff": 6, "font": {"size": 13}},
        "automargin": True,
    }
    own = {
        "layout": {
            "font": {"family": FONT, "size": 12, "color": "#1b1f24"},
            "paper_bgcolor": "rgba(0,0,0,0)",
            "plot_bgcolor": "rgba(0,0,0,0)",
            "margin": {"l": 8, "r": 14, "t": 10, "b": 8},
            "xaxis": axis,
            "yaxis": axis,
            "legend": {"orientation": "h", "x": 0, "xanchor": "left", "y": 1.02, "yanchor": "bottom"},
            "hoverlabel": {"font": {"family": FONT}},
        }
    }
    return Figure().update_layout(template=own).layout.template
