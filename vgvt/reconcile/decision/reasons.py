"""Why a verdict is what it is, in plain words: what is left without a name, with it, and what was refused one."""

from __future__ import annotations

import math

from vgvt.data.shown import listed
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.as_at_rest import rests, why_at_rest
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.doubts import doubts, far_scores, strained_too_much
from vgvt.reconcile.decision.kinds import Kind
from vgvt.reconcile.decision.leads import why_no_name
from vgvt.reconcile.decision.near_leads import beside_a_lead
from vgvt.reconcile.decision.one_level import rests_on_one_level
from vgvt.reconcile.decision.place_control import open_places
from vgvt.reconcile.evidence.localise import Localisation, words_of_place
from vgvt.reconcile.evidence.plausible import implausible
from vgvt.reconcile.evidence.rivals import Rival
from vgvt.reconcile.evidence.untold import untold_parameters
from vgvt.reconcile.question.harmonics import words_of
from vgvt.reconcile.question.level_grid import several_levels
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.question.stretches import stations_for
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.search.shortlist import BIASED
from vgvt.view.reconcile_wording import in_the_ratio, ratio_words

# Of the candidates that were refused a name, the best so many are told.
_TOLD = 3
_AGAINST = (
    "held-out data, what one place still explains with it, or another place where it does as well, speak against it"
)
_NONE = "nothing is held out that could confirm it: a name needs a second run, or more channels"


def reasons_of(kind: Kind, found: Attribution, limits: Thresholds, places: Localisation | None) -> tuple[str, ...]:
    """One sentence for each reason, in the order of the analysis."""
    problem = found.null.problem
    said = _of_an_adequate_model(found, limits) if kind is Kind.ADEQUATE else _of_what_is_left(found)
    for addition in found.rounds:
        swallowed = addition is found.rounds[0] and strained_too_much(found.null)
        said += _of_a_name(addition, limits, swallowed)
    if kind is not Kind.EXPLAINED and found.rounds:
        said += [f"With it {text}" for text in found.final_residual.reasons]
    said += [
        f"{name} depends on the level of force, and every run has the same: it needs a second level"
        for name in rests_on_one_level(found)
    ]
    said += doubts(found)
    if strained_too_much(found.null):
        said.append(f"Without any effect the calibration needs {far_scores(found.null)}")
    if kind is Kind.UNKNOWN:
        said += _of_the_unknown(found)
    if kind in (Kind.UNKNOWN, Kind.ADEQUATE):
        said += _lasting_alone(found, limits)
    said += _of_the_implausible(found)
    if kind is not Kind.UNKNOWN:
        said += _of_one_at_rest(found)
    if kind in (Kind.PARTLY_EXPLAINED, Kind.UNKNOWN) and not several_levels(problem):
        said.append(
            "Every run has the same level of force: whether what is left is nonlinear, or drift, needs a second level"
        )
    if kind in (Kind.PARTLY_EXPLAINED, Kind.UNKNOWN):
        said += _of_few_stretches(problem)
    bent = words_of(problem.measured.harmonics)
    if bent is not None:
        said.append(bent)
    if places is not None and places.places:
        told = words_of_place(places.places[0])
        if found.rounds:
            # Of an explained residual nothing is left to be placed: it is the one that there was before.
            model = "Without" if kind is Kind.EXPLAINED else "With"
            told = f"{model} what was named, {told[0].lower()}{told[1:]}"
        said.append(told)
    return tuple(said)


def _of_an_adequate_model(found: Attribution, limits: Thresholds) -> list[str]:
    """How little is left, and that no effect has earned a name."""
    before = found.null_residual
    idle = [r for r in found.last_rivals if r.convinces(limits) and r not in found.vetoed]
    return [
        f"The calibrated scenario leaves {before.train_chi2_per_dof:.2f} per degree of freedom, no more than "
        f"campaigns like it without any missing effect ({before.limits.chi2_per_dof:.2f}; noise alone "
        f"{before.noise_per_dof:.2f})",
        f"{idle[0].hypothesis.label} gains {idle[0].gain_nats:.0f} nats, but takes too little of what is left to have "
        "a name"
        if idle
        else f"No plausible effect of the catalogue gains the {limits.evidence_nats:.0f} nats of evidence that a name "
        "needs, by both views of the model's own error, and holds on held-out data",
    ]


def _of_what_is_left(found: Attribution) -> list[str]:
    """What the calibrated scenario alone does not explain."""
    return [f"Without another effect {text}" for text in found.null_residual.reasons]


def _of_a_name(addition: Addition, limits: Thresholds, swallowed: bool = False) -> list[str]:
    """What a name gains, what explains the data as well as it does, and where its place is open.

    ``swallowed`` says that the model without it left its tolerances.
    """
    winner, within = addition.winner, limits.set_nats
    said = [
        f"Adding {winner.hypothesis.label} gains {winner.gain_nats:.0f} nats, {winner.lasting_nats:.0f} where "
        f"errors of the model last (a name needs {limits.evidence_nats:.0f} by both); {_held_out(addition, swallowed)}"
    ]
    # Of all that held-out data confirm the winner gains most: what gains more is not confirmed by them.
    others = [r for r in addition.equivalent if r.name != winner.name]
    ahead = {r.name: r.gain_nats for r in others if r.gain_nats > winner.gain_nats + within}
    # At one level a plain likeness stands beside a nonlinear name that is ahead of it by what depends on no level.
    met = winner.fit.chi2_per_dof < BIASED
    bent = met and not winner.hypothesis.linear
    plain = {
        r.name: winner.gain_nats - r.gain_nats
        for r in others
        if bent and r.hypothesis.linear and r.gain_nats < winner.gain_nats - within
    }
    said += [
        f"{name} meets the data, too, {nats:.0f} nats behind, and no level of force tells the two"
        for name, nats in plain.items()
    ]
    said += [
        f"{name} would gain {gain:.0f} nats, more than held-out data speak against it" for name, gain in ahead.items()
    ]
    # What held-out data put beside the winner, and fitted ones behind it.
    by_others = {
        r.name: winner.gain_nats - r.gain_nats
        for r in others
        if met and r.name not in plain and r.gain_nats < winner.gain_nats - within
    }
    said += [
        f"{name}, {nats:.0f} nats behind by the data that were fitted, is ahead with those held out"
        for name, nats in by_others.items()
    ]
    as_well = sorted({r.name for r in others} - {*ahead, *plain, *by_others})
    if as_well:
        what = (
            f"the data as well, within {within:.0f} nats"
            if met
            else "held-out data as well, within a tenth of what misses them"
        )
        said.append(f"{', '.join(as_well)} explain{'s' if len(as_well) == 1 else ''} {what}")
    beside = {e.name for e in addition.equivalent}
    said += [
        f"{r.name} in place of {winner.name} explains the data {_how_well(r, winner, within)}, beside all that was "
        "found"
        for r in addition.in_its_place[1:]
        if r.name not in beside
    ]
    said += [f"Its place is not determined: {where} it explains the data as well" for where in open_places(addition)]
    untold = untold_parameters(winner.fit, len(winner.fit.hypotheses) - 1)
    if untold:
        said.append(f"No record told {listed(untold)} of {winner.name}: nothing that is foretold depends on it")
    return said + _of_the_ratio((winner, *addition.equivalent))


def _of_few_stretches(problem: Problem) -> list[str]:
    """That a scenario may let less vary along its beams than its band can feel."""
    known = problem.scenario.tolerances
    asked = stations_for(problem.scenario, math.ceil(problem.measured.frequency_hz[-1]))
    if known.stations >= asked or not (known.stiffness_segment or known.mass_segment):
        return []
    return [
        f"[tolerances] of the scenario has segments = {known.stations}, where this band would have {asked} with none "
        "stated: stiffness and mass may scatter more finely along a beam than the calibration could follow"
    ]


def _held_out(addition: Addition, swallowed: bool) -> str:
    """What a name does to the held-out error; where that is nothing, that it is tolerances that are met again."""
    before, after = f"{addition.held_out_before:.2f}", f"{addition.winner.held_out:.2f}"
    if before != after:
        return f"held-out error goes from {before} to {after}"
    met = ": it is the tolerances that are met again, which had been left to meet the data" if swallowed else ""
    return f"held-out error stays at {after}{met}"


def _of_the_ratio(rivals: tuple[Rival, ...]) -> list[str]:
    """Of what multiplies all responses or the force, that it may be either."""
    return list(dict.fromkeys(ratio_words(r.name) for r in rivals if in_the_ratio(r.name, r.hypothesis.settings)))


def _of_the_unknown(found: Attribution) -> list[str]:
    """That nothing explains the data, what comes nearest, and what held-out data or its place speak against."""
    said = []
    if found.nameless is not None:
        said.append(f"One thing that has no name, {found.nameless.in_words}")
    if not found.null.converged:
        said.append("The calibration had not converged: some of what is left may be its own")
    said.append(
        "No plausible effect of the catalogue explains it with enough evidence, and holds on data that no fit has seen"
    )
    nearest = {r.name for a in found.leads for r in (a.winner, *a.alike)}
    if found.leads:
        labels = " with ".join(a.winner.hypothesis.label for a in found.leads)
        said.append(
            f"{labels} comes nearest: held-out error goes from {found.leads[0].held_out_before:.2f} to "
            f"{found.leads[-1].winner.held_out:.2f}; {why_no_name(found)}"
        )
        said += [text for lead in found.leads for text in beside_a_lead(lead)]
        said += _of_the_ratio(tuple(r for a in found.leads for r in (a.winner, *a.alike)))
    refused: dict[str, Rival] = {}
    for r in sorted(found.vetoed, key=lambda r: -r.gain_nats):
        # Of a lead, another variant may have been refused: that says nothing against it.
        if r.name not in nearest and not implausible(r.fit):
            refused.setdefault(r.name, r)
    said += [
        f"{r.hypothesis.label} would gain {r.gain_nats:.0f} nats, but {_AGAINST if r.held_out is not None else _NONE}"
        for r in list(refused.values())[:_TOLD]
    ]
    return said


def _of_the_implausible(found: Attribution) -> list[str]:
    """The best refused variant of each effect that is no plausible thing."""
    strange: dict[str, tuple[Rival, tuple[str, ...]]] = {}
    for r in sorted(found.vetoed, key=lambda r: -r.gain_nats):
        if r.name not in strange and (why := implausible(r.fit)):
            strange[r.name] = (r, why)
    return [
        f"{r.hypothesis.label} would gain {r.gain_nats:.0f} nats, but it is no plausible thing ({'; '.join(why)})"
        for r, why in list(strange.values())[:_TOLD]
    ]


def _of_one_at_rest(found: Attribution) -> list[str]:
    """What was named last and has lost its name, as no record shows it to be what it is called."""
    last = found.vetoed[0] if found.vetoed else None
    if last is None or last not in found.last_rivals or implausible(last.fit) or not rests(found.null.problem, last):
        return []
    return [f"{last.hypothesis.label} would gain {last.gain_nats:.0f} nats, but {why_at_rest(last)}"]


def _lasting_alone(found: Attribution, limits: Thresholds) -> list[str]:
    """The best variant of each effect that an error of the model would do as well as."""
    best: dict[str, Rival] = {}
    for r in sorted(found.last_rivals, key=lambda r: -r.gain_nats):
        if r.gain_nats >= limits.evidence_nats > r.lasting_nats and not implausible(r.fit):
            best.setdefault(r.name, r)
    return [
        f"{r.hypothesis.label} would gain {r.gain_nats:.0f} nats, but {r.lasting_nats:.0f} where an error of the model "
        f"lasts from line to line, as such errors do: a name needs {limits.evidence_nats:.0f}"
        for r in list(best.values())[:_TOLD]
    ]


def _how_well(r: Rival, winner: Rival, set_nats: float) -> str:
    """How well a rival explains the data against the winner, of which it is not behind."""
    ahead = r.gain_nats - winner.gain_nats
    return f"better, by {ahead:.0f} nats" if ahead > set_nats else f"as well, within {set_nats:.0f} nats"
