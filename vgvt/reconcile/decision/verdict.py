"""The verdict, with everything that it rests on, and the effects that it names."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field

from vgvt.data.shown import counted, headed, listed
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.kinds import Kind
from vgvt.reconcile.decision.place_control import MemberElsewhere, members_elsewhere
from vgvt.reconcile.evidence.localise import Localisation, words_of_place
from vgvt.reconcile.evidence.posterior import honest
from vgvt.reconcile.evidence.residual import Residual
from vgvt.reconcile.evidence.shared_roots import idle_parameters
from vgvt.reconcile.evidence.untold import untold_parameters
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.next_test.suggest import Suggestion
from vgvt.reconcile.question.figures_of_merit import Comparison, Resimulation
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.scenario.model import Scenario
from vgvt.view.reconcile_account import ElsewhereRow
from vgvt.view.reconcile_wording import as_well, fitted_text, setting_text


@dataclass(frozen=True, slots=True)
class NamedEffect:
    """An effect that the data name: parameters {name: (value, standard deviation, unit)}, its settings, its evidence.

    A stiffness that it would have given a root which is jointed already is no parameter of it, nor is what nothing that
    is foretold depends on.

    ``equivalent`` are the names of effects that explain the data as well; ``ranges`` are 95 % intervals by parameter.
    Settings count runs from 1, as a scenario does: ``run_numbers`` has what the campaign calls them, by setting.
    ``elsewhere`` are places where the same effect explains the data as well.
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
    run_numbers: dict[str, int] = field(default_factory=dict)
    elsewhere: tuple[ElsewhereRow, ...] = ()

    def __repr__(self) -> str:
        return headed(f"NamedEffect {self.in_words}")

    @property
    def in_words(self) -> str:
        """Its sizes with their deviations and units, its settings and evidence, and what explains the data as well."""
        sizes = [fitted_text(name, *told, self.ranges.get(name)) for name, told in self.parameters.items()]
        sizes += [setting_text(name, value, self.run_numbers) for name, value in self.settings.items()]
        alike = as_well(self.equivalent, [there.where for there in self.elsewhere])
        others = f"; as well: {listed(alike, 3)}" if alike else ""
        return f"{self.name}: {', '.join((*sizes, f'{self.evidence_nats:.0f} nats'))}{others}"


@dataclass(frozen=True, slots=True, eq=False)
class Verdict:
    """What a campaign says about a scenario, and everything that the saying rests on.

    ``leads`` come nearest of the catalogue where nothing has a name; no figure of ``after`` includes them.
    ``scenario`` is what was found, and ``resimulated`` what its simulation comes to.
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
    resimulated: Resimulation

    def __repr__(self) -> str:
        named = [e.in_words for e in self.effects] + [f"a lead, no name: {e.in_words}" for e in self.leads]
        nameless = self.attribution.nameless
        named += [] if nameless is None else [f"one thing that has no name: {nameless.in_words}"]
        place = self.localisation.places[:1] if self.localisation and self.kind is not Kind.EXPLAINED else ()
        tests = [f"next test: {s.in_words}" for s in self.suggested_tests[:1]]
        counts = f"{counted(len(self.reasons), 'reason')}, {counted(len(self.suggested_tests), 'suggested test')}"
        return headed(
            f"Verdict: {self.kind.value.replace('_', ' ')}; what was found is scenario {self.scenario.name}",
            (
                *named,
                *_error_lines(self.before, self.after, changed=bool(self.effects)),
                *filter(None, [self.resimulated.remark]),
                *map(words_of_place, place),
                *tests,
                f"{counts}; .document() has all",
            ),
            most=14,
        )

    def document(self) -> dict[str, object]:
        """Plain values by the keys of the JSON contract."""
        rounds = self.attribution.rounds or self.attribution.leads
        return {
            "verdict": self.kind.value,
            "reasons": list(self.reasons),
            "effects": [_effect_document(e) for e in self.effects],
            "leads": [_effect_document(e) for e in self.leads],
            "unexplained": list(self.unexplained),
            "nameless": None if self.attribution.nameless is None else self.attribution.nameless.document(),
            "before": self.before.document(),
            "after": self.after.document(),
            "resimulated": self.resimulated.document(),
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
                    "converged": r.fit.converged,
                }
                for r in (rounds[0].rivals if rounds else self.attribution.last_rivals)
            ],
            "thresholds": {
                **asdict(self.attribution.null_residual.limits),
                "evidence_nats": self.thresholds.evidence_nats,
                "provenance": self.thresholds.provenance,
            },
        }


def _error_lines(before: Comparison, after: Comparison, *, changed: bool) -> list[str]:
    """What each model leaves of fitted and of held-out data, a line each."""
    sets = (("fitted", before.train, after.train), ("held out", before.held_out, after.held_out))
    lines = []
    for name, first, last in sets:
        if first is not None and last is not None:
            states = (first, last) if changed else (last,)
            chi2, fits = " → ".join(f"{m.chi2_per_dof:.3g}" for m in states), [f"{m.nrmse_percent:.1f}" for m in states]
            lines.append(f"{name}: χ² per degree of freedom {chi2}, NRMSE fit {' → '.join(fits)} %")
    return lines


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
        cls, (values, ranges) = winner.hypothesis.cls, _told(final, k)
        names.append(
            NamedEffect(
                winner.name,
                str(cls.summary),  # type: ignore[attr-defined]
                values,
                dict(final.hypotheses[k].settings),
                winner.gain_nats,
                others,
                addition.held_out_before,
                winner.held_out,
                ranges,
                final.hypotheses[k].run_numbers,
                tuple(_elsewhere(there) for there in members_elsewhere(addition)),
            )
        )
    return tuple(names)


def _elsewhere(there: MemberElsewhere) -> ElsewhereRow:
    found = honest(there.rival.fit)
    last = len(found.hypotheses) - 1
    values, ranges = _told(found, last)
    own = found.hypotheses[last]
    return ElsewhereRow(there.where, there.not_there, values, dict(own.settings), ranges, own.run_numbers)


def _told(fit: Fit, index: int) -> tuple[dict[str, tuple[float, float, str]], dict[str, tuple[float, float]]]:
    """Values and 95 % intervals of a hypothesis' parameters without those that say nothing."""
    idle = idle_parameters(fit, index).union(untold_parameters(fit, index))
    values, ranges = fit.values(index), fit.ranges(index)
    return {k: v for k, v in values.items() if k not in idle}, {k: v for k, v in ranges.items() if k not in idle}


def _effect_document(e: NamedEffect) -> dict[str, object]:
    return {
        "name": e.name,
        "summary": e.summary,
        **_sizes_document(e),
        "evidence_nats": e.evidence_nats,
        "equivalent": list(e.equivalent),
        "elsewhere": [{"where": p.where, "not_there": p.not_there, **_sizes_document(p)} for p in e.elsewhere],
        "held_out_before": e.held_out_before,
        "held_out_after": e.held_out_after,
    }


def _sizes_document(e: NamedEffect | ElsewhereRow) -> dict[str, object]:
    return {
        "parameters": {
            k: {"value": v, "std": sd, "unit": unit} | _interval(e, k) for k, (v, sd, unit) in e.parameters.items()
        },
        "settings": e.settings,
        "run_numbers": e.run_numbers,
    }


def _interval(e: NamedEffect | ElsewhereRow, parameter: str) -> dict[str, float]:
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
