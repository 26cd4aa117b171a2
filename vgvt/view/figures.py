"""The plotly figures: sigma plot, frequency responses, MAC matrix.

Every function returns a ``plotly.graph_objects.Figure`` that a notebook shows as it is.
"""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Dof, FrequencyResponseSet, ModalModel, Quantity, Scorecard, auto_mac, modal_assurance, synthesise
from vgvt.data.residual_terms import residual_terms
from vgvt.view.decimation import break_wraps, peak_keeping_index, resonance_grid
from vgvt.view.labels import lane_labels
from vgvt.view.theme import MAC_SCALE, MEASURED_COLOUR, TRUTH_COLOUR, Style, style_of, template

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

_UNITS = {
    Quantity.DISPLACEMENT: ("receptance", "m/N"),
    Quantity.VELOCITY: ("mobility", "(m/s)/N"),
    Quantity.ACCELERATION: ("accelerance", "(m/s²)/N"),
}
_LANE_PX, _CURVE_PX = 46, 360


def sigma_figure(
    frf: FrequencyResponseSet | None,
    claims: Mapping[str, ModalModel],
    truth_hz: Sequence[float] = (),
    band_hz: tuple[float, float] | None = None,
    scorecards: Mapping[str, Scorecard] | None = None,
) -> Figure:
    """Largest singular value over frequency; above it one lane for the truth and one for each identifier.

    Truth (Hz) is drawn as vertical lines, claims as markers with their frequency, open crosses where
    the scorecard calls a claim false. Without FRFs only the lanes are drawn. ValueError when neither
    FRFs nor a band say which frequencies to show.
    """
    from plotly.subplots import make_subplots

    if band_hz is None:
        if frf is None:
            raise ValueError("give FRFs or a band")
        band_hz = (float(frf.frequency_hz[0]), float(frf.frequency_hz[-1]))
    lanes = [*(["truth"] if len(truth_hz) else []), *claims]
    lane_px, curve_px = _LANE_PX * max(len(lanes), 1), _CURVE_PX if frf is not None else 40
    figure = make_subplots(rows=2, cols=1, shared_xaxes=True, vertical_spacing=0.015, row_heights=[lane_px, curve_px])
    figure.update_layout(template=template(), height=lane_px + curve_px + 90, showlegend=frf is not None)
    for frequency in truth_hz:
        figure.add_shape(
            type="line", x0=frequency, x1=frequency, y0=0, y1=1, xref="x2", yref="y2 domain", layer="below",
            line={"color": TRUTH_COLOUR, "width": 1.2, "dash": "4px,3px"}, opacity=0.75,
        )  # fmt: skip
    if len(truth_hz):
        _lane(figure, "truth", np.asarray(truth_hz, float), Style(TRUTH_COLOUR, "line-ns-open", "dash"), band_hz)
    for k, (name, claim) in enumerate(claims.items()):
        inside = claim.band(*band_hz)
        false = _false_frequencies(scorecards, name)
        _lane(figure, name, inside.natural_frequency_hz, style_of(k), band_hz, false)
    if frf is not None:
        _sigma_curves(figure, frf.band(*band_hz), claims, band_hz)
    figure.update_yaxes(
        row=1, col=1, range=[len(lanes) - 0.5, -0.5], tickvals=list(range(len(lanes))), showgrid=False,
        ticktext=[_short(name) for name in lanes], ticks="", showline=False,
    )  # fmt: skip
    figure.update_xaxes(range=list(band_hz))
    figure.update_xaxes(row=1, col=1, showline=False, ticks="", showgrid=False)
    figure.update_xaxes(row=2, col=1, title_text="frequency, Hz")
    return figure


def _lane(
    figure: Figure,
    name: str,
    frequency_hz: NDArray[np.float64],
    style: Style,
    band_hz: tuple[float, float],
    false: frozenset[float] = frozenset(),
) -> None:
    lane = sum(1 for trace in figure.data if trace.meta == "lane")
    texts, positions = lane_labels(frequency_hz, band_hz)
    wrong = [bool(f in false) for f in frequency_hz]
    figure.add_scatter(
        x=frequency_hz, y=np.full(frequency_hz.size, lane), mode="markers+text", text=texts,
        textposition=positions, textfont={"size": 11}, cliponaxis=False, name=_plain(name), meta="lane",
        customdata=frequency_hz.tolist(),
        marker={
            "symbol": ["x-thin-open" if w else style.symbol for w in wrong],
            "color": style.colour, "size": 9, "line": {"width": 2, "color": style.colour},
        },
        hovertext=[f"{_plain(name)}: {f:.3f} Hz{' (false)' if w else ''}"
                   for f, w in zip(frequency_hz, wrong, strict=True)],
        hoverinfo="text", showlegend=False, row=1, col=1,
    )  # fmt: skip


def _sigma_curves(
    figure: Figure, frf: FrequencyResponseSet, claims: Mapping[str, ModalModel], band_hz: tuple[float, float]
) -> None:
    sigma = frf.sigma()
    keep = peak_keeping_index(np.log(np.maximum(sigma, 1e-300)), 1600)
    _curve(figure, frf.frequency_hz[keep], sigma[keep], "measured", MEASURED_COLOUR, "solid", row=2, width=1.6)
    for k, (name, claim) in enumerate(claims.items()):
        style, inside = style_of(k), claim.band(*band_hz)
        if claim.residues is not None and len(claim):
            grid = resonance_grid(claim, band_hz)
            model = _seen_by(claim, frf)
            if model is not None:
                fit = _as_judged(model, grid, frf).sigma()
                _curve(figure, grid, fit, f"{_plain(name)}, fit", style.colour, style.dash, row=2, width=1.4)
        if len(inside):
            level = np.exp(np.interp(inside.natural_frequency_hz, frf.frequency_hz, np.log(np.maximum(sigma, 1e-300))))
            figure.add_scatter(
                x=inside.natural_frequency_hz, y=level, mode="markers", name=_plain(name), row=2, col=1,
                marker={"symbol": style.symbol, "color": style.colour, "size": 9},
                hovertemplate="%{x:.3f} Hz<extra>" + _plain(name) + "</extra>",
            )  # fmt: skip
    name, unit = _UNITS.get(frf.quantity, ("response", ""))
    figure.update_yaxes(
        row=2, col=1, type="log", title_text=f"σ̄ of {name}, {unit}", range=_log_range(sigma), **_DECADES
    )


_DECADES: dict[str, Any] = {"dtick": 1, "tickformat": "~g", "minor": {"showgrid": False, "ticks": "outside"}}


def frf_figure(
    frf: FrequencyResponseSet,
    claims: Mapping[str, ModalModel],
    response: Dof,
    reference: Dof | None = None,
    band_hz: tuple[float, float] | None = None,
    points: int = 900,
) -> Figure:
    """Magnitude and phase of one FRF, measured and as every claim that has residues there is judged by it.

    Of accelerances that is with a mass and a stiffness line, fitted to what was measured in the band.
    """
    from plotly.subplots import make_subplots

    band_hz = band_hz or (float(frf.frequency_hz[0]), float(frf.frequency_hz[-1]))
    frf, reference = frf.band(*band_hz), reference or frf.references[0]
    values = frf.values[frf.responses.index(response), frf.references.index(reference)]
    figure = make_subplots(rows=2, cols=1, shared_xaxes=True, vertical_spacing=0.03, row_heights=[0.66, 0.34])
    figure.update_layout(template=template(), height=520)
    keep = peak_keeping_index(np.log(np.maximum(np.abs(values), 1e-300)), points)
    _bode(figure, frf.frequency_hz[keep], values[keep], "measured", Style(MEASURED_COLOUR, "circle", "solid"))
    for k, (name, claim) in enumerate(claims.items()):
        model = _seen_by(claim, frf, (response,), (reference,))
        if model is not None:
            grid = resonance_grid(model, band_hz, points=max(points // 3, 60))
            fit = _as_judged(model, grid, frf).values[0, 0]
            _bode(figure, grid, fit, _plain(name), style_of(k))
    name, unit = _UNITS.get(frf.quantity, ("response", ""))
    magnitude = np.abs(values)
    figure.update_yaxes(row=1, col=1, type="log", title_text=f"{name}, {unit}", range=_log_range(magnitude), **_DECADES)
    figure.update_yaxes(row=2, col=1, title_text="phase, °", range=[-185, 185], tickvals=[-180, -90, 0, 90, 180])
    figure.update_xaxes(range=list(band_hz))
    figure.update_xaxes(row=2, col=1, title_text="frequency, Hz")
    return figure


def _bode(
    figure: Figure, frequency_hz: NDArray[np.float64], values: NDArray[np.complex128], name: str, style: Style
) -> None:
    _curve(figure, frequency_hz, np.abs(values), name, style.colour, style.dash, row=1)
    x, phase = break_wraps(frequency_hz, np.degrees(np.angle(values)))
    _curve(figure, x, phase, name, style.colour, style.dash, row=2, legend=False)


def mac_figure(
    claim: ModalModel, other: ModalModel | None = None, claim_name: str = "claim", other_name: str = "truth"
) -> Figure:
    """MAC of every claimed mode with every other one, or with themselves (AutoMAC), the number in each cell.

    Shapes are compared at the DOFs that both models have; ValueError when there is none.
    """
    from plotly.graph_objects import Figure, Heatmap

    if other is None:
        columns, values, other_name = claim, auto_mac(claim.shapes), claim_name
    else:
        columns, values = other, common_mac(claim, other)
    figure = Figure(
        Heatmap(
            z=values, zmin=0, zmax=1, colorscale=MAC_SCALE, xgap=2, ygap=2,
            text=[[_mac_text(v) for v in row] for row in values], texttemplate="%{text}", textfont={"size": 12},
            colorbar={"title": {"text": "MAC", "side": "top"}, "thickness": 10, "len": 0.9, "outlinewidth": 0},
            hovertemplate="%{y} against %{x}: %{z:.3f}<extra></extra>",
        )
    )  # fmt: skip
    figure.update_layout(template=template(), height=42 * len(claim) + 120)
    figure.update_xaxes(
        title_text=f"{_plain(other_name)}, Hz", tickvals=list(range(len(columns))), ticktext=_ticks(columns),
        showgrid=False, showline=False, ticks="", side="top",
    )  # fmt: skip
    figure.update_yaxes(
        title_text=f"{_plain(claim_name)}, Hz", tickvals=list(range(len(claim))), ticktext=_ticks(claim),
        showgrid=False, showline=False, ticks="", autorange="reversed",
    )  # fmt: skip
    return figure


def common_mac(first: ModalModel, second: ModalModel) -> NDArray[np.float64]:
    """MAC (M, N) at the DOFs that both models have; ValueError when there is none."""
    known = {d.unsigned for d in second.dofs}
    dofs = tuple(d for d in first.dofs if d.unsigned in known)
    if not dofs:
        raise ValueError("the two modal models share no DOF")
    return modal_assurance(first.at(dofs).shapes, second.at(dofs).shapes)


def _curve(
    figure: Figure,
    x: NDArray[np.floating],
    y: NDArray[np.floating],
    name: str,
    colour: str,
    dash: str,
    *,
    row: int,
    width: float = 1.5,
    legend: bool = True,
) -> None:
    figure.add_scatter(
        x=x.astype(np.float32), y=y.astype(np.float32), mode="lines", name=name, legendgroup=name,
        showlegend=legend, line={"color": colour, "dash": dash, "width": width}, connectgaps=False,
        hovertemplate="%{x:.3f} Hz: %{y:.3g}<extra>" + name + "</extra>", row=row, col=1,
    )  # fmt: skip


def _seen_by(
    claim: ModalModel,
    frf: FrequencyResponseSet,
    responses: tuple[Dof, ...] | None = None,
    references: tuple[Dof, ...] | None = None,
) -> ModalModel | None:
    """The claim with residues at these responses and references (all of the FRFs), None where it has none."""
    from dataclasses import replace

    responses, references = responses or frf.responses, references or frf.references
    if claim.residues is None or not len(claim) or not set(references) <= set(claim.references):
        return None
    if not {d.unsigned for d in responses} <= {d.unsigned for d in claim.dofs}:
        return None
    seen = claim.at(responses)
    assert seen.residues is not None
    columns = [claim.references.index(r) for r in references]
    return replace(seen, references=references, residues=seen.residues[:, :, columns])


def _as_judged(model: ModalModel, grid_hz: NDArray[np.float64], frf: FrequencyResponseSet) -> FrequencyResponseSet:
    """The FRFs of a model over a grid, of accelerances with the residual terms that the fit in per cent is of."""
    from dataclasses import replace

    # Through an exponential window, if there is one, as the measured responses are.
    added = frf.added_decay_rad_per_s
    drawn = synthesise(model, grid_hz, frf.quantity, added_decay_rad_per_s=added)
    if frf.quantity is not Quantity.ACCELERATION:
        return drawn
    rows = [frf.responses.index(d) for d in model.dofs]
    columns = [frf.references.index(d) for d in model.references]
    seen = synthesise(model, frf.frequency_hz, added_decay_rad_per_s=added)
    rest = frf.values[np.ix_(rows, columns)] - seen.values
    alive = np.isfinite(rest).all(axis=(0, 1))
    if int(alive.sum()) < 2:
        return drawn
    terms = residual_terms(rest[:, :, alive], frf.frequency_hz[alive], grid_hz)
    return replace(drawn, values=drawn.values + terms)


def _false_frequencies(scorecards: Mapping[str, Scorecard] | None, name: str) -> frozenset[float]:
    card = (scorecards or {}).get(name)
    rows = card.modes if card is not None else ()
    return frozenset(r.claimed_hz for r in rows if r.status.value == "false" and r.claimed_hz is not None)


def _log_range(values: NDArray[np.floating]) -> list[float]:
    """Axis limits in decades: all of the curve, but no more than five decades below its peak."""
    positive = values[values > 0]
    if not positive.size:
        return [-1.0, 1.0]
    top = float(np.log10(positive.max()))
    bottom = max(float(np.log10(np.percentile(positive, 0.5))), top - 5)
    return [bottom - 0.15, top + 0.15]


def _mac_text(value: float) -> str:
    return "0" if value < 0.005 else f"{value:.2f}"


def _ticks(model: ModalModel) -> list[str]:
    return [f"{f:.2f}" for f in model.natural_frequency_hz]


def _plain(text: str) -> str:
    """Text that plotly shows as it is, without its own markup."""
    return html.escape(text, quote=False)


def _short(text: str, limit: int = 14) -> str:
    return _plain(text if len(text) <= limit else text[: limit - 1] + "…")
