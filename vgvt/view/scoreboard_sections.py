"""The tables of the scoreboard page as HTML."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vgvt.view.columns import least, mean, median, root_mean_square, stated
from vgvt.view.html_page import escaped

if TYPE_CHECKING:
    import pandas


def matrix_section(table: pandas.DataFrame) -> str:
    """Entries down, scenarios across: found of true, false ones, error over bound; each cell leads to its modes."""
    scenarios, entries = sorted(table["scenario"].unique()), sorted(table["entry"].unique())
    head = "".join(f'<th><a href="#scenario-{escaped(name)}">{escaped(name)}</a></th>' for name in scenarios)
    rows = []
    for entry in entries:
        cells = [_matrix_cell(table[(table["scenario"] == s) & (table["entry"] == entry)], s, entry) for s in scenarios]
        rows.append(f'<tr><th class="words" scope="row">{escaped(entry)}</th>{"".join(cells)}</tr>')
    note = (
        "Modes found of those that the test reaches, per campaign; ✕ false ones; ÷ the root-mean-square ratio of "
        "frequency error to Cramér–Rao bound (1 is the limit, more is worse). The colour tells of the modes alone: "
        "all found, with false ones, or some missed."
    )
    campaigns = table.drop_duplicates(["scenario", "seed_number"]).shape[0]
    return (
        f'<p class="note">{note} {campaigns} campaigns, judged blind.</p><div class="scroll"><table>'
        f'<thead><tr><th class="words">identifier</th>{head}</tr></thead><tbody>{"".join(rows)}</tbody></table></div>'
    )


def _matrix_cell(part: pandas.DataFrame, scenario: str, entry: str) -> str:
    if part.empty:
        return "<td></td>"
    campaigns = part["seed_number"].nunique()
    failed = part.loc[part["outcome"] == "failed", "seed_number"].nunique()
    where = f'href="#{_anchor(scenario, entry)}"'
    if failed == campaigns:
        return f'<td class="missed"><a {where}>no claim</a></td>'
    found, missed, false = (int((part["status"] == s).sum()) for s in ("found", "missed", "false"))
    ratio = root_mean_square(_over_bound(part))
    kind = "missed" if missed or failed else "false" if false else "found"
    false_text = f" ✕ {_number(false / campaigns)}" if false else ""
    ratio_text = f"<br>÷ {_ratio(ratio)}" if np.isfinite(ratio) else ""
    failed_text = f"<br>{failed} failed" if failed else ""
    count = f"{_number(found / campaigns)} of {_number((found + missed) / campaigns)}"
    return f'<td><a class="{kind}" {where}>{count}</a>{false_text}{ratio_text}{failed_text}</td>'


def scenario_section(scenario: str, part: pandas.DataFrame) -> str:
    """One scenario: a table of its modes for every entry, over the seeds."""
    return "".join(
        f'<h3 id="{_anchor(scenario, entry)}">{escaped(entry)}</h3>{_modes_table(rows)}'
        for entry, rows in part.groupby("entry", sort=True)
    )


_HEADS = (
    "mode",
    "true, Hz",
    "found",
    "error f, %",
    "÷ bound",
    "bias f, %",
    "error ζ, %",
    "cover f",
    "cover ζ",
    "least MAC",
)


def _modes_table(rows: pandas.DataFrame) -> str:
    campaigns = rows["seed_number"].nunique()
    true = rows[rows["true_hz"].notna() & (rows["status"] != "unreached")]
    body = []
    # A mode keeps its label over the seeds; its frequency moves a little where the scenario draws at random.
    # Resonances without one are told apart by their order.
    rank = true.groupby(["seed_number", "label"], dropna=False).cumcount().rename("rank")
    groups = true.groupby([true["label"], rank], dropna=False)
    for (label, _), part in sorted(groups, key=lambda item: float(item[1]["true_hz"].mean())):
        found = part[part["status"] == "found"]
        error = stated(found["frequency_error_percent"])
        body.append(
            "<tr>"
            f'<td class="words">{escaped(label)}</td><td>{float(part["true_hz"].mean()):.3f}</td>'
            f"<td>{len(found)} of {len(part)}</td><td>{_text(root_mean_square(error), '.2g')}</td>"
            f"<td>{_ratio(root_mean_square(_over_bound(part)))}</td><td>{_text(mean(error), '+.2g')}</td>"
            f"<td>{_text(root_mean_square(stated(found['damping_error_percent'])), '.2f')}</td>"
            f"<td>{_text(mean(stated(found['frequency_covered'])), '.2f')}</td>"
            f"<td>{_text(mean(stated(found['damping_covered'])), '.2f')}</td>"
            f"<td>{_text(least(stated(found['mac'])), '.3f')}</td></tr>"
        )
    false = rows[rows["status"] == "false"]
    remark = ""
    if len(false):
        where = ", ".join(f"{f:.2f}" for f in sorted(stated(false["claimed_hz"]))[:12])
        many = _more(len(false))
        split = int((false["split"] == True).sum())  # noqa: E712  missing is not split
        twice = f" {split} of them are modes claimed twice." if split else ""
        remark = f'<p class="note">False claims in {campaigns} campaigns: {len(false)}, at {where} Hz{many}.{twice}</p>'
    remark += _cost_and_fit(rows.drop_duplicates("seed_number"))
    remark += _procedure(rows)
    reasons = sorted({str(r) for r in rows["reason"].dropna() if r})
    remark += f'<p class="note">{escaped("; ".join(reasons[:3]))}</p>' if reasons else ""
    if not body:
        return remark
    head = "".join(f"<th{' class=words' if k == 0 else ''}>{h}</th>" for k, h in enumerate(_HEADS))
    return (
        f'<div class="scroll"><table><thead><tr>{head}</tr></thead><tbody>{"".join(body)}</tbody></table></div>{remark}'
    )


def _procedure(rows: pandas.DataFrame) -> str:
    """One line where claims were made without the force: what they are judged by, and how far that is from the test."""
    # A table from before there was such a column says nothing.
    if "true_modes" not in rows.columns or not (rows["true_modes"] == "coupled").any():
        return ""
    named = rows[rows["as_tested_hz"].notna()]
    away = np.abs(stated(named["true_hz"] / named["as_tested_hz"]) - 1).max(initial=0.0)
    damping = np.exp(
        np.abs(np.log(stated(named["true_damping_ratio"] / named["as_tested_damping_ratio"]))).max(initial=0)
    )
    return (
        '<p class="note">Without the force: judged by the modes with the shaker attached. Those as tested are up to '
        f"{100 * away:.2g} % away in frequency and a factor of {damping:.2g} in damping, whatever the method.</p>"
    )


def _cost_and_fit(claims: pandas.DataFrame) -> str:
    """One line on what holds for a claim as a whole: medians over the campaigns."""
    parts = [
        (median(stated(claims["frf_fit_percent"])), "responses fit {:.1f} % (NRMSE)"),
        (median(stated(claims["nu_gap"])), "ν-gap at most {:.3f}"),
        (median(stated(claims["wall_s"])), "{:.1f} s"),
        (median(stated(claims["peak_memory_mib"])), "{:.0f} MiB"),
    ]
    words = ", ".join(form.format(value) for value, form in parts if np.isfinite(value))
    return f'<p class="note">Median of a campaign: {words}.</p>' if words else ""


def failures_section(table: pandas.DataFrame) -> str:
    """Entries without a claim, with the reason and how often."""
    lost = table[table["outcome"] == "failed"]
    if lost.empty:
        return ""
    counts = lost.groupby(["entry", "scenario", "reason"]).size()
    rows = "".join(
        f'<tr><td class="words">{escaped(entry)}</td><td class="words">{escaped(scenario)}</td><td>{count}</td>'
        f'<td class="remark">{escaped(reason)}</td></tr>'
        for (entry, scenario, reason), count in counts.items()
    )
    words = '<th class="words">'
    head = f'{words}identifier</th>{words}scenario</th><th>campaigns</th><th class="remark">reason</th>'
    return f'<div class="scroll"><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>'


def _anchor(scenario: str, entry: str) -> str:
    plain = "".join(c if c.isalnum() else "-" for c in f"{scenario}--{entry}")
    return escaped(plain)


def _over_bound(part: pandas.DataFrame) -> np.ndarray[Any, np.dtype[np.float64]]:
    found = part[part["status"] == "found"]
    return stated((found["claimed_hz"] - found["true_hz"]) / found["frequency_bound_hz"])


def _number(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".")


def _ratio(value: float) -> str:
    return "" if np.isnan(value) else f"{value:.2f}" if value < 100 else f"{value:.0f}"


def _text(value: float, form: str) -> str:
    return "" if np.isnan(value) else format(value, form)


def _more(count: int) -> str:
    return " and more" if count > 12 else ""
