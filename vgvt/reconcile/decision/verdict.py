"""The verdict: adequate, explained, ambiguous, partly explained or unknown, with its reasons in plain words."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from enum import StrEnum

from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.doubts import doubts, far_scores, strained_too_much
from vgvt.reconcile.decision.leads import why_no_name
from vgvt.reconcile.decision.one_level import rests_on_one_level
from vgvt.reconcile.decision.place_control import open_places
from vgvt.reconcile.evidence.localise import Localisation, words_of_place
from vgvt.reconcile.evidence.plausible import implausible
from vgvt.reconcile.evidence.posterior import honest
from vgvt.reconcile.evidence.residual import Residual
from vgvt.reconcile.evidence.rivals import Rival
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.next_test.suggest import Suggestion
from vgvt.reconcile.question.figures_of_merit import Comparison
from vgvt.reconcile.question.harmonics import words_of
from vgvt.reconcile.question.level_grid import several_levels
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.search.shortlist import BIASED
from vgvt.scenario.model import Scenario


class Kind(StrEnum):
    """What a reconciliation can come to."""

    ADEQUATE = "adequate"
    EXPLAINED = "explained"
    AMBIGUOUS = "ambiguous"
    PARTLY_EXPLAINED = "partly_explained"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class NamedEffect:
    """An effect that the data name: parameters {name: (value, standard deviation, unit)}, its settings, its evidence.

    ``equivalent`` are the names of effects that explain the data as well; ``ranges`` are 95 % intervals by parameter.
    """

    name: str
    summary: str
    parameters: dict[str, tuple[float, float, str]]
    settings: dict[str, object]
    evidence_nats: float
    equivalent: tuple[str, ...]
    held_out_before: float | None
    held_out_after: float | None
    ranges: dict[str, tuple[float, float]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Verdict:
    """What a campaign says about a scenario, and everything that the saying rests on.

    ``leads`` come nearest of the catalogue where nothing has a name; no figure of ``after`` includes them.
    """

    kind: Kind
    reasons: tuple[str, ...]
    effects: tuple[NamedEffect, ...]
    leads: tuple[NamedEffect, ...]
    unexplained: tuple[str, ...]
    before: Comparison
    after: Comparison
    suggested_tests: tuple[Suggestion, ...]
    attribution: Attribution
    localisation: Localisation | None
    thresholds: Thresholds
    scenario: Scenario

    def document(self) -> dict[str, object]:
        """Plain values by the keys of the JSON contract."""
        rounds = self.attribution.rounds or self.attribution.leads
        return {
            "verdict": self.kind.value,
            "reasons": list(self.reasons),
            "effects": [_effect_document(e) for e in self.effects],
            "leads": [_effect_document(e) for e in self.leads],
            "unexplained": list(self.unexplained),
            "before": self.before.document(),
            "after": self.after.document(),
            "suggested_tests": [s.document() for s in self.suggested_tests],
            "scenario": self.scenario.name,
            "residual": _residual_document(self.attribution.null_residual),
            "residual_after": _residual_document(self.attribution.final_residual),
            "localisation": [
                {"place": p.label, "explained": p.explained, "type": p.type, "size": p.size, "unit": p.unit}
                for p in (self.localisation.places[:5] if self.localisation else ())
            ],
            "candidates": [
                {
                    "effect": r.hypothesis.label,
                    "gain_nats": r.gain_nats,
                    "raw_nats": r.raw_nats,
                    "lasting_nats": r.lasting_nats,
                    "held_out": r.held_out,
                }
                for r in (rounds[0].rivals if rounds else self.attribution.last_rivals)
            ],
            "thresholds": {
                **asdict(self.attribution.null_residual.limits),
                "evidence_nats": self.thresholds.evidence_nats,
                "provenance": self.thresholds.provenance,
            },
        }


def kind_of(found: Attribution) -> Kind:
    """The verdict that an attribution amounts to."""
    if not found.rounds:
        # Data that are met at the price of tolerances far exceeded are not explained by the scenario as stated.
        met = found.null_residual.adequate and not strained_too_much(found.null)
        return Kind.ADEQUATE if met else Kind.UNKNOWN
    doubtful = bool(doubts(found))
    # What a joint that depends on level leaves, or makes of the tolerances, is for the second level to say: a name that
    # rests on one is not settled, however little is left. A linear name beside such a likeness has to meet the data.
    bends = found.final.converged and any(not a.winner.hypothesis.linear for a in found.rounds)
    awaits_level = rests_on_one_level(found) and (bends or (found.final_residual.met and not doubtful))
    if (not found.final_residual.adequate or doubtful) and not awaits_level:
        return Kind.PARTLY_EXPLAINED
    several = any(len({r.name for r in a.alike}) > 1 or open_places(a) for a in found.rounds)
    return Kind.AMBIGUOUS if several or rests_on_one_level(found) else Kind.EXPLAINED


def named_effects(found: Attribution) -> tuple[NamedEffect, ...]:
    """The effects of the final model with their posterior."""
    return _of_rounds(found.rounds, found.final)


def leads_of(found: Attribution) -> tuple[NamedEffect, ...]:
    """What comes nearest where nothing has a name, with its posterior."""
    return () if found.led is None else _of_rounds(found.leads, found.led)


def _of_rounds(rounds: tuple[Addition, ...], fit: Fit) -> tuple[NamedEffect, ...]:
    if not rounds:
        return ()
    names, final = [], honest(fit)
    for k, addition in enumerate(rounds):
        winner = addition.winner
        others = tuple(dict.fromkeys(r.name for r in addition.alike if r.name != winner.name))
        cls = winner.hypothesis.cls
        names.append(
            NamedEffect(
                winner.name,
                str(cls.summary),  # type: ignore[attr-defined]
                final.values(k),
                dict(final.hypotheses[k].settings),
                winner.gain_nats,
                others,
                addition.held_out_before,
                winner.held_out,
                final.ranges(k),
            )
        )
    return tuple(names)


def reasons_of(kind: Kind, found: Attribution, limits: Thresholds, places: Localisation | None) -> tuple[str, ...]:
    """Why, in plain words."""
    before, after = found.null_residual, found.final_residual
    said = []
    if kind is Kind.ADEQUATE:
        said.append(
            f"The calibrated scenario leaves {before.train_chi2_per_dof:.2f} per degree of freedom, no more than "
            f"campaigns like it without any missing effect ({before.limits.chi2_per_dof:.2f}; noise alone "
            f"{before.noise_per_dof:.2f})"
        )
        idle = [r for r in found.last_rivals if r.convinces(limits) and r not in found.vetoed]
        said += [
            f"{r.hypothesis.label} gains {r.gain_nats:.0f} nats, but takes too little of what is left to have a name"
            for r in idle[:1]
        ] or [
            f"No plausible effect of the catalogue gains the {limits.evidence_nats:.0f} nats of evidence that a name "
            "needs, by both views of the model's own error, and holds on held-out data"
        ]
    else:
        said += [f"Without another effect {text}" for text in before.reasons]
    for addition in found.rounds:
        winner = addition.winner
        said.append(
            f"Adding {winner.hypothesis.label} gains {winner.gain_nats:.0f} nats, {winner.lasting_nats:.0f} where "
            f"errors of the model last (a name needs {limits.evidence_nats:.0f} by both); held-out error goes "
            f"from {addition.held_out_before:.2f} to {winner.held_out:.2f}"
        )
        # Of all that held-out data confirm the winner gains most: what gains more is not confirmed by them.
        beyond = winner.gain_nats + limits.set_nats
        ahead = {r.name: r.gain_nats for r in addition.equivalent if r.gain_nats > beyond}
        # At one level a plain likeness stands beside a nonlinear name that is ahead of it by what depends on no level.
        met = winner.fit.chi2_per_dof < BIASED
        plain = {
            r.name: winner.gain_nats - r.gain_nats
            for r in addition.equivalent
            if met and r.name != winner.name and r.gain_nats < winner.gain_nats - limits.set_nats
        }
        others = sorted({r.name for r in addition.equivalent} - {winner.name, *ahead, *plain})
        said += [
            f"{name} meets the data, too, {nats:.0f} nats behind, and no level of force tells the two"
            for name, nats in plain.items()
        ]
        said += [
            f"{name} would gain {gain:.0f} nats, more than held-out data speak against it"
            for name, gain in ahead.items()
        ]
        if others:
            if winner.fit.chi2_per_dof >= BIASED:
                what = "held-out data as well, within a tenth of what misses them"
            else:
                what = f"the data as well, within {limits.set_nats:.0f} nats"
            said.append(f"{', '.join(others)} explain{'s' if len(others) == 1 else ''} {what}")
        said += [
            f"{r.name} in place of {winner.name} explains the data {_how_well(r, winner, limits.set_nats)}, beside all "
            "that was found"
            for r in addition.in_its_place[1:]
            if r.name not in {e.name for e in addition.equivalent}
        ]
        said += [
            f"Its place is not determined: {where} it explains the data as well" for where in open_places(addition)
        ]
    if kind is not Kind.EXPLAINED and found.rounds:
        said += [f"With it {text}" for text in after.reasons]
    said += [
        f"{name} depends on the level of force, and every run has the same: it needs a second level"
        for name in rests_on_one_level(found)
    ]
    said += doubts(found)
    if strained_too_much(found.null):
        said.append(f"Without any effect the calibration needs {far_scores(found.null)}")
    if kind is Kind.UNKNOWN and not found.null.converged:
        said.append("The calibration had not converged: some of what is left may be its own")
    if kind is Kind.UNKNOWN:
        said.append(
            "No plausible effect of the catalogue explains it with enough evidence, and holds on data that no fit has "
            "seen"
        )
        if found.leads:
            labels = " with ".join(a.winner.hypothesis.label for a in found.leads)
            said.append(
                f"{labels} comes nearest: held-out error goes from {found.leads[0].held_out_before:.2f} to "
                f"{found.leads[-1].winner.held_out:.2f}; {why_no_name(found)}"
            )
        said += [
            f"{r.hypothesis.label} would gain {r.gain_nats:.0f} nats, but held-out data, what one place still "
            "explains with it, or another place where it does as well, speak against it"
            for r in found.vetoed[:3]
            if not implausible(r.fit)
        ]
    if kind in (Kind.UNKNOWN, Kind.ADEQUATE):
        said += _lasting_alone(found, limits)
    said += [
        f"{r.hypothesis.label} would gain {r.gain_nats:.0f} nats, but it is no plausible thing ({'; '.join(strange)})"
        for r in found.vetoed[:3]
        if (strange := implausible(r.fit))
    ]
    if kind in (Kind.PARTLY_EXPLAINED, Kind.UNKNOWN) and not several_levels(found.null.problem):
        said.append(
            "Every run has the same level of force: whether what is left is nonlinear, or drift, needs a second level"
        )
    bent = words_of(found.null.problem.measured.harmonics)
    if bent is not None:
        said.append(bent)
    if places is not None and places.places:
        said.append(words_of_place(places.places[0]))
    return tuple(said)


def _lasting_alone(found: Attribution, limits: Thresholds) -> list[str]:
    """The best variant of each effect that an error of the model would do as well as, in words."""
    best: dict[str, Rival] = {}
    for r in sorted(found.last_rivals, key=lambda r: -r.gain_nats):
        if r.gain_nats >= limits.evidence_nats > r.lasting_nats and not implausible(r.fit):
            best.setdefault(r.name, r)
    return [
        f"{r.hypothesis.label} would gain {r.gain_nats:.0f} nats, but {r.lasting_nats:.0f} where an error of the model "
        f"lasts from line to line, as such errors do: a name needs {limits.evidence_nats:.0f}"
        for r in list(best.values())[:3]
    ]


def _how_well(r: Rival, winner: Rival, set_nats: float) -> str:
    """How well a rival explains the data against the winner, of which it is not behind."""
    ahead = r.gain_nats - winner.gain_nats
    return f"better, by {ahead:.0f} nats" if ahead > set_nats else f"as well, within {set_nats:.0f} nats"


def _effect_document(e: NamedEffect) -> dict[str, object]:
    return {
        "name": e.name,
        "summary": e.summary,
        "parameters": {
            k: {"value": v, "std": sd, "unit": unit} | _interval(e, k) for k, (v, sd, unit) in e.parameters.items()
        },
        "settings": e.settings,
        "evidence_nats": e.evidence_nats,
        "equivalent": list(e.equivalent),
        "held_out_before": e.held_out_before,
        "held_out_after": e.held_out_after,
    }


def _interval(e: NamedEffect, parameter: str) -> dict[str, float]:
    return dict(zip(("low", "high"), e.ranges.get(parameter, ()), strict=False))


def _residual_document(r: Residual) -> dict[str, object]:
    return {
        "chi2_per_dof": r.train_chi2_per_dof,
        "noise_per_dof": r.noise_per_dof,
        "held_out_chi2_per_dof": r.held_out_chi2_per_dof,
        "smooth_per_dof": r.smooth_per_dof,
        "lag_one": r.lag_one,
        "between_channels": r.between_channels,
        "share_beyond_three": r.share_beyond_three,
        "strain_sd": r.strain_sd,
        "adequate": r.adequate,
    }
