"""What a model leaves of the data, in single numbers: the limits, what sigma is made up of, what is held out."""

from __future__ import annotations

import math

import numpy as np

from vgvt.view.html_page import escaped
from vgvt.view.reconcile_account import Account
from vgvt.view.reconcile_markup import table

_FIGURES = (
    ("chi2_per_dof", "χ² per degree of freedom, fitted data"),
    ("smooth_per_dof", "the same of sums over neighbouring lines, fitted data"),
    ("held_out_chi2_per_dof", "χ² per degree of freedom, held-out data"),
    ("lag_one", "correlation of neighbouring lines, fitted data"),
    ("between_channels", "correlation between channels of a run, fitted data, mean of absolute values"),
    ("share_beyond_three", "share of lines beyond 3 sd, all data"),
    ("strain_sd", "how far all tolerances are leant on together, sd"),
)


def residual_table(account: Account) -> str:
    """The residual in single numbers, before and after, with the limits."""
    states = account.states
    heads = ("", *(name for name, _ in states), "at most, without a missing effect")
    rows = []
    for key, words in _FIGURES:
        values = [state.figures.get(key) for _, state in states]
        limit = account.limits.get(key)
        cells = [_judged(value, limit) for value in values]
        rows.append((escaped(words), *cells, "" if limit is None else f"{limit:.2f}"))
    lines = len(account.frequency_hz)
    # Of independent complex noise: the mean size of a mean of so many products, and what is beyond three.
    together, beyond = math.sqrt(math.pi / lines) / 2, math.exp(-9.0)
    note = (
        "1 is what noise and the model's floor explain; the limits are what campaigns in which nothing is missing stay "
        f"within. {lines} lines, {len(account.channels)} channels. Where sigma is all noise, chance alone gives "
        f"channels a correlation of {together:.2f}, as absolute values do not cancel, and puts {beyond:.4f} of lines "
        "beyond 3 sd: they are complex (of real ones it would be 0.0027)."
    )
    source = f'<p class="note">{escaped(account.provenance)}.</p>'
    fold = f"<details><summary>Where the limits come from</summary>{source}</details>"
    sigma = f'<p class="note">{escaped(_sigma_in_words(account))}</p>'
    return table(heads, rows, words=(0,)) + f'<p class="note">{escaped(note)}</p>{sigma}{fold}'


def held_out_note(account: Account) -> str:
    """Which data no fit has seen."""
    runs: dict[str, list[str]] = {}
    for c in account.channels:
        if c.held == "run":
            run, _, dof = c.label.partition(", ")
            runs.setdefault(run, []).append(dof)
    alone = [c.label for c in account.channels if c.held == "channel"]
    if not runs and not alone:
        return '<p class="note">The campaign is too small to hold anything out: no effect can be named from it.</p>'
    said = []
    if runs:
        whole = ", ".join(f"{run} ({', '.join(dofs)})" for run, dofs in runs.items())
        said.append(f"whole runs (◆): {whole}")
    if alone:
        said.append(f"single channels (◇): {' and '.join(alone)}")
    when = (
        "Held out of the fits that this verdict rests on: another hold-out than the first one, chosen as data held out "
        "at first were missed"
        if account.turned
        else "Held out of every fit, fixed by the scenario's seed before the first one"
    )
    text = f"{when}: {'; '.join(said)}."
    if account.changed:
        text += (
            " What was named had to foretell them, so that their error after it is the least of several that were "
            "tried: a run that is measured afterwards is the blind test."
        )
    return f'<p class="note">{escaped(text)}</p>'


def _sigma_in_words(account: Account) -> str:
    """What the standard deviation is made up of that everything is judged by, and what of it noise is."""
    size = 100 * float(np.median(account.sigma / np.abs(account.measured)))
    text = f"How sigma is made up: its median is {size:.2f} % of the response; noise of the records, and an error of "
    text += "the model's form"
    if account.model_form is not None:
        text += f" ({100 * account.model_form:.2g} % of the response and as much of its median over the lines, which is"
        text += " model_form of the scenario's tolerances)"
    text += ", add up in squares."
    if account.noise_per_dof is not None:
        text += (
            f" Noise is {account.noise_per_dof:.2f} of each 1 on fitted data: a model whose form is right leaves that, "
            "and a limit may be below 1."
        )
    return text


def _judged(value: float | None, limit: float | None) -> str:
    if value is None:
        return ""
    text = f"{value:.2f}" if abs(value) >= 0.1 or value == 0 else f"{value:.4f}"
    if limit is None:
        return text
    return f'<span class="{"missed" if value > limit else "found"}">{text} {"✕" if value > limit else "✓"}</span>'
