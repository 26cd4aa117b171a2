"""Write a reconciliation back: the scenario at its calibrated values with the ``[[effect]]`` blocks that were found."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from vgvt.files.atomically import replacing
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.verdict import NamedEffect, Verdict
from vgvt.reconcile.evidence.plausible import PLACES, placed
from vgvt.reconcile.evidence.posterior import honest
from vgvt.reconcile.evidence.shared_roots import agreed
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.outcome.cells import at_whole_cells, with_cells
from vgvt.reconcile.outcome.instruments import gain_tables, unwritten, with_instruments
from vgvt.reconcile.outcome.measured_levels import with_measured_levels
from vgvt.reconcile.question.level_grid import depends_on_level
from vgvt.reconcile.question.uncertain import edited
from vgvt.scenario.effect import EffectTable
from vgvt.scenario.model import Scenario
from vgvt.scenario.write import to_toml
from vgvt.view.reconcile_account import ElsewhereRow
from vgvt.view.reconcile_wording import as_well, setting_text


def augment(scenario: Scenario, found: Attribution) -> Scenario:
    """The scenario with its unknowns at their posterior means and the effects of the final fit switched on.

    A place off the aircraft is stated where it is likeliest on it, and a root that several effects give laws with the
    stiffness that it has: no scenario may say two. Beams have the cells that they need to do what was fitted, all
    else is where it is likeliest beside these, and what the instruments turned out to be comes last. Beside a joint
    that depends on level every run is driven as hard as it was measured.
    """
    final = at_whole_cells(found.final)
    problem = final.problem
    known = problem.unknowns
    # Its stretches are those that were fitted, which a band asked for; those of what is written are left to the next.
    fitted = scenario.model_copy(update={"tolerances": problem.scenario.tolerances})
    calibrated = edited(fitted, known, final.u[: len(known)])
    tables = list(scenario.effect)
    for k, hypothesis in enumerate(final.hypotheses):
        values = {name: value for name, (value, _, _) in final.values(k).items()}
        for pair in PLACES:
            # A place that is not known well may be likeliest off the aircraft, where no command would take it.
            if set(pair) <= {*hypothesis.settings, *values} and not set(pair).isdisjoint(values):
                at = placed(final, k, pair)
                values |= {n: v for n, v in zip(pair, at or (), strict=False) if n in values}
        tables += [EffectTable(name=hypothesis.name, **stated) for stated in agreed(final, k, values)]
    summary = f"{scenario.summary.rstrip('.')}; reconciled with a measured campaign."
    named = calibrated.model_copy(
        update={
            "name": f"{scenario.name}-reconciled"[:60],
            "effect": tuple(tables),
            "summary": summary,
            "tolerances": scenario.tolerances,
        }
    )
    written = with_instruments(with_cells(named, final), final)
    if any(depends_on_level(problem, h) for h in final.hypotheses if not h.linear):
        written = with_measured_levels(written, problem.measured)
    return written


def posterior_of(fit: Fit) -> list[dict[str, object]]:
    """Every calibrated quantity: name, in words, stated and calibrated value, scores and standard deviation.

    ``fresh_std_score`` is the part of that which noise and tolerances leave, no larger than the tolerance. A factor, or
    a shift in ``unit``, and what it makes of the stated value, in that unit, have standard deviations (``_std``), too.
    """
    rows: list[dict[str, object]] = []
    sd, fresh = (np.sqrt(np.diag(covariance)) for covariance in (honest(fit).covariance, fit.covariance))
    for k, unknown in enumerate(fit.problem.unknowns):
        amount = unknown.amount(float(fit.u[k]))
        row: dict[str, object] = {
            "name": unknown.name,
            "what": unknown.what,
            "score": float(fit.u[k]),
            "std_score": float(sd[k]),
            "fresh_std_score": float(fresh[k]),
        }
        if unknown.scale == "log":
            row |= {"factor": amount, "factor_std": amount * unknown.sd * float(sd[k])}
        else:
            row |= {"shift": amount, "shift_std": unknown.rate(float(fit.u[k])) * float(sd[k]), "unit": unknown.unit}
        if unknown.nominal is not None:
            log, spread = unknown.scale == "log", unknown.rate(float(fit.u[k])) * float(sd[k])
            row["stated"] = unknown.nominal
            row["calibrated"] = unknown.nominal * amount if log else unknown.nominal + amount
            row["calibrated_std"] = abs(unknown.nominal) * spread if log else spread
            row["unit"] = unknown.unit
        rows.append(row)
    start = len(fit.problem.unknowns)
    for k, nuisance in enumerate(fit.problem.nuisances):
        u = float(fit.u[start + k])
        factor = float(np.exp(nuisance.sd * u))
        row = {"name": nuisance.name, "what": nuisance.name, "score": u, "std_score": float(sd[start + k])}
        row["fresh_std_score"] = float(fresh[start + k])
        rows.append(row | {"factor": factor, "factor_std": factor * nuisance.sd * float(sd[start + k])})
    return rows


def _comes_to(row: Mapping[str, object]) -> str:
    """``0.0028 to 0.0028113 +- 0.00027 kg`` of what is stated; else a factor, or a shift, with its unit."""
    if "stated" in row:
        stated = f"{row['stated']:.6g} to {row['calibrated']:.6g} +- {row['calibrated_std']:.2g}"
        return f"{stated} {row['unit']}".rstrip()
    if "factor" in row:
        return f"x {row['factor']:.6g} +- {row['factor_std']:.2g}"
    return f"{row['shift']:+.6g} +- {row['shift_std']:.2g} {row['unit']}".rstrip()


def _values(effect: NamedEffect | ElsewhereRow) -> list[str]:
    """Settings and parameters of an effect as comments."""
    settings = [f"#   {_in_a_line(setting_text(k, v, effect.run_numbers))}" for k, v in effect.settings.items()]
    fitted = [_value(k, *told) + _interval(effect, k) for k, told in effect.parameters.items()]
    return settings + fitted


def _value(name: str, value: float, sd: float, unit: str) -> str:
    """A parameter with its standard deviation; one at the end of what is tried has none, and is not sharp."""
    if sd == 0:
        return f"#   {name} = {value:.5g} {unit}".rstrip() + " (the end of what is tried)"
    return f"#   {name} = {value:.5g} +- {sd:.2g} {unit}".rstrip()


def _interval(effect: NamedEffect | ElsewhereRow, parameter: str) -> str:
    known = effect.ranges.get(parameter)
    return "" if known is None else f" (95 % from {known[0]:.4g} to {known[1]:.4g})"


def _in_a_line(text: str) -> str:
    return " ".join(text.split())


def write_reconciled(path: Path, verdict: Verdict, provenance: Mapping[str, str]) -> None:
    """The augmented scenario as TOML with where it comes from, and the posterior, as comments above it."""
    # A name or a word of somebody else's may hold a line's end, and would be no comment behind it.
    lines = [f"# {key}: {_in_a_line(value)}" for key, value in provenance.items()]
    lines += [f"# verdict: {verdict.kind.value}", *(f"# {_in_a_line(reason)}" for reason in verdict.reasons), "#"]
    for effect in verdict.effects:
        alike = ", ".join(as_well(effect.equivalent, [there.where for there in effect.elsewhere]))
        lines.append(f"# {effect.name}: {effect.evidence_nats:.1f} nats, equivalent: {alike or 'none'}")
        lines += _values(effect)
        for there in effect.elsewhere:
            lines += [f"# the same {_in_a_line(there.where)}, not switched on here:", *_values(there)]
    for lead in verdict.leads:
        lines += [f"# a lead, not switched on here: {lead.name}", *_values(lead)]
    lines += [
        "#",
        "# Calibrated within the scenario's tolerances (score in prior standard deviations; what it comes to):",
    ]
    lines += [
        f"#   {r['name']}: {r['score']:+.2f} +- {r['std_score']:.2f}; {_comes_to(r)}"
        for r in posterior_of(verdict.attribution.final)
    ]
    lines.append("# Below stands what is likeliest beside whole cells, which may differ by a part of a deviation.")
    gains = len(gain_tables(verdict.scenario, at_whole_cells(verdict.attribution.final)))
    if gains:
        lines += ["#", f"# The last {gains} [[effect]] tables are no findings: they are the gains above."]
    lines += [
        f"# {_in_a_line(text)}" for text in (*unwritten(verdict.attribution.final), verdict.resimulated.remark) if text
    ]
    with replacing(path) as part:
        part.write_text("\n".join(lines) + "\n\n" + to_toml(verdict.scenario), encoding="utf-8")
