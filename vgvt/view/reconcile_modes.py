"""Mode by mode on a reconciliation's page: what was measured, what both models have, and the error around it."""

from __future__ import annotations

from vgvt.view.html_page import escaped
from vgvt.view.reconcile_account import Account, ModeRow, SeenRow
from vgvt.view.reconcile_markup import improvement, number, percent, table

_SEEN = ("measured, Hz", "measured ζ, %")
_PAIR = ("before, Hz", "after, Hz", "ζ before, %", "ζ after, %", "MAC with measured")
_ONE = ("model, Hz", "ζ, %", "MAC with measured")
_ERRORS = ("error fitted, %", "error held out, %")
_MODELS = (
    "Modes of the models are those of their first run{paired}. In brackets stands by how many per cent they are off "
    "what was measured, by the same local fit of both responses, run by run; of the records its mean over the runs "
    "with one standard deviation, in which is what such a fit is off on the model's own responses, and nothing where "
    "they do not show the mode. Errors: median over channels of |predicted - measured| relative to |measured|, in a "
    "window of three half-power widths around the mode."
)


def modes_section(account: Account) -> str:
    """Mode by mode: frequency, damping and shape as measured and of the models, and the error around each."""
    if not account.modes:
        return ""
    pair = account.changed
    heads = (*_SEEN, *(_PAIR if pair else _ONE), *_ERRORS)
    rows = [(*_measured(m.seen), *(_of_both(m) if pair else _of_one(m))) for m in account.modes]
    note = _MODELS.format(paired=", paired by shape" if pair else "")
    return f'<p class="note">{escaped(note)}</p>{table(heads, rows)}'


def _measured(seen: SeenRow | None) -> tuple[str, str]:
    if seen is None:
        return "", ""
    hz = f"{seen.frequency_hz:.3f} ± {seen.frequency_std_hz:.1g}"
    return hz, f"{100 * seen.damping_ratio:.2f} ± {100 * seen.damping_std:.1g}"


def _of_both(m: ModeRow) -> tuple[str, ...]:
    """Cells of a mode before and after."""
    hz, damping = (m.before_hz, m.after_hz), (m.before_damping_ratio, m.after_damping_ratio)
    by_hz, by_damping, macs = _errors(m.seen)
    return (
        *(_with_error(number(v, ".3f"), e, 2) for v, e in zip(hz, by_hz, strict=True)),
        *(_with_error(percent(v), e, 1) for v, e in zip(damping, by_damping, strict=True)),
        " → ".join(number(v, ".3f") or "–" for v in macs) if m.seen else "",
        improvement(m.train_percent),
        "" if m.held_out_percent is None else improvement(m.held_out_percent),
    )


def _of_one(m: ModeRow) -> tuple[str, ...]:
    """Cells of a mode of the one model."""
    by_hz, by_damping, macs = _errors(m.seen)
    return (
        _with_error(number(m.before_hz, ".3f"), by_hz[0], 2),
        _with_error(percent(m.before_damping_ratio), by_damping[0], 1),
        number(macs[0], ".3f"),
        f"{m.train_percent[0]:.1f}",
        "" if m.held_out_percent is None else f"{m.held_out_percent[0]:.1f}",
    )


_Two = tuple[float | None, float | None]


def _errors(seen: SeenRow | None) -> tuple[_Two, _Two, _Two]:
    nothing = (None, None)
    if seen is None:
        return nothing, nothing, nothing
    return seen.frequency_error_percent, seen.damping_error_percent, seen.mac


def _with_error(value: str, error_percent: float | None, digits: int) -> str:
    """A value with how far it is from what was measured, per cent."""
    if error_percent is None or not value:
        return value
    # What rounds to nothing has no sign.
    error = round(error_percent, digits) + 0.0
    return f"{value} ({error:{'+' if error else ''}.{digits}f})"
