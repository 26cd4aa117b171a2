"""The report: one HTML file that needs nothing else, no network, no server, no other file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from vgvt.data import Campaign, Dof, FrequencyResponseSet, FrfFit, Geometry, ModalModel, Scorecard, TrueModes, Truth
from vgvt.files.atomically import replacing
from vgvt.view.figures import common_mac, frf_figure, mac_figure, sigma_figure
from vgvt.view.fit_section import fit_figure, fit_summary
from vgvt.view.html_page import escaped, figure_data, figure_element, html_page
from vgvt.view.sections import facts_section, modes_section, setup_section, shapes_section
from vgvt.view.shape_drawing import shape_nodes
from vgvt.view.shape_geometry import displacement, main_axis, mesh_of
from vgvt.view.stabilisation import stabilisation_figure
from vgvt.view.theme import style_of
from vgvt.view.true_modes import TRUTH_IN_WORDS, judged_by, true_model

_FRF_POINT_BUDGET = 60_000


def write_report(
    path: str | Path,
    *,
    title: str,
    campaign: Campaign,
    frf: FrequencyResponseSet | None,
    claims: Mapping[str, ModalModel],
    truth: Truth | None = None,
    scorecards: Mapping[str, Scorecard] | None = None,
    facts: Mapping[str, str] | None = None,
    fits: Mapping[str, FrfFit] | None = None,
) -> Path:
    """Write the report of a campaign: modes, sigma plot, shapes, MAC matrices, FRFs and set-up.

    ``claims`` and ``scorecards`` are by identifier name; without truth (a measured campaign) the
    report shows claims alone. The file appears whole or not at all. InputError when it cannot be written.
    """
    page = render_report(title, campaign, frf, claims, truth, scorecards or {}, facts or {}, fits or {})
    with replacing(path) as place:
        place.write_text(page, encoding="utf-8", newline="\n")
    return Path(path)


def render_report(
    title: str,
    campaign: Campaign,
    frf: FrequencyResponseSet | None,
    claims: Mapping[str, ModalModel],
    truth: Truth | None,
    scorecards: Mapping[str, Scorecard],
    facts: Mapping[str, str],
    fits: Mapping[str, FrfFit] | None = None,
) -> str:
    """The same page as a string."""
    figures: dict[str, Any] = {}
    sections = {
        "summary": ("Summary", facts_section(campaign, facts)),
        "modes": ("Modes", modes_section(claims, scorecards)),
        "sigma": ("Sigma plot", _sigma_section(campaign, frf, claims, truth, scorecards, figures)),
        "stabilisation": ("Stabilisation", _stabilisation_section(campaign, frf, claims, figures)),
        "shapes": ("Mode shapes", shapes_section(campaign, claims, scorecards, truth)),
        "animation": ("Mode shapes in motion", _animation_section(campaign, claims, truth, scorecards, figures)),
        "mac": ("MAC", _mac_section(campaign, claims, truth, scorecards, figures)),
        "fit": ("Fit", _fit_section(fits or {}, figures)),
        "frf": ("Frequency responses", _frf_section(campaign, frf, claims, figures)),
        "setup": ("Test set-up", setup_section(campaign)),
    }
    return html_page(title, sections, figures, ("figures.js", "viewer.js"))


def _sigma_section(
    campaign: Campaign,
    frf: FrequencyResponseSet | None,
    claims: Mapping[str, ModalModel],
    truth: Truth | None,
    scorecards: Mapping[str, Scorecard],
    figures: dict[str, Any],
) -> str:
    true_hz = _true_frequencies(campaign, truth, scorecards)
    figures["sigma-data"] = figure_data(sigma_figure(frf, claims, true_hz, campaign.band_hz, scorecards))
    text = "The largest singular value of all frequency responses: every mode that the test can see makes a peak."
    if true_hz:
        text += " Dashed vertical lines are the true modes as tested; a cross is a claim that belongs to none."
        if any(judged_by(card) is TrueModes.COUPLED for card in scorecards.values()):
            text += (
                " Claims that were made without the force are judged by those with the shaker attached, not drawn here."
            )
    if frf is not None and any(claim.residues is not None for claim in claims.values()):
        text += " A fit is the claimed modes with residual terms for those outside the band."
    return f'<p class="note">{text}</p>{figure_element("sigma-data", "Sigma plot")}'


def _stabilisation_section(
    campaign: Campaign, frf: FrequencyResponseSet | None, claims: Mapping[str, ModalModel], figures: dict[str, Any]
) -> str:
    parts = []
    for k, (name, claim) in enumerate(claims.items()):
        if claim.candidates:
            figures[f"stabilisation-data-{k}"] = figure_data(
                stabilisation_figure(claim, frf, campaign.band_hz, style_of(k))
            )
            drawing = figure_element(f"stabilisation-data-{k}", f"Stabilisation diagram of {name}")
            parts.append(f"<h3>{escaped(name)}</h3>{drawing}")
    note = (
        "The poles of models of growing order, the sigma plot behind. Poles of the structure come back at every order, "
        "those that a model spends on noise wander; hover to read why a pole was kept or dropped."
    )
    return f'<p class="note">{note}</p>{"".join(parts)}' if parts else ""


def _animation_section(
    campaign: Campaign,
    claims: Mapping[str, ModalModel],
    truth: Truth | None,
    scorecards: Mapping[str, Scorecard],
    figures: dict[str, Any],
) -> str:
    shown = dict(claims)
    for card in (None, *scorecards.values()):
        true = true_model(truth, card)
        if true is not None:
            shown[_truth_name(card)] = true.band(*campaign.band_hz)
    scenes = [_scene(name, model, campaign.geometry) for name, model in shown.items() if len(model)]
    scenes = [scene for scene in scenes if scene["nodes"]]
    if not scenes:
        return ""
    outline = [np.round(np.asarray(ring).reshape(-1, 3), 4).tolist() for ring in campaign.geometry.outline_m]
    figures["shape-data"] = {"outline": outline, "models": scenes}
    options = "".join(f'<option value="{k}">{escaped(scene["name"])}</option>' for k, scene in enumerate(scenes))
    return (
        '<div class="controls"><button id="viewer-play" type="button" aria-pressed="true">❚❚ Pause</button>'
        f'<label>model <select id="viewer-model">{options}</select></label>'
        '<label>mode <select id="viewer-mode"></select></label>'
        '<label>deflection <input id="viewer-scale" type="range" min="5" max="100" value="45"></label></div>'
        '<canvas id="stage" tabindex="0" role="img" aria-label="Animated mode shape, arrow keys turn it"></canvas>'
        '<p class="note">Drag to turn, or use the arrow keys. A real shape stands, a complex one travels.</p>'
    )


def _scene(name: str, model: ModalModel, geometry: Geometry) -> dict[str, Any]:
    nodes = shape_nodes(geometry, model)
    mesh = mesh_of(geometry, nodes)
    modes = []
    for k in range(len(model)):
        vectors = displacement(model, k, nodes)
        label = f" · {model.labels[k]}" if model.labels and model.labels[k] else ""
        modes.append(
            {
                "title": f"{model.natural_frequency_hz[k]:.2f} Hz{label}",
                "re": np.round(vectors.real, 4).tolist(),
                "im": np.round(vectors.imag, 4).tolist(),
                "axis": main_axis(vectors),
            }
        )
    return {
        "name": name,
        "nodes": np.round(mesh.positions_m, 4).tolist(),
        "edges": mesh.edges,
        "faces": mesh.faces,
        "modes": modes,
    }


def _mac_section(
    campaign: Campaign,
    claims: Mapping[str, ModalModel],
    truth: Truth | None,
    scorecards: Mapping[str, Scorecard],
    figures: dict[str, Any],
) -> str:
    parts = []
    for k, (name, claim) in enumerate(claims.items()):
        if not len(claim):
            continue
        card = scorecards.get(name)
        model = true_model(truth, card)
        true = None if model is None else model.band(*campaign.band_hz)
        against = true if true is not None and len(true) and _share_dofs(claim, true) else None
        figures[f"mac-data-{k}"] = figure_data(mac_figure(claim, against, claim_name=name))
        what = f"against the {_truth_name(card)}" if against is not None else "with itself"
        width = max(46 * len(against if against is not None else claim) + 150, 300)
        drawing = figure_element(f"mac-data-{k}", f"MAC of {name} {what}", f' style="width:{width}px"')
        parts.append(f"<div><h3>{escaped(name)} {what}</h3>{drawing}</div>")
    note = "1 for shapes that are the same up to scale, 0 for orthogonal ones."
    return f'<p class="note">{note}</p><div class="matrices">{"".join(parts)}</div>' if parts else ""


def _fit_section(fits: Mapping[str, FrfFit], figures: dict[str, Any]) -> str:
    if not fits:
        return ""
    figures["fit-data"] = figure_data(fit_figure(fits))
    return fit_summary(fits) + figure_element("fit-data", "NRMSE fit and ν-gap")


def _frf_section(
    campaign: Campaign, frf: FrequencyResponseSet | None, claims: Mapping[str, ModalModel], figures: dict[str, Any]
) -> str:
    if frf is None or not frf.responses:
        return ""
    pairs = [(response, reference) for reference in frf.references for response in frf.responses]
    curves = len(pairs) * 2 * (1 + sum(claim.residues is not None for claim in claims.values()))
    points = int(np.clip(_FRF_POINT_BUDGET / curves, 200, 900))
    figures["frf-data"] = [figure_data(frf_figure(frf, claims, *pair, campaign.band_hz, points)) for pair in pairs]
    first = _first_shown(frf.band(*campaign.band_hz), pairs)
    options = "".join(
        f'<option value="{k}"{" selected" if k == first else ""}>{escaped(response)} / {escaped(reference)}</option>'
        for k, (response, reference) in enumerate(pairs)
    )
    note = (
        "Each claim is drawn as its fit is judged: its modes, with a mass and a stiffness line (residual terms) fitted "
        "to what was measured, for the modes outside the band."
    )
    words = f'<p class="note">{note}</p>' if any(claim.residues is not None for claim in claims.values()) else ""
    return (
        f'{words}<div class="controls"><label>response / reference <select id="frf-select">{options}</select></label>'
        "</div>"
        '<div class="figure" id="frf-figure" role="figure" aria-label="Frequency response"></div>'
    )


def _first_shown(frf: FrequencyResponseSet, pairs: list[tuple[Dof, Dof]]) -> int:
    """The driving point where it was measured, else the response that moves most."""
    driving = [k for k, (response, reference) in enumerate(pairs) if response.unsigned == reference.unsigned]
    power = (np.abs(frf.values) ** 2).sum(axis=2).T.ravel()
    return driving[0] if driving else int(np.argmax(power))


def _true_frequencies(
    campaign: Campaign, truth: Truth | None, scorecards: Mapping[str, Scorecard]
) -> tuple[float, ...]:
    """What scorecards call true as tested (the average over the runs), else the first run's modes in the band."""
    judged = [card for card in scorecards.values() if card.true_modes is TrueModes.AS_TESTED]
    rows = {row.true_hz for card in judged for row in (*card.modes, *card.unreached)} - {None}
    if rows:
        return tuple(sorted(f for f in rows if f is not None))
    if truth is None or not truth.as_tested:
        return ()
    return tuple(float(f) for f in truth.as_tested[0].band(*campaign.band_hz).natural_frequency_hz)


def _truth_name(card: Scorecard | None) -> str:
    which = judged_by(card)
    return "truth" if which is TrueModes.AS_TESTED else f"truth {TRUTH_IN_WORDS[which]}"


def _share_dofs(first: ModalModel, second: ModalModel) -> bool:
    try:
        common_mac(first, second)
    except ValueError:
        return False
    return True
