"""The tables and texts of a reconciliation's page as HTML."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from vgvt.view.html_page import escaped
from vgvt.view.power_account import PowerRow
from vgvt.view.reconcile_account import Account, CandidateRow
from vgvt.view.reconcile_markup import listed, number, table
from vgvt.view.reconcile_wording import (
    DATA_SETS,
    KINDS,
    as_well,
    disproofs,
    held_once,
    next_steps,
    parameter_text,
    share_words,
    verdict_sentence,
    warnings_of,
)

_MERITS = (
    ("chi2_per_dof", "χ² per dof", ".2f"),
    ("nrmse_percent", "NRMSE fit, %", ".2f"),
    ("mean_abs_db", "mean error, dB", ".3f"),
    ("frac", "FRAC", ".5f"),
    ("nu_gap", "ν-gap", ".3f"),
)
_WORST = 8


def verdict_section(account: Account) -> str:
    """The verdict, why, and the figures that it rests on."""
    facts = "".join(f"<div><dt>{escaped(k)}</dt><dd>{escaped(v)}</dd></div>" for k, v in account.facts.items())
    return (
        f'<p class="verdict verdict-{account.kind.replace("_", "-")}"><b>{escaped(KINDS[account.kind])}.</b> '
        f"{escaped(verdict_sentence(account))}</p>"
        f"<h3>Why</h3>{listed(account.reasons)}<h3>What to do</h3>{listed(next_steps(account))}"
        f'<dl class="facts">{facts}</dl>'
    )


def named_section(account: Account) -> str:
    """What was named, or comes nearest, with its parameters and everything that explains the data as well."""
    found = account.effects or account.leads
    if not found:
        return ""
    heads = ("effect", "parameters", "evidence, nats", "held-out χ² before", "after", "explains it as well")
    rows = [
        (
            f"<b>{escaped(e.name)}</b><br>{escaped(e.summary)}", escaped(parameter_text(e)), f"{e.evidence_nats:.1f}",
            number(e.held_out_before, ".2f"), number(e.held_out_after, ".2f"),
            escaped(", ".join(as_well(e.equivalent, [p.where for p in e.elsewhere])) or "nothing else that was tried"),
        )
        for e in found
    ]  # fmt: skip
    note = (
        f"Effects within {account.limits['set_nats']:g} nats of the best form a set that this campaign cannot tell "
        "apart. ± is one standard deviation with everything else free."
    )
    if not account.effects:
        note = (
            "No names: held-out data confirm them, but something else speaks against each, and the reasons say what. "
            "Nothing else on this page includes them. " + note
        )
    return f'<p class="note">{escaped(note)}</p>{table(heads, rows, words=(0, 1, 5))}'


def error_section(account: Account) -> str:
    """Error before and after, on the data that were fitted and on those that were not."""
    heads = ["data", *(name for _, name, _ in _MERITS)]
    rows = []
    for key, words in held_once(DATA_SETS, account.before.merits).items():
        for name, state in account.states:
            merit = state.merits.get(key)
            if merit is not None:
                rows.append((f"{escaped(words)}, {name}", *_merit_cells(merit)))
        again = None if account.resimulated is None else account.resimulated.get(key)
        if again is not None:
            rows.append((f"{escaped(words)}, simulated again", *_merit_cells(again)))
    note = (
        "NRMSE fit: 100 % is perfect, 70 % is commonly called excellent; FRAC: 1 is perfect; medians over channels. "
        "The error in dB is the mean over lines and channels. ν-gap: how far apart a feedback loop sees the two, all "
        "channels as one system, accelerances in g/N; 0 is equal, 1 the furthest. "
    )
    if account.resimulated is not None:
        note += (
            "Simulated again: the records of reconciled.toml by the linear engine, or in time where a name depends on "
            "level, without noise, read as the measured ones were."
        )
    remark = account.resimulation_remark
    warned = f"<p>{escaped(remark)}.</p>" if remark else ""
    return warned + table(heads, rows, words=(0,)) + f'<p class="note">{escaped(note.strip())}</p>'


def _merit_cells(merit: Mapping[str, float]) -> list[str]:
    return [format(merit[figure], form) for figure, _, form in _MERITS]


def places_table(account: Account, count: int = 10) -> str:
    """The places that explain most."""
    rows = [
        (escaped(p.label), share_words(p.explained), escaped(p.type or ""),
         f"{p.size:.3g} {escaped(p.unit)}" if p.size else "")
        for p in account.places[:count]
    ]  # fmt: skip
    heads = ("place", "explained", "looks like", "size")
    # Nothing on the structure has a size where no simple law fits.
    used = 4 if any(row[3] for row in rows) else 3
    return table(heads[:used], [row[:used] for row in rows], words=(0, 2)) if rows else ""


def candidates_table(account: Account, rows: Sequence[CandidateRow]) -> str:
    """Every candidate that was fitted in a round, with what held-out data say of it."""
    heads = (
        "candidate", "fitted", "evidence, nats", "untempered", "where errors last", "held-out χ² without", "with",
        "standing",
    )  # fmt: skip
    cells = [
        (
            escaped(r.label), escaped(r.fitted), f"{r.gain_nats:.1f}", f"{r.raw_nats:.1f}",
            number(r.lasting_nats if r.converged else None, ".1f"), number(r.held_out_before, ".2f"),
            number(r.held_out_after, ".2f"), escaped(r.standing),
        )
        for r in sorted(rows, key=lambda r: -r.gain_nats)
    ]  # fmt: skip
    return table(heads, cells, words=(0, 1, 7))


def power_section(power: Sequence[PowerRow], beside: Sequence[str] = ()) -> str:
    """Detectability: the sizes of each effect that could be seen and named, and what it would be taken for.

    ``beside`` are the names that are part of the model and have no row.
    """
    if not power:
        return ""
    heads = (
        "effect, parameter", "just visible", "named from", "at median", "at worst", "plausible", "visible",
        "hard to tell from",
    )  # fmt: skip
    rows = []
    for p in power:
        smallest, named, worst = p.sizes
        median = (f"{p.median:.2g}" if np.isfinite(p.median) else "never") if worst else ""
        alike = ", ".join(f"{escaped(name)} ({cosine:.2f})" for name, cosine in p.alike[:4])
        found = {"yes": '<span class="found">yes</span>', "no": '<span class="missed">no</span>'}
        mark = found.get(p.shows, escaped(p.shows))
        # The unit once: in every cell it would leave the last column room for single words.
        unit = f", {escaped(p.unit)}" if p.unit else ""
        what = f"<b>{escaped(p.effect)}</b><br>{escaped(p.parameter)}{unit}"
        if p.place and np.isfinite(p.smallest):
            what += f"<br>best with {escaped(p.place)}"
        others = "; ".join(f"{escaped(place)} ({cosine:.2f})" for place, cosine in p.other_places)
        alike = "<br>".join(text for text in (alike, others and f"place not told from {others}") if text)
        rows.append((what, smallest, named, median, worst, f"{p.low:g} to {p.high:g}", mark, alike))
    note = (
        "Just visible: five standard deviations beyond what the scenario's tolerances can imitate, by both views of "
        "the model's own error, for the variant of the effect (place, side, channel) that shows at the smallest size; "
        "at the median of the variants, and at the worst, it takes what is said there. Named from: where it shows "
        "best, 95 of 100 of such effects get their name, as far as the fitted data decide; of those that are just "
        "visible fewer than half do, as a rule. Never: it leaves the ratio of acceleration to force alone. By level, "
        "not foretold: what it does hangs on the level of force, and not on its size alone. Sizes hold at the "
        "default of whatever else an effect has, as a frequency or an angle. Hard to tell from: cosine of the two "
        "signatures. Place not told from: where else (at which place, side or channel) the same effect would look like "
        "the one that shows best, with that cosine, three at most."
    )
    if beside:
        note = f"Beside what was named ({', '.join(beside)}), which is in the model and has no row here. {note}"
    return f'<p class="note">{escaped(note)}</p>{table(heads, rows, words=(0, 7))}'


def tests_section(account: Account) -> str:
    """The suggested tests, best first."""
    rows = [
        (escaped(t.test), escaped(" against ".join(t.rivals)), f"{nats:.0f}", f"{t.minutes:.0f}",
         f"{nats / t.minutes:.1f}")
        # A little below nothing is nothing: followed by fits it is what the two were apart before.
        for t in account.tests for nats in (max(t.nats, 0.0),)
    ]  # fmt: skip
    if not rows:
        return ""
    heads = ("change of procedure", "tells apart", "expected nats", "minutes", "nats a minute")
    note = "Simulated under both explanations; five nats are enough to choose."
    return f'<p class="note">{note}</p>{table(heads, rows, words=(0, 1))}'


def unexplained_section(account: Account) -> str:
    """What is left, and where it is largest: channel and band."""
    state = account.after
    rows = []
    # Of many cells a few are large by chance: they are told only where the whole is too large.
    cells = () if state.adequate else np.argsort(-state.table, axis=None)[:_WORST]
    for flat in cells:
        c, b = np.unravel_index(int(flat), state.table.shape)
        value = float(state.table[c, b])
        if value <= account.limits["chi2_per_dof"]:
            continue
        low, high = account.bands_hz[b], account.bands_hz[b + 1]
        held = {"": "fitted", "run": "held-out run", "channel": "held-out channel"}[account.channels[c].held]
        rows.append((escaped(account.channels[c].label), held, f"{low:.2f} to {high:.2f}", f"{value:.1f}"))
    intro = listed(account.unexplained) if account.unexplained else (
        "<p>Nothing beyond what campaigns without a missing effect leave.</p>"
    )  # fmt: skip
    cells_table = table(("channel", "data", "band, Hz", "χ² per dof"), rows, words=(0, 1)) if rows else ""
    heading = "<h3>Where most is left</h3>" if rows else ""
    return intro + heading + cells_table


def disproof_section(account: Account) -> str:
    """What would show that the verdict is wrong."""
    return listed(disproofs(account))


def posterior_table(account: Account) -> str:
    """Warnings first; every calibrated quantity in a table that opens."""
    warned = warnings_of(account)
    words = (
        f"<p><b>Beyond three stated standard deviations</b>: the scenario or its tolerances are wrong there, or the "
        f"calibration bends them to imitate what is missing.</p>{listed(warned)}"
        if warned
        else "<p>No calibrated quantity is further than three standard deviations from what the scenario states.</p>"
    )
    rows = [
        (
            escaped(r.words),
            escaped(r.stated),
            escaped(r.change),
            escaped(r.calibrated),
            f"{r.score:+.2f} ± {r.score_std:.2f}" if r.tolerance else "no tolerance stated",
        )
        for r in account.posterior
    ]
    heads = ("quantity", "stated", "change", "calibrated", "score, stated sd")
    everything = table(heads, rows, words=(0,))
    return (
        f"{words}<details><summary>All {len(rows)} calibrated quantities</summary>{everything}</details>"
        if rows
        else words
    )
