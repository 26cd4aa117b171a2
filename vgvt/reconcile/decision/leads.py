"""Names must take what is too much, end near the data, and be things that could be: what does not is a lead.

Nor may it live on the tolerances: what is missing was imitated by them, and a right name lets go of them.

Where the right effect is not in the catalogue another one nearly always takes something, and two more take something of
the rest. They are worth looking at, and no finding: what is missing is still unknown.
"""

from __future__ import annotations

from dataclasses import replace

from vgvt.reconcile.decision.as_at_rest import rests, shows_nothing_of_it, why_at_rest
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.backward import without_last
from vgvt.reconcile.decision.doubts import strained_too_much
from vgvt.reconcile.decision.exchanged import ahead_of
from vgvt.reconcile.decision.near_leads import with_nearly_as_near
from vgvt.reconcile.evidence.confirmation import share_taken, shares_taken
from vgvt.reconcile.evidence.plausible import implausible
from vgvt.reconcile.evidence.residual import Residual, residual
from vgvt.reconcile.evidence.strain import strain_sd
from vgvt.reconcile.question.thresholds import FAR_OFF, Thresholds

NEARLY_ALL = 0.9
"""What names take together of what was too much, where the data say that it is not all.

Of those that the study saw in part no true ones took less than 94 % of the misfit; of those that took less than this
one was true, of a pair.
"""
# What the tolerances may still have to give of what they had to without the names, where these meet the data: what is
# foretold of a large effect is wrong by a share of it, and they make up for that.
_LET_GO = 0.1


def as_leads(found: Attribution, thresholds: Thresholds) -> Attribution:
    """The same, with what was named as leads where it takes too little of what was too much, or is no plausible thing.

    Half for one name, three quarters for two, seven eighths for three: of the fitted data and what the tolerances had
    to give, and of held-out data where these are still missed; and nine tenths of the former where data are not met.
    However much they take, what is left may not be :data:`FAR_OFF`, nor may the tolerances have to give more than
    without the names, or far more than they may, unless the data are met and they have let go of nine tenths. What
    leaves no more than campaigns leave in which nothing is missing keeps its name. What is no plausible thing, or
    nothing that the data could show to be it (:mod:`vgvt.reconcile.decision.as_at_rest`), keeps none, whatever it
    leaves; what was named before it does without it.
    """
    if not found.rounds:
        return found
    rounds, final, problem = list(found.rounds), found.final, found.null.problem
    while rounds and (implausible(final) or shows_nothing_of_it(problem, rounds[-1])):
        rounds, final, _ = without_last(rounds, found.null)
    if not rounds or any(implausible(final, k) or shows_nothing_of_it(problem, a) for k, a in enumerate(rounds)):
        return demoted(found)
    if len(rounds) < len(found.rounds):
        dropped = found.rounds[len(rounds) :]
        found = replace(
            found, rounds=tuple(rounds), final=final, final_residual=residual(final, thresholds),
            last_rivals=dropped[0].rivals, vetoed=(*(r.winner for r in dropped), *found.vetoed),
        )  # fmt: skip
    enough, after = 1 - 0.5 ** len(found.rounds), found.final_residual
    far = after.limits.far_off(found.final.chi2_per_dof, after.held_out_chi2_per_dof)
    met = after.limits.met_by(found.final.chi2_per_dof, after.held_out_chi2_per_dof)
    leant = leant_on_more(after.strain_sd, found.null_residual)
    leant = leant or leant_on_far(after.strain_sd, found.null_residual, met=met)
    taken = min(shares(found)) >= enough and (after.met or takes_nearly_all(found))
    if after.adequate or (taken and not far and not leant):
        return found
    return demoted(found)


def takes_nearly_all(found: Attribution) -> bool:
    """Whether names take nine tenths of what was too much, of the fitted data and of what the tolerances had to give.

    Where something else explains what they leave they are not what is there: several effects may be, but of one that
    no catalogue holds its relatives take a part, and were named in the study far more often.
    """
    return shares(found)[0] >= NEARLY_ALL


def leant_on_more(strain: float, without: Residual) -> bool:
    """Whether names lean on the tolerances by more than campaigns in which nothing is missing, and than no name did.

    ``strain`` is by how many standard deviations they do, ``without`` what is left without them.
    """
    return strain > max(without.limits.strain_sd, without.strain_sd)


def leant_on_far(strain: float, without: Residual, *, met: bool) -> bool:
    """Whether names lean on the tolerances far more than campaigns do in which nothing is missing.

    ``strain`` is by how many standard deviations they do, ``without`` what is left without them. Where the data are
    ``met`` a tenth of what the tolerances had to give without the names is not far.
    """
    return strain > FAR_OFF * without.limits.strain_sd and not (met and strain <= _LET_GO * without.strain_sd)


def why_no_name(found: Attribution) -> str:
    """Why leads are no names, in words."""
    if found.nameless is not None and found.nameless.instead_of:
        return "what one thing that has no name does without is a lead"
    if found.still is not None:
        return (
            f"beside all of them a {found.still.words} that is smooth over frequency would still explain "
            f"{found.still.nats:.0f} nats more than chance does: pieces of one thing that has no name leave such a rest"
        )
    led = found.led
    strange = [f"{h.name} with {w}" for k, h in enumerate(led.hypotheses) for w in implausible(led, k)] if led else []
    if strange:
        return f"{'; '.join(strange)}: that is no plausible thing, and imitates one that is not in the catalogue"
    if led and found.null_residual.limits.far_off(led.chi2_per_dof, led.held_out_chi2_per_dof):
        return f"what leaves more than {FAR_OFF:.0f} times what may be left is a lead, however much it takes"
    if led and leant_on_more(strain := strain_sd(led), found.null_residual):
        return (
            f"with it the tolerances give more than without ({strain:.1f} standard deviations beyond chance, "
            f"{found.null_residual.strain_sd:.1f} before): what takes from them what it gives the data is a lead"
        )
    met = led is not None and found.null_residual.limits.met_by(led.chi2_per_dof, led.held_out_chi2_per_dof)
    if led and leant_on_far(strain := strain_sd(led), found.null_residual, met=met):
        return (
            f"what leaves the tolerances to give {strain:.0f} standard deviations beyond chance, more than "
            f"{FAR_OFF:.0f} times what they may, is a lead"
        )
    resting = [a.winner for a in found.leads if rests(found.null.problem, a.winner)]
    if resting:
        return "; ".join(map(why_at_rest, resting))
    taken = share_taken(led, found.null, found.null_residual) if led else 0.0
    if 1 - 0.5 ** len(found.leads) <= taken < NEARLY_ALL:
        return (
            f"what takes {100 * taken:.0f} % of what is too much, and not {100 * NEARLY_ALL:.0f}, where something "
            "else is left that is more than noise, is a lead"
        )
    return "what does not halve what is too much with every name is a lead"


def strange_names(found: Attribution) -> frozenset[str]:
    """Effects that are no plausible thing in the final model."""
    final = found.final
    return frozenset(h.name for k, h in enumerate(final.hypotheses) if implausible(final, k))


def does_without(found: Attribution, without: Attribution, within_nats: float) -> bool:
    """Whether a search ``without`` what was no plausible thing names plausible ones that explain the data as well.

    Beside a second effect an absorber far above the band may gain more than the mass that is there: only the two
    together show that the mass does as well. And where they leave no more than campaigns leave in which nothing is
    missing, nothing is left for what could not be to explain: how far it bends to the last of it is no matter.
    """
    reached = ahead_of(found.null, without.final, [found.final], within_nats) is None
    met = without.final_residual.adequate and not strained_too_much(without.final)
    return bool(without.rounds) and (reached or met) and not strange_names(without)


def telling(found: Attribution, without: Attribution) -> Attribution:
    """The search ``without`` what was no plausible thing, with that among what was refused: it is not to be hidden."""
    strange = tuple(a.winner for a in found.rounds if implausible(a.winner.fit))
    return replace(without, vetoed=(*strange, *without.vetoed))


def demoted(found: Attribution) -> Attribution:
    """The same with every name a lead, and the model without effects at the end; no leads where nothing is missing."""
    bare = replace(found, rounds=(), final=found.null, final_residual=found.null_residual)
    if not found.null_residual.adequate or strained_too_much(found.null):
        return led_by_all(found)
    # What the first round asked is what stood between these data and a name; what could not be was refused one.
    problem = found.null.problem
    strange = tuple(a.winner for a in found.rounds if implausible(a.winner.fit) or shows_nothing_of_it(problem, a))
    rivals = found.rounds[0].rivals if found.rounds else found.last_rivals
    return replace(bare, last_rivals=rivals, vetoed=(*strange, *found.vetoed))


def led_by_all(found: Attribution) -> Attribution:
    """The same with every name a lead, and the model without effects at the end."""
    bare = replace(found, rounds=(), final=found.null, final_residual=found.null_residual)
    return replace(bare, leads=tuple(map(with_nearly_as_near, found.rounds)), led=found.final)


def shares(found: Attribution) -> tuple[float, float]:
    """What the final model takes of what was too much without its effects: of the fit, and of held-out data.

    The second is 1 where held-out data are met, or nothing is held out.
    """
    return shares_taken(found.final, found.null, found.final_residual.held_out_chi2_per_dof, found.null_residual)
