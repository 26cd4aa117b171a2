"""The nine steps in order: from a measured campaign and a nominal scenario to a verdict."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from pathlib import Path

from vgvt.data import Campaign
from vgvt.effects.registry import available_effects
from vgvt.reconcile.checkpoint import provenance_of
from vgvt.reconcile.decision.beyond_names import asked_beyond_names
from vgvt.reconcile.decision.kinds import Kind, kind_of
from vgvt.reconcile.decision.leads import as_leads
from vgvt.reconcile.decision.nameless_instead import set_against_nameless
from vgvt.reconcile.decision.nameless_told import nameless_told
from vgvt.reconcile.decision.reasons import reasons_of
from vgvt.reconcile.decision.relatives import words_of_relatives
from vgvt.reconcile.decision.told import with_told_parameters
from vgvt.reconcile.decision.turned import counts_instead, turned, words_of_turn
from vgvt.reconcile.decision.undecided import next_best, undecided, words_of_the_rest
from vgvt.reconcile.decision.verdict import Verdict, leads_of, named_effects
from vgvt.reconcile.evidence.localise import localise
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import FAR
from vgvt.reconcile.next_test.suggest import Suggestion, suggest, words_of_none
from vgvt.reconcile.outcome.augment import augment, write_reconciled
from vgvt.reconcile.outcome.resimulate import resimulated
from vgvt.reconcile.question.arguments import check_effects
from vgvt.reconcile.question.figures_of_merit import compare
from vgvt.reconcile.question.problem import make_problem
from vgvt.reconcile.question.thresholds import Thresholds, thresholds_for
from vgvt.reconcile.search.candidates import some_candidates
from vgvt.reconcile.searches import Searches
from vgvt.reconcile.work.one_thread import one_thread
from vgvt.reconcile.work.progress import part
from vgvt.scenario.model import Scenario

Progress = Callable[[float, str, float | None], None]
_CALIBRATED, _ATTRIBUTED, _TURNED, _LOCALISED = 0.07, 0.85, 0.92, 0.97


@one_thread
def reconcile(
    campaign: Campaign,
    scenario: Scenario,
    *,
    effects: Mapping[str, type] | None = None,
    thresholds: Thresholds | None = None,
    floor: float | None = None,
    lines: int = 500,
    folder: Path | str | None = None,
    most: int = 3,
    workers: int = 1,
    with_tests: bool = True,
    progress: Progress | None = None,
) -> Verdict:
    """Trace what a scenario does not explain of a campaign to effects of the catalogue, or say that none does.

    ``effects`` by name are the hypotheses (default: all that are installed); ``floor`` the relative model-form
    error (default: the scenario's tolerance); ``folder`` takes ``reconciled.toml``, the derivatives that a second
    call can use again, and each round, so that a call that was broken off goes on.
    ``progress(fraction, message, seconds_left)``; ``workers`` processes share the work and change nothing but the time;
    each does linear algebra in one thread, whatever the environment says.
    Without ``with_tests`` no test is suggested that would tell an ambiguous answer apart: a quarter of the time then.
    Nothing here is random but the hold-out split, which follows from the scenario's seed: the same call gives the same
    verdict. Where the fit meets its own data and only those held out are missed, another hold-out is tried: what
    happened to them alone no fit could name. InputError where the campaign could show no variant of any effect.
    """
    if effects is not None:
        check_effects(effects)
    folder = None if folder is None else Path(folder)
    tell = _Clock(progress)
    tell(0.0, "read the campaign")
    problem = make_problem(
        campaign, scenario, floor=floor, lines=lines, cache=None if folder is None else folder / "cache"
    )
    limits = thresholds_for(problem, thresholds)
    hypotheses = some_candidates(problem, effects)
    null = calibrate(problem, progress=lambda f, m: tell(0.02 + (_CALIBRATED - 0.02) * f, m))
    origin = provenance_of(campaign, scenario, {h.name: h.cls for h in hypotheses}, limits, lines)
    searches = Searches(hypotheses, limits, most, workers, folder, origin, (floor,))
    first = searches.made(null, "rounds", part(tell, _CALIBRATED, _ATTRIBUTED))
    found = as_leads(first, limits)
    said: tuple[str, ...] = ()
    other = turned(first)
    if other is not None:
        tell(_ATTRIBUTED, "another hold-out")
        start = calibrate(other, first.null.u, stages=FAR)
        again = as_leads(searches.made(start, "rounds-turned", part(tell, _ATTRIBUTED, _TURNED)), limits)
        if counts_instead(found, again):
            found, said = again, (words_of_turn(first, other),)
    found = with_told_parameters(found, limits, lambda f, m: tell(_TURNED, m), workers)
    against = set_against_nameless(found, limits, lambda f, m: tell(_TURNED, m), workers)
    if against.nameless is None:
        found = nameless_told(asked_beyond_names(found, limits), limits, lambda f, m: tell(_TURNED, m), workers)
    else:
        found = with_told_parameters(against, limits, lambda f, m: tell(_TURNED, m), workers)
    measured, parts = problem.measured, found.null.problem.split
    kind = kind_of(found)
    places = None
    if kind is not Kind.ADEQUATE:
        at = found.final if kind is not Kind.EXPLAINED else found.null
        places = localise(at, lambda f, m: tell(_TURNED + (_LOCALISED - _TURNED) * f, m))
    tests, relatives = tuple[Suggestion, ...](), tuple[str, ...]()
    if kind is Kind.AMBIGUOUS and with_tests:
        tell(_LOCALISED, "compare tests")
        tests = suggest(undecided(found)) or suggest(next_best(found), levels_alone=True)
        said += (*words_of_none(tests, limits.set_nats), *words_of_the_rest(found))
    if kind in (Kind.EXPLAINED, Kind.AMBIGUOUS):
        offered = available_effects() if effects is None else effects
        relatives = words_of_relatives(found, offered, {h.name for h in hypotheses})
    tell(_LOCALISED, "simulate what was found")
    augmented = augment(scenario, found)
    verdict = Verdict(
        kind, (*said, *reasons_of(kind, found, limits, places), *relatives), named_effects(found), leads_of(found),
        found.final_residual.reasons,
        compare(found.null.foretold, measured, parts),
        compare(found.final.foretold, measured, parts),
        tests, found, places, limits, augmented,
        resimulated(augmented, found.final, limits, part(tell, _LOCALISED, 1.0)),
    )  # fmt: skip
    if folder is not None:
        write_reconciled(folder / "reconciled.toml", verdict, origin)
    tell(1.0, kind.value)
    return verdict


class _Clock:
    """Passes progress on with the seconds that are left at the pace so far."""

    def __init__(self, progress: Progress | None) -> None:
        self._progress, self._start = progress, time.perf_counter()

    def __call__(self, fraction: float, message: str) -> None:
        """Report a fraction done."""
        if self._progress is None:
            return
        spent = time.perf_counter() - self._start
        self._progress(fraction, message, spent * (1 - fraction) / fraction if fraction > 0.02 else None)
