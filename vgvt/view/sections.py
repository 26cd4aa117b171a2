"""The sections of the report as HTML; every text from outside is escaped here."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence

import numpy as np

from vgvt.data import Campaign, ModalModel, ModeScore, ModeStatus, Scorecard, Truth
from vgvt.data.mode_numbers import claim_numbers, score_numbers
from vgvt.view.shape_drawing import setup_drawing, shape_drawing
from vgvt.view.true_modes import TRUTH_IN_WORDS, true_model
from vgvt.view.wording import remark_in_words

_MARKS = {
    ModeStatus.FOUND: "✓ found",
    ModeStatus.MISSED: "– missed",
    ModeStatus.FALSE: "✕ false",
    ModeStatus.UNREACHED: "○ unreached",
}
_LONG_FACT = 60
_SCORE_COLUMNS = (
    ("status", "status"),
    ("true, Hz", ""),
    ("claimed, Hz", ""),
    ("± Hz", ""),
    ("Δf, %", ""),
    ("true ζ, %", ""),
    ("claimed ζ, %", ""),
    ("Δζ, %", ""),
    ("MAC", ""),
    ("as tested, Hz", ""),
    ("as tested ζ, %", ""),
    ("mode", "words"),
    ("remark", "remark"),
)
_CLAIM_COLUMNS = (
    ("mode", ""),
    ("frequency, Hz", ""),
    ("± Hz", ""),
    ("ζ, %", ""),
    ("± %", ""),
    ("name", "words"),
    ("remark", "remark"),
)


def facts_section(campaign: Campaign, facts: Mapping[str, str]) -> str:
    """The facts of the run and of the campaign."""
    rates = sorted({f"{run.sample_rate_hz:g}" for run in campaign.runs})
    longest = max(run.duration_s for run in campaign.runs)
    overloaded = [
        f"run {run.run}: {'; '.join(run.notes) or ', '.join(run.overloaded)}" for run in campaign.runs if run.overloaded
    ]
    items: dict[str, str] = {
        "Campaign": campaign.name,
        "Band": f"{campaign.band_hz[0]:g} to {campaign.band_hz[1]:g} Hz",
        "Runs": f"{len(campaign.runs)} of up to {longest:.4g} s at {', '.join(rates)} Hz",
        "Responses": f"{len(campaign.response_dofs)} degrees of freedom",
        "Driven at": ", ".join(str(d) for d in campaign.reference_dofs) or "no measured force",
        **({"Overloaded": "; ".join(overloaded)} if overloaded else {}),
        **campaign.notes,
        **facts,
    }
    ordered = sorted(items.items(), key=lambda item: len(str(item[1])) > _LONG_FACT)
    cells = "".join(_fact(name, text) for name, text in ordered)
    return f'<dl class="facts">{cells}</dl>'


def _fact(name: str, text: str) -> str:
    css = ' class="long"' if len(str(text)) > _LONG_FACT else ""
    return f"<div{css}><dt>{_e(name[:1].upper() + name[1:])}</dt><dd>{_e(text)}</dd></div>"


def modes_section(claims: Mapping[str, ModalModel], scorecards: Mapping[str, Scorecard]) -> str:
    """One table an identifier: the score where there is a truth, else what it claims."""
    parts = []
    for name, claim in claims.items():
        card = scorecards.get(name)
        parts.append(f"<h3>{_e(name)}</h3>")
        parts.append(_score_table(card) if card is not None else _claim_table(claim))
        parts.append(_advice((*card.remarks, *claim.advice) if card is not None else claim.advice))
    return "".join(parts) or '<p class="note">No identifier was run.</p>'


def shapes_section(
    campaign: Campaign,
    claims: Mapping[str, ModalModel],
    scorecards: Mapping[str, Scorecard],
    truth: Truth | None,
) -> str:
    """Cards with the shape of every claimed mode, and of the true modes that nobody of an identifier's claims met."""
    known = truth is not None and bool(truth.as_tested)
    dashed = ' A dashed line <span class="key line"></span> is the true shape.' if known else ""
    parts = [
        '<p class="note">Above, the plan view: <span class="key" style="background:var(--positive)"></span>plus and '
        '<span class="key" style="background:var(--negative)"></span>minus, larger dots move more. Below, the shape '
        f"seen from behind.{dashed} Only measured points move; sign and scale carry no meaning.</p>"
    ]
    for name, claim in claims.items():
        card = scorecards.get(name)
        true = true_model(truth, card)
        cards = [_claim_card(campaign, claim, k, card, true) for k in range(len(claim))]
        if card is not None and true is not None:
            lost = (*card.rows(ModeStatus.MISSED), *card.unreached)
            seen = _at_measured(true, campaign)
            cards += [_lost_card(campaign, seen, row) for row in lost]
        inner = "".join(cards)
        parts.append(f'<h3>{_e(name)}</h3><div class="cards">{inner}</div>' if cards else "")
    return "".join(parts)


def setup_section(campaign: Campaign) -> str:
    """Where the sensors and the shaker were."""
    return (
        '<p class="note">Plan view, nose up. Dots are response points, triangles are drive points.</p>'
        f'<div class="setup">{setup_drawing(campaign)}</div>'
    )


def _score_table(card: Scorecard) -> str:
    summary = card.summary()
    counts = [f"{card.found} found", f"{card.missed} missed", f"{card.false} false"]
    if card.unreached:
        counts.append(f"{len(card.unreached)} unreached")
    for key, text in (
        ("mean_abs_frequency_error_percent", "frequency within {:.2g} % on average"),
        ("mean_abs_damping_error_percent", "damping within {:.2g} % on average"),
        ("mean_mac", "mean MAC {:.3f}"),
    ):
        value = summary[key]
        if value is not None:
            counts.append(text.format(value))
    listed = "".join(f"<li>{_e(c)}</li>" for c in counts)
    rows = [_score_cells(row) for row in (*card.modes, *card.unreached)]
    against = TRUTH_IN_WORDS[card.true_modes]
    caption = f"Claims against the truth {against}, {card.band_hz[0]:g} to {card.band_hz[1]:g} Hz."
    return f'<ul class="counts">{listed}</ul>' + _table(_SCORE_COLUMNS, rows, caption)


def _score_cells(row: ModeScore) -> tuple[str, ...]:
    return (
        f'<span class="{row.status.value}">{_MARKS[row.status]}</span>',
        *map(_typeset, score_numbers(row)),
        _e(row.label),
        _e(remark_in_words(row.remark)),
    )


def _claim_table(claim: ModalModel) -> str:
    if not len(claim):
        return f'<p class="note">No modes: {_e(claim.outcome.value.replace("_", " "))}.</p>'
    rows = [
        (
            *map(_typeset, claim_numbers(claim, k)),
            _e(claim.labels[k] if claim.labels else ""),
            _e(remark_in_words("; ".join(claim.flags[k]) if claim.flags else "")),
        )
        for k in range(len(claim))
    ]
    return _table(_CLAIM_COLUMNS, rows, "Claimed modes.")


def _claim_card(campaign: Campaign, claim: ModalModel, k: int, card: Scorecard | None, true: ModalModel | None) -> str:
    row = next((r for r in card.modes if r.claimed_index == k), None) if card is not None else None
    hertz = claim.natural_frequency_hz[k]
    ratio = claim.damping_ratio[k]
    words = [f"ζ {100 * ratio:.2f} %"] if np.isfinite(ratio) else []
    name = claim.labels[k] if claim.labels else ""
    if row is not None:
        words.append(f'<span class="{row.status.value}">{_MARKS[row.status]}</span>')
        name = name or row.label
        if row.true_hz is not None and row.mac is not None:
            words.append(f"true {row.true_hz:.2f} Hz, MAC {row.mac:.3f}")
    if name:
        words.append(_e(name))
    reference = None
    if row is not None and row.true_index is not None and true is not None:
        reference = (true, row.true_index)
    drawing = shape_drawing(campaign.geometry, claim, k, f"Mode {k + 1} at {hertz:.2f} Hz {name}", reference)
    return (
        f'<figure class="card"><figcaption><b>{hertz:.2f} Hz</b> · {" · ".join(words)}</figcaption>{drawing}</figure>'
    )


def _lost_card(campaign: Campaign, true: ModalModel, row: ModeScore) -> str:
    drawing = shape_drawing(
        campaign.geometry, true, row.true_index or 0, f"True mode at {row.true_hz:.2f} Hz, {row.status.value}"
    )
    words = " · ".join(filter(None, [f'<span class="{row.status.value}">{_MARKS[row.status]}</span>', _e(row.label)]))
    return (
        f'<figure class="card"><figcaption><b>{row.true_hz:.2f} Hz</b> · truth · {words}</figcaption>{drawing}</figure>'
    )


def _at_measured(true: ModalModel, campaign: Campaign) -> ModalModel:
    known = {d.unsigned for d in true.dofs}
    dofs = tuple(d for d in campaign.response_dofs if d.unsigned in known)
    return true.at(dofs) if dofs else true


def _table(columns: tuple[tuple[str, str], ...], rows: Sequence[tuple[str, ...]], caption: str) -> str:
    """A table whose cells are HTML already; ``columns`` are (heading, class), columns without content are left out."""
    shown = [k for k in range(len(columns)) if any(row[k] for row in rows)]
    head = "".join(f'<th scope="col" class="{columns[k][1]}">{_e(columns[k][0])}</th>' for k in shown)
    body = "".join(
        "<tr>" + "".join(f'<td class="{columns[k][1]}">{row[k]}</td>' for k in shown) + "</tr>" for row in rows
    )
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{_e(caption)}">'
        f"<table><caption>{_e(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def _advice(lines: tuple[str, ...]) -> str:
    inner = "".join(f"<li>{_e(line)}</li>" for line in lines)
    return f'<ul class="advice">{inner}</ul>' if inner else ""


def _typeset(number: str) -> str:
    """A number with a true minus sign."""
    return number.replace("-", "−")


def _e(text: object) -> str:
    return html.escape(str(text), quote=True)
