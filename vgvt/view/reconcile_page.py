"""The page of a reconciliation: the verdict first, then everything that it rests on."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vgvt.files.atomically import replacing
from vgvt.view import reconcile_figures as figures_of
from vgvt.view import reconcile_sections as parts
from vgvt.view.html_page import escaped, figure_data, figure_element, html_page
from vgvt.view.power_account import PowerRow
from vgvt.view.reconcile_account import Account
from vgvt.view.reconcile_drawing import places_drawing, places_key
from vgvt.view.reconcile_law import law_figure
from vgvt.view.reconcile_modes import modes_section
from vgvt.view.reconcile_residual import held_out_note, residual_table

_MAP = (
    "Square error over its variance, averaged in each cell, of the calibrated scenario{before_after}: 1 (pale) is what "
    "noise and the model's floor explain; where a column is blank no line of the data falls. "
    "A stripe down all channels is a mode that is missing or misplaced; a row is one sensor; a block of rows one run."
)
_PLACES = (
    "A free force (or moment, or gain) at one place at a time: the share of the residual that it would explain, "
    "whatever its law, after the calibration has taken what it can. Neighbouring places explain nearly as much as the "
    "right one; a cause that is spread over the aircraft is explained by none. "
    "Areas are shares; diamonds are joints, discs are points."
)
_STIFFNESS = (
    "The force that explains most, over the motion there. Flat: a spring; rising as ω² with phase 180°: a mass; "
    "rising as ω at 90°: a damper; poles and zeros: something resonant. Scatter: the residual says little there."
)
_LAW = (
    "The law that one thing there would have, smooth over frequency and fitted together with all that is uncertain; "
    "bands are one standard deviation. On the structure it is force over motion: a level real part is a spring, one "
    "that falls as ω² a mass, an imaginary part that rises as ω a damper. On a channel it is what is added to a factor "
    "of one: a level real part is a gain, an imaginary part that falls as ω a delay; of the "
    "force, by which all are divided, it is the inverse of what it reads as."
)
_EVIDENCE = (
    "Every candidate of the short list fitted together with all unknowns: how much more likely it makes the fitted "
    "data, its own freedom paid for, in nats. The dashed line is what a name needs, of the bar and of the mark, which "
    "is the evidence where errors of the model last from line to line. Held-out data must agree."
)
_POSTERIOR = (
    "Bars are one standard deviation of the result, the grey band is what the scenario states. The thick part of a bar "
    "is what noise and tolerances leave open. The whole of it holds, too, by how much the result may have been led "
    "astray: by an error of the model that lasts over neighbouring lines (model_form), by the beams' cells, and by "
    "stiffness and mass between the stations that the tolerances know. No tolerance bounds that: a bar may be longer "
    "than the band."
)
_OVERLAY = (
    "Measured, {models}; the lowest panel is the error in standard deviations, 1 is what noise and the model's floor "
    "explain."
)


def write_reconcile_page(path: Path, account: Account) -> Path:
    """Write the page of a reconciliation, whole or not at all."""
    with replacing(path) as temporary:
        temporary.write_text(render_reconcile_page(account), encoding="utf-8", newline="\n")
    return path


def render_reconcile_page(account: Account) -> str:
    """The same page as a string."""
    data: dict[str, Any] = {}
    sections = {
        "verdict": ("Verdict", parts.verdict_section(account)),
        "named": ("What was named" if account.effects else "What comes nearest", parts.named_section(account)),
        "residual": ("What the model leaves", _residual(account, data)),
        "places": ("Where it comes from", _places(account, data)),
        "nameless": ("One thing without a name", _nameless(account, data)),
        "candidates": ("Candidates", _candidates(account, data)),
        "error": ("Error before and after" if account.changed else "Error", parts.error_section(account)),
        "modes": ("Mode by mode", modes_section(account)),
        "responses": ("Responses", _responses(account, data)),
        "tests": ("The next test", parts.tests_section(account)),
        "power": (
            "What this campaign could see",
            parts.power_section(account.power, [e.name for e in account.effects]),
        ),
        "unexplained": ("What stays unexplained", parts.unexplained_section(account)),
        "disproof": ("What would disprove it", parts.disproof_section(account)),
        "calibration": ("Calibrated within the tolerances", _calibration(account, data)),
    }
    return html_page(account.title, sections, data)


def write_power_page(path: Path, title: str, facts: dict[str, str], power: Sequence[PowerRow]) -> Path:
    """Write the page of what a test could see before it is made, whole or not at all."""
    cells = "".join(f"<div><dt>{escaped(k)}</dt><dd>{escaped(v)}</dd></div>" for k, v in facts.items())
    seen = sum(p.visible for p in power)
    body = (
        f"<p>Of {len(power)} parameters of effects, {seen} would show within their plausible range.</p>"
        f'<dl class="facts">{cells}</dl>{parts.power_section(power)}'
    )
    with replacing(path) as temporary:
        page = html_page(title, {"power": ("What this test could see", body)}, {})
        temporary.write_text(page, encoding="utf-8", newline="\n")
    return path


def _residual(account: Account, data: dict[str, Any]) -> str:
    data["map-data"] = figure_data(figures_of.residual_map_figure(account))
    drawn = figure_element("map-data", "Residual over frequency, channels and runs")
    remarks = "".join(f'<p class="note">{escaped(remark)}.</p>' for remark in account.remarks)
    note = _note(_MAP.format(before_after=" before an effect is added and after" if account.changed else ""))
    return residual_table(account) + note + drawn + held_out_note(account) + remarks


def _places(account: Account, data: dict[str, Any]) -> str:
    if not account.places:
        return ""
    drawing = places_drawing(account.geometry, account.places)
    body = _note(f"{_PLACES} Located at {account.located}.")
    body += f'<div class="setup">{drawing}</div>{places_key(account.places)}' if drawing else ""
    body += parts.places_table(account)
    best = next((p for p in account.places if p.stiffness is not None), None)
    figure = None if best is None else figures_of.stiffness_figure(best, account.frequency_hz)
    if best is not None and figure is not None:
        data["stiffness-data"] = figure_data(figure)
        looks = best.type if best.type and best.type != "unclear" else "none of the simple laws"
        body += f"<h3>z(ω) of {escaped(best.label)}: looks like {escaped(looks)}</h3>{_note(_STIFFNESS)}"
        body += figure_element("stiffness-data", f"Dynamic stiffness of {best.label}")
    return body


def _nameless(account: Account, data: dict[str, Any]) -> str:
    found = account.nameless
    if found is None:
        return ""
    data["law-data"] = figure_data(law_figure(found))
    text = f"<p>{escaped(found.told[0].upper() + found.told[1:])}.</p>{_note(_LAW)}"
    return text + figure_element("law-data", f"Law of a {found.words}")


def _candidates(account: Account, data: dict[str, Any]) -> str:
    if not account.candidates:
        return "<p>None of the catalogue promised enough in the screening to be fitted.</p>"
    body = _note(_EVIDENCE)
    for k in sorted({r.round for r in account.candidates}):
        rows = tuple(r for r in account.candidates if r.round == k)
        figure = figures_of.evidence_figure(rows, account.limits["evidence_nats"])
        if figure is None:
            continue
        key = f"evidence-{k}-data"
        data[key] = figure_data(figure)
        body += f"<h3>Round {k}</h3>{figure_element(key, f'Evidence of the candidates of round {k}')}"
        body += parts.candidates_table(account, rows)
    return body


def _responses(account: Account, data: dict[str, Any]) -> str:
    held = [k for k, c in enumerate(account.channels) if c.held]
    rest = [k for k, c in enumerate(account.channels) if not c.held]
    order = held + rest
    data["frf-data"] = [figure_data(figures_of.overlay_figure(account, k)) for k in order]
    words = {"run": "held out with its run", "channel": "held out", "": "fitted"}
    first = _most_telling(account, held or rest)
    options = "".join(
        f'<option value="{i}"{" selected" if k == first else ""}>'
        f"{escaped(account.channels[k].label)}, {words[account.channels[k].held]}</option>"
        for i, k in enumerate(order)
    )
    chooser = f'<div class="controls"><label>Response <select id="frf-select">{options}</select></label></div>'
    place = '<div id="frf-figure" class="figure" role="figure" aria-label="Response, measured and predicted"></div>'
    models = " and ".join(name for name, _ in account.states)
    return _note(_OVERLAY.format(models=models)) + chooser + place


def _most_telling(account: Account, channels: Sequence[int]) -> int:
    """The one of these channels in which what was named changes most; without a name, in which most is left."""
    before, after = account.before.table, account.after.table
    told = before - after if account.changed else after
    return max(channels, key=lambda k: float(np.nanmax(told[k], initial=-np.inf)))


def _calibration(account: Account, data: dict[str, Any]) -> str:
    figure = figures_of.posterior_figure(account)
    drawn = ""
    if figure is not None:
        data["posterior-data"] = figure_data(figure)
        drawn = _note(_POSTERIOR)
        drawn += figure_element("posterior-data", "Calibrated quantities")
    return parts.posterior_table(account) + drawn


def _note(text: str) -> str:
    return f'<p class="note">{escaped(text)}</p>'
