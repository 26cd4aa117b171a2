"""Work on one case: the analysis gets the campaign and the nominal scenario; the umpire then judges its verdict."""

from __future__ import annotations

import hashlib
import time
from pathlib import Path
from typing import Any

import loop_truth as lab
import numpy as np
from loop_cases import LINES, OPEN_SET, Case, Staged, staged
from loop_limits import own_ratio
from loop_places import said_place

import vgvt.reconcile
from vgvt.effects import available_effects, parameters_of
from vgvt.reconcile import NamedEffect, Verdict, reconcile
from vgvt.reconcile.fitting.fit import FAR, FORGIVING, NEAR, TO_THE_END, Fit, fit
from vgvt.reconcile.placebo import best_nats
from vgvt.reconcile.question.hypothesis import Hypothesis

Row = dict[str, Any]
LARGEST_SET = 3
_OTHER_END = {"x_m": "other_x_m", "y_m": "other_y_m", "other_x_m": "x_m", "other_y_m": "y_m"}


def work(case: Case) -> list[Row]:
    """The row of a case; the reason in it where there is no verdict."""
    started = time.process_time()
    row: Row = {
        "group": case.group, "truth": "+".join(case.truth), "draw": case.draw, "size": case.size, "noise": case.noise,
        "source": case.source, "engine": case.engine, "catalogue": len(case.catalogue), "seed": case.base,
        "core": core(),
    }  # fmt: skip
    try:
        stage = staged(case)
    except Exception as error:  # noqa: BLE001  one impossible truth must not stop a night's work
        return [row | {"verdict": "not staged", "reason": f"{type(error).__name__}: {error}"[:200]}]
    row |= {"ratio": stage.ratio}
    if stage.campaign is None:
        return [row | {"verdict": "not visible"}]
    try:
        # What would tell an ambiguous answer apart has a study of its own.
        verdict = reconcile(stage.campaign, lab.nominal(), effects=case.catalogue, lines=LINES, with_tests=False)
    except Exception as error:  # noqa: BLE001  a crash of the analysis is a result, too
        return [row | {"verdict": "failed", "reason": f"{type(error).__name__}: {error}"[:200]}]
    told = told_the_truth(case, stage, verdict)
    row |= judged(case, stage, verdict) | {
        "oracle_held_out": None if told is None or case.group in OPEN_SET else told.held_out_chi2_per_dof,
        "told_ahead_nats": None if told is None else round(ahead(told, verdict), 2),
        "own_ratio": None if told is None or case.group in OPEN_SET else own_ratio(told, stage.truth),
    }
    return [row | {"cpu_s": round(time.process_time() - started, 1), "settings": str(stage.truth)}]


def judged(case: Case, stage: Staged, verdict: Verdict) -> Row:
    """A verdict against the truth, in plain values."""
    sets = [tuple(dict.fromkeys((e.name, *e.equivalent))) for e in verdict.effects]
    before, after = verdict.before, verdict.after
    held_before, held_after = before.held_out or before.train, after.held_out or after.train
    places = verdict.localisation.places if verdict.localisation else ()
    return {
        "verdict": verdict.kind.value,
        "named": " | ".join(" or ".join(s) for s in sets),
        "answer": answer(case.truth, verdict.kind.value, sets),
        "evidence_nats": round(max((e.evidence_nats for e in verdict.effects), default=best_rival(verdict)), 2),
        "train_before": before.train.chi2_per_dof, "train_after": after.train.chi2_per_dof,
        "held_before": held_before.chi2_per_dof, "held_after": held_after.chi2_per_dof,
        "nrmse_before": held_before.nrmse_percent, "nrmse_after": held_after.nrmse_percent,
        "smooth_before": verdict.attribution.null_residual.smooth_per_dof,
        "noise_per_dof": verdict.attribution.null_residual.noise_per_dof,
        "held_out_noise_per_dof": verdict.attribution.null_residual.held_out_noise_per_dof,
        "place": places[0].label if places else "",
        "near": stage.place.same(said_place(verdict, lab.nominal())),
        "known_place": stage.place.known,
        "leads": " | ".join(e.name for e in verdict.leads),
        "strain_before": verdict.attribution.null_residual.strain_sd,
        "strain_after": verdict.attribution.final_residual.strain_sd,
        "deviations": deviations(stage.truth, verdict),
    }  # fmt: skip


# A/F is a quotient: what all responses gain is what the force lost.
_GAINS, _QUOTIENT = ("gain_error", "drift"), {"force", "response"}


def deviations(truth: dict[str, dict[str, Any]], verdict: Verdict) -> str:
    """What is true of named effects, in stated standard deviations from what the verdict says: ``mass_kg -0.7``.

    On a logarithmic scale in those of the logarithm, as intervals are stated.
    """
    rows = []
    for effect in verdict.effects:
        scales = {p.name: p.scale for p in parameters_of(available_effects()[effect.name])}
        true = truth.get(effect.name, {})
        for name, (value, std, _) in effect.parameters.items():
            known = true.get(_OTHER_END.get(name, name) if _ends_exchanged(true, effect) else name)
            if known is None or std <= 0:
                continue
            if name in _GAINS and {true.get("channels"), effect.settings.get("channels")} == _QUOTIENT:
                known = 1 / (1 + known) - 1
            if scales[name] == "log":
                rows.append(f"{name} {np.log(known / value) * value / std:.2f}")
            else:
                rows.append(f"{name} {(known - value) / std:.2f}")
    return "; ".join(rows)


def _ends_exchanged(true: dict[str, Any], effect: NamedEffect) -> bool:
    """Whether a verdict names the two ends of what ties two places together the other way round."""
    if not set(_OTHER_END) <= set(true) or not set(_OTHER_END) <= set(effect.parameters):
        return False
    told = {name: effect.parameters[name][0] for name in _OTHER_END}
    other = sum((told[n] - true[m]) ** 2 for n, m in _OTHER_END.items())
    return bool(other < sum((told[n] - true[n]) ** 2 for n in told))


def answer(truth: tuple[str, ...], kind: str, sets: list[tuple[str, ...]]) -> str:
    """The verdict in a word: 'right', 'in the set', 'wrong', 'wrong set', 'part', 'unknown' or 'nothing'.

    'right' names exactly what is true; 'in the set' names it beside at most two others; 'part' names one of two.
    """
    if not sets:
        return "nothing" if kind == "adequate" else "unknown"
    hit = [next((s for s in sets if name in s), None) for name in truth]
    found = [s for s in hit if s is not None]
    if len(found) == len(truth) > 0:
        if any(len(s) > LARGEST_SET for s in found):
            return "wrong set"
        extra = len(sets) > len(set(found))
        return "in the set" if extra or any(len(s) > 1 for s in found) else "right"
    if found:
        return "part"
    return "wrong" if all(len(s) == 1 for s in sets) else "wrong set"


def best_rival(verdict: Verdict) -> float:
    """Gain of the best candidate where none was named: what placebos calibrate."""
    return best_nats(verdict.attribution.last_rivals, verdict.attribution.vetoed)


def ahead(told: Fit, verdict: Verdict) -> float:
    """By how many nats of evidence a fit that is told the truth is ahead of the verdict's.

    Neither pays for the choice of a variant: a fit that is told has none.
    """
    final = verdict.attribution.final
    paid = sum(float(np.log(h.share)) for h in final.hypotheses)
    return float(told.evidence_nats - (final.evidence_nats - paid))


def told_the_truth(case: Case, stage: Staged, verdict: Verdict) -> Fit | None:
    """A fit that is told which effect acts, with which settings and sizes; None where that tells nothing.

    Of an effect that is not in the catalogue it tells whether what is named could have been told from the truth.
    """
    asked = case.group in ("effect", "alone") or (case.group in OPEN_SET and bool(verdict.effects))
    if not asked or not stage.truth or not all(stage.truth.values()):
        return None
    hypotheses, start = [], []
    for name, values in stage.truth.items():
        cls = available_effects()[name]
        numbers = {p.name for p in parameters_of(cls)}
        # A size that the truth has not is known to be none.
        absent = {p.name: p.neutral for p in parameters_of(cls) if p.neutral is not None and p.name not in values}
        hypothesis = Hypothesis(cls, absent | {k: v for k, v in values.items() if k not in numbers})
        hypotheses.append(hypothesis)
        start.append(hypothesis.scores({k: v for k, v in values.items() if k in numbers}))
    found = verdict.attribution
    problem, e = found.null.problem, np.concatenate(start)
    # Told the effect, it may still lose its way from a calibration that swallowed it: the best of three starts, but
    # where the verdict names it and leaves nothing but noise, beside which no other start can find anything.
    fits = []
    starts = [(found.final.u, NEAR), (found.null.u, FAR), (np.zeros(problem.size), (*FORGIVING, *TO_THE_END))]
    if found.final_residual.adequate and {e.name for e in verdict.effects} == set(stage.truth):
        starts = starts[:1]
    for u, stages in starts:
        try:
            fits.append(fit(problem, tuple(hypotheses), u, e, stages))
        except (ValueError, RuntimeError, np.linalg.LinAlgError):
            continue
    if not fits:
        return None
    return max(fits, key=lambda f: f.evidence_nats)


def core() -> str:
    """A short hash of the analysis' source: which version of it gave this answer."""
    digest = hashlib.sha256()
    for file in sorted(Path(vgvt.reconcile.__file__).parent.rglob("*.*")):
        if file.suffix in (".py", ".toml"):
            digest.update(file.read_bytes())
    return digest.hexdigest()[:8]
