"""The section of the report on how well claims meet the measured frequency responses."""

from __future__ import annotations

import html
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from vgvt.data import FrfFit
from vgvt.view.theme import style_of, template

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

ACCEPTED_PERCENT, ACCEPTED_GAP = 70.0, 0.3
"""What Moreno et al., American Control Conference, 2014, accept."""
_MOST_POINTS = 2000


def fit_summary(fits: Mapping[str, FrfFit]) -> str:
    """A line an identifier: median and worst NRMSE, how many are below the limit, and the largest ν-gap."""
    lines = []
    for name, fit in fits.items():
        said = fit.as_dict(ACCEPTED_PERCENT)
        worst = np.unravel_index(int(np.argmin(fit.fit_percent)), fit.fit_percent.shape)
        lines.append(
            f"<li><b>{html.escape(name)}</b>: NRMSE fit {said['median_fit_percent']:.1f} % (median), "
            f"worst {fit.fit_percent[worst]:.1f} % at {html.escape(str(fit.responses[worst[0]]))}, "
            f"{said['below']} of {fit.fit_percent.size} below {ACCEPTED_PERCENT:g} %; ν-gap at most "
            f"{said['largest_nu_gap']:.3f}, at {said['largest_nu_gap_hz']:.2f} Hz</li>"
        )
    note = (
        "How well the claimed modes, with a mass and a stiffness line for those outside the band, meet the measured "
        f"accelerances. The authors of the method accept a fit above {ACCEPTED_PERCENT:g} % and a ν-gap below "
        f"{ACCEPTED_GAP:g}, with accelerances in g/N."
    )
    return f'<p class="note">{note}</p><ul class="advice">{"".join(lines)}</ul>'


def fit_figure(fits: Mapping[str, FrfFit]) -> Figure:
    """NRMSE over the responses above, ν-gap over frequency below, with the limits of acceptance."""
    import plotly.graph_objects as go
    from plotly.subplots import make_subplots

    figure = make_subplots(rows=2, cols=1, vertical_spacing=0.2)
    for k, (name, fit) in enumerate(fits.items()):
        colour: dict[str, Any] = {"color": style_of(k).colour}
        several = len(fit.references) > 1
        labels = [f"{r} / {i}" if several else str(r) for i in fit.references for r in fit.responses]
        figure.add_trace(
            go.Bar(x=labels, y=fit.fit_percent.T.ravel(), name=name, marker=colour, legendgroup=name), row=1, col=1
        )
        step = max(1, -(-fit.frequency_hz.size // _MOST_POINTS))
        rows = range(0, fit.frequency_hz.size, step)
        # The largest of each bin, so that thinning hides no peak.
        peaks = [float(fit.nu_gap[i : i + step].max()) for i in rows]
        figure.add_trace(
            go.Scatter(
                x=[float(fit.frequency_hz[i]) for i in rows], y=peaks, name=name, line=colour, mode="lines",
                legendgroup=name, showlegend=False,
            ), row=2, col=1,
        )  # fmt: skip
    for row, limit in ((1, ACCEPTED_PERCENT), (2, ACCEPTED_GAP)):
        figure.add_hline(y=limit, row=row, col=1, line={"dash": "dash", "width": 1})
    figure.update_yaxes(title="NRMSE fit, %", row=1, col=1)
    figure.update_yaxes(title="ν-gap", range=[0, 1], row=2, col=1)
    figure.update_xaxes(title="response", row=1, col=1)
    figure.update_xaxes(title="frequency, Hz", row=2, col=1)
    figure.update_layout(template=template(), height=560, barmode="group")
    return figure
