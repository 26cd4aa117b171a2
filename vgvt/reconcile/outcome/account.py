"""A verdict as the arrays and labels that its page shows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Geometry
from vgvt.reconcile.decision.kinds import Kind
from vgvt.reconcile.decision.verdict import NamedEffect, Verdict
from vgvt.reconcile.evidence.localise import HARDLY
from vgvt.reconcile.evidence.plausible import implausible
from vgvt.reconcile.evidence.residual import Residual
from vgvt.reconcile.evidence.untold import untold_parameters
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.next_test.power_rows import power_rows
from vgvt.reconcile.outcome.augment import posterior_of
from vgvt.reconcile.outcome.mode_errors import mode_rows
from vgvt.reconcile.question.figures_of_merit import Comparison
from vgvt.reconcile.question.problem import CELLS
from vgvt.reconcile.question.thresholds import Thresholds, noise_share
from vgvt.scenario.planform import outlines_m
from vgvt.view.reconcile_account import (
    FIGURES,
    Account,
    CandidateRow,
    ChannelRow,
    EffectRow,
    ModelState,
    NamelessRow,
    PlaceRow,
    PosteriorRow,
    Standing,
    SuggestionRow,
)

if TYPE_CHECKING:
    from vgvt.reconcile.decision.addition import Addition
    from vgvt.reconcile.decision.attribute import Attribution
    from vgvt.reconcile.evidence.nameless import Nameless
    from vgvt.reconcile.evidence.rivals import Rival
    from vgvt.reconcile.next_test.power import Power
    from vgvt.reconcile.question.problem import Problem


def account_of(
    verdict: Verdict, *, title: str, facts: Mapping[str, str] | None = None, power: tuple[Power, ...] = ()
) -> Account:
    """What the page of a verdict shows; ``facts`` head it, ``power`` is what ``power`` says beside the names."""
    found = verdict.attribution
    problem = found.null.problem
    split, measured, limits = problem.split, problem.measured, verdict.thresholds
    own, seen = found.null_residual.limits, np.flatnonzero(measured.used)
    rows = [
        ChannelRow(c.label, "run" if whole else "channel" if alone else "")
        for c, whole, alone in zip(measured.channels, split.held_runs, split.held_channels, strict=True)
    ]
    places = verdict.localisation.places if verdict.localisation else ()
    at_null = verdict.kind is Kind.EXPLAINED or not found.rounds
    return Account(
        title=title,
        kind=verdict.kind.value,
        reasons=verdict.reasons,
        unexplained=verdict.unexplained,
        facts=dict(facts or {}),
        geometry=_geometry(problem),
        channels=tuple(rows[k] for k in seen),
        frequency_hz=measured.frequency_hz,
        measured=measured.values[seen],
        sigma=measured.sigma[seen],
        bands_hz=found.null_residual.bands_hz,
        before=_state(found.null, found.null_residual, verdict.before, seen),
        after=_state(found.final, found.final_residual, verdict.after, seen),
        limits={
            "chi2_per_dof": own.chi2_per_dof,
            "smooth_per_dof": own.smooth_per_dof,
            "held_out_chi2_per_dof": own.held_out_per_dof,
            "strain_sd": own.strain_sd,
            "evidence_nats": limits.evidence_nats,
            "set_nats": limits.set_nats,
            "place_explained": HARDLY,
        },
        provenance=limits.provenance,
        effects=_effects(verdict.effects, found.rounds),
        leads=_effects(verdict.leads, found.leads),
        candidates=_candidates(found, limits),
        places=tuple(
            PlaceRow(p.label, p.kind, p.position_m, p.explained, p.type, p.size, p.unit, p.dynamic_stiffness, p.turns)
            for p in places
        ),
        located="the calibrated scenario" if at_null else "the scenario with what was named",
        nameless=None if found.nameless is None else _nameless(found.nameless),
        posterior=_posterior(found.final),
        modes=mode_rows(found.null, found.final),
        power=power_rows(power),
        tests=tuple(SuggestionRow(s.test, s.rivals, s.nats, s.minutes) for s in verdict.suggested_tests),
        remarks=measured.remarks,
        resimulated=None if verdict.resimulated.comparison is None else _merits(verdict.resimulated.comparison),
        resimulation_remark=verdict.resimulated.remark,
        turned=split.turn > 0,
        noise_per_dof=found.null_residual.noise_per_dof,
        model_form=noise_share(measured, split.train).floor,
    )


def _nameless(found: Nameless) -> NamelessRow:
    law, reading = found.law, found.law.reading
    read = reading.at(law.frequency_hz) if reading.tells else None
    return NamelessRow(
        found.where.words, found.where.kind, found.in_words, law.unit, law.frequency_hz, law.values, law.std,
        read,
    )  # fmt: skip


def _geometry(problem: Problem) -> Geometry:
    grid = problem.layouts.first.grid
    nodes = {point.dof.node: np.asarray(point.position_m, dtype=float) for point in grid}
    return Geometry(tuple(nodes), np.array(list(nodes.values())), (), outlines_m(problem.scenario.airframe))


def _state(fit: Fit, left: Residual, comparison: Comparison, seen: NDArray[np.intp]) -> ModelState:
    figures = {
        "chi2_per_dof": left.train_chi2_per_dof,
        "smooth_per_dof": left.smooth_per_dof,
        "held_out_chi2_per_dof": left.held_out_chi2_per_dof,
        "lag_one": left.lag_one,
        "between_channels": left.between_channels,
        "share_beyond_three": left.share_beyond_three,
        "strain_sd": left.strain_sd,
    }
    return ModelState(fit.foretold[seen], left.table[seen], figures, _merits(comparison), left.adequate)


def _merits(comparison: Comparison) -> dict[str, dict[str, float] | None]:
    parts = {f.name: getattr(comparison, f.name) for f in fields(comparison)}
    return {name: None if part is None else asdict(part) for name, part in parts.items()}


def _effects(effects: Sequence[NamedEffect], rounds: Sequence[Addition]) -> tuple[EffectRow, ...]:
    rows = []
    for effect, addition in zip(effects, rounds, strict=True):
        cls = addition.winner.hypothesis.cls
        others = {r.name: _separating_test(r.hypothesis.cls) for r in addition.alike if r.name in effect.equivalent}
        rows.append(
            EffectRow(
                effect.name, effect.summary, effect.parameters, effect.settings, effect.evidence_nats,
                effect.equivalent, effect.held_out_before, effect.held_out_after,
                str(getattr(cls, "signature", "")), _separating_test(cls), effect.ranges, others,
                effect.run_numbers, effect.elsewhere,
            )
        )  # fmt: skip
    return tuple(rows)


def _separating_test(cls: type) -> str:
    return str(getattr(cls, "separating_test", ""))


def _candidates(found: Attribution, limits: Thresholds) -> tuple[CandidateRow, ...]:
    rows = []
    before = found.null_residual.held_out_chi2_per_dof
    first: Standing = "named" if found.rounds else "lead"
    rounds = found.rounds or found.leads
    for k, addition in enumerate(rounds, start=1):
        rows += [
            _candidate(k, rival, addition.held_out_before, _standing(rival, addition, found, limits, first))
            for rival in (*addition.rivals, *addition.in_its_place[1:])
        ]
    tried = {id(r) for addition in rounds for r in addition.rivals}
    if rounds:
        before = (found.led or found.final).held_out_chi2_per_dof
    last = [rival for rival in found.last_rivals if id(rival) not in tried]
    rows += [_candidate(len(rounds) + 1, r, before, _standing(r, None, found, limits, first)) for r in last]
    return tuple(rows)


def _candidate(k: int, rival: Rival, before: float | None, standing: Standing) -> CandidateRow:
    last = len(rival.fit.hypotheses) - 1
    values, untold = rival.fit.values(last), untold_parameters(rival.fit, last)
    told = ((name, value) for name, value in values.items() if name not in untold)
    fitted = ", ".join(f"{name} {value:.4g} {unit}".rstrip() for name, (value, _, unit) in told)
    label = rival.hypothesis.label
    nats = (rival.gain_nats, rival.raw_nats, rival.lasting_nats)
    return CandidateRow(k, label, *nats, before, rival.held_out, standing, fitted, rival.fit.converged)


def _standing(
    rival: Rival, addition: Addition | None, found: Attribution, limits: Thresholds, first: Standing
) -> Standing:
    if addition is not None and rival is addition.winner:
        return first
    if addition is not None and any(rival is r for r in addition.alike):
        return "equivalent"
    refused = any(rival is r for r in found.vetoed)
    if refused and implausible(rival.fit):
        return "no plausible thing"
    if not refused and not rival.fit.converged:
        return "its fit had not ended"
    if not rival.convinces(limits):
        return "too little evidence"
    return "refused by held-out data" if refused else "beaten"


def _posterior(fit: Fit) -> tuple[PosteriorRow, ...]:
    rows = []
    for r in posterior_of(fit):
        if "factor" in r:
            change = f"× {_number(r['factor'], 4)} ± {_number(r['factor_std'], 2)}"
        else:
            change = f"{_number(r['shift'], 3, '+')} ± {_number(r['shift_std'], 2)} {r.get('unit', '')}".rstrip()
        unit = str(r.get("unit", ""))
        stated = f"{_number(r['stated'], 4)} {unit}".strip() if "stated" in r else ""
        calibrated = f"{_number(r['calibrated'], 4)} {unit}".strip() if "calibrated" in r else ""
        rows.append(
            PosteriorRow(
                str(r["name"]),
                str(r["what"]),
                float(str(r["score"])),
                float(str(r["std_score"])),
                change,
                stated,
                calibrated,
                str(r["name"]) != CELLS.name,
                float(str(r["fresh_std_score"])),
                {name: float(str(r[name])) for name in FIGURES if name in r},
                unit,
            )
        )
    return tuple(rows)


def _number(value: object, digits: int, sign: str = "") -> str:
    return format(float(str(value)), f"{sign}.{digits}g")
