"""Which variants a round fits: the best of the screen, and where much is left, from stands that forgive more."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vgvt.reconcile.evidence.localise import Place, localise
from vgvt.reconcile.evidence.residual import Residual
from vgvt.reconcile.fitting.fit import FORGIVING, Fit, fit
from vgvt.reconcile.fitting.rough_start import rough_start
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.level_grid import depends_on_level
from vgvt.reconcile.search.candidates import freed
from vgvt.reconcile.search.closer_look import SLOTS, held
from vgvt.reconcile.search.from_stated import bent, from_stated
from vgvt.reconcile.search.likeness import beside_likeness
from vgvt.reconcile.search.scan import BY_ITSELF_M, tuned_to
from vgvt.reconcile.search.screen import WORTH_CHECKING, joined, screen, sizing
from vgvt.reconcile.search.screened import Screened
from vgvt.reconcile.search.upright import upright
from vgvt.reconcile.work.progress import Progress, part, silent
from vgvt.reconcile.work.team import ALONE, Task, Team

_SHORT_LIST, _A_FAMILY, _BEHIND = 6, 2, 2
BIASED = 1.5
"""Beyond this chi² per degree of freedom a calibration has swallowed part of what it should leave."""
_SHORT, _NEAREST, _BEST = ((0.6, 4), (0.1, 5)), 4, 2
_COARSE = ((0.6, 4), (0.1, 8))
# Of the evidence that a name needs, this share must be in sight of the screen: a fit that frees a place, a frequency or
# a damping may find the rest, one that only settles sizes finds what the closed form says.
_OPEN, _SETTLED = 0.25, 0.75


def swallowed(current: Fit, before: Residual) -> bool:
    """Whether a calibration has taken over part of what it should leave: it misses much, or stands for something else.

    A mass of 100 g on a wing was met to 1.3 per degree of freedom by 18 deviations of the wing's own.
    """
    return before.train_chi2_per_dof >= BIASED or bent(current)


def shortened(
    current: Fit,
    left: Sequence[Hypothesis],
    before: Residual,
    needed: float,
    tell: Progress,
    team: Team = ALONE,
    *,
    afar: bool,
    again: bool = False,
) -> tuple[Screened, ...]:
    """The short list of a round; from ``afar`` some of it from a stand that still forgives misplaced peaks.

    A calibration that had to swallow an effect is biased and hides it: its tangent does not reach back to the truth.
    Judged by a coarse relative error, scores stay near their priors and the same effect stands out.

    Where all tolerances together lean on something, a calibration that may not bend is asked, too.
    Asked ``again`` in a round, it leaves out the look that does not hang on where the calibration stands.
    """
    if not afar:
        found = screen(current, left, part(tell, 0.0, 0.6), least_nats=_OPEN * needed, team=team)
        listed = short_list(found, _SHORT_LIST, needed=needed, strained=_strained(current, needed))
        if again or current.hypotheses or before.strain_sd <= before.limits.strain_sd:
            return listed
        # Tolerances lean on something: from where they lean it is hidden, and what is in sight is what they make of it.
        behind = _upright(current, None, left, part(tell, 0.6, 1.0))
        return (*listed, *short_list(behind, _SHORT_LIST // 2, forgiving=True))
    straight, others = _asked(current, left, left, part(tell, 0.0, 0.2), team)
    # Where the data are met what stands where the unknowns are bent is as good as hidden. Where they are not, what
    # bends unknowns before anything has a name may still be what they imitate worst.
    met, first = before.train_chi2_per_dof < BIASED, not current.hypotheses and not again
    beside = first and not met and bent(current)
    far, near, behind = _looks(current, straight, part(tell, 0.2, 0.9), team, met=met, beside=beside)
    # A bent calibration still says where the force comes from; a forgiving one has its peaks in the wrong places.
    place = next((p for p in localise(current, everywhere=False).places if p.position_m is not None), None)
    spot = None if place is None else place.position_m
    chosen = [] if place is None else _swinging(current, far, place)
    listed = short_list(far, _SHORT_LIST, forgiving=True)
    chosen += _at_best_places(current, far, listed, spot, part(tell, 0.9, 1.0), team)
    closest = short_list(near, _SHORT_LIST // 2, forgiving=True)
    if closest and not met:
        closest = (replace(closest[0], foremost=True), *closest[1:])
    seen = (*closest, *short_list(behind, _BEHIND, forgiving=True))
    return (*chosen, *(s for found in others for s in found), *seen)


def _looks(
    current: Fit,
    left: Sequence[Hypothesis],
    tell: Progress,
    team: Team,
    *,
    met: bool,
    beside: bool,
) -> tuple[tuple[Screened, ...], tuple[Screened, ...], tuple[Screened, ...]]:
    """What is in sight from a calibration that still forgives misplaced peaks; from near by; and of what may not bend.

    Near by is where the calibration stands, or where the data are ``met`` one that may not bend; otherwise that is the
    third look, where it is asked for ``beside`` the second.
    """
    near = [] if met else sizing(current, left, team)
    forgiving, *shares = team.work_off([(_forgiving, (current,)), *near], part(tell, 0.0, 0.4))
    stiff: list[Task] = [(_upright, (current, forgiving, left))] if met or beside else []
    found = team.work_off([*stiff, *sizing(forgiving, left, team)], part(tell, 0.4, 0.8))
    behind = found[0] if stiff else ()
    looks: list[Task] = [(held, (forgiving, joined(found[len(stiff) :]), WORTH_CHECKING, SLOTS))]
    if not met:
        looks.append((held, (current, joined(shares), WORTH_CHECKING, _SHORT_LIST - 1)))
    far, *closer = team.work_off(looks, part(tell, 0.8, 1.0))
    return far, closer[0] if closer else behind, behind if beside else ()


def _upright(current: Fit, forgiving: Fit | None, left: Sequence[Hypothesis], tell: Progress) -> tuple[Screened, ...]:
    """What is in sight from a calibration that may not bend; where there is none, from where it stands."""
    try:
        return upright(current, _forgiving(current) if forgiving is None else forgiving, left, tell)
    except NoStructureError:
        return screen(current, left, tell, slots=_SHORT_LIST - 1)


def _forgiving(current: Fit, tell: Progress = silent) -> Fit:
    """The model calibrated again from its stated values, or from where peaks overlap, by a coarse relative error."""
    u, e, stages = np.zeros(current.u.size), current.e, _COARSE
    if bent(current):
        # Less forgiveness would bend it again.
        (u, e), stages = rough_start(current.problem, current.hypotheses, current.e), FORGIVING
    judged = stages[-1][0]
    try:
        return fit(current.problem, current.hypotheses, u, e, stages, tell, judged=judged)
    except NoStructureError:
        # With what was named the stated aircraft does not hang: from where it does, then.
        return fit(current.problem, current.hypotheses, current.u, current.e, stages, tell, judged=judged)


def _strained(current: Fit, needed: float) -> bool:
    """Whether a calibration moved what is uncertain so far that an effect might get its name by taking it back.

    Scores that nothing strains have a square of one each at most.
    """
    return 0.5 * (float(current.scores @ current.scores) - current.scores.size) > needed


def short_list(
    screened: Sequence[Screened],
    count: int,
    *,
    needed: float = 1.0,
    forgiving: bool = False,
    strained: bool = False,
) -> tuple[Screened, ...]:
    """The best variants, at most two of an effect, that a fit could take to the nats ``needed``.

    From a ``strained`` calibration the closed form sees but the beginning of the way back.
    """
    chosen: list[Screened] = []
    for s in screened:
        same = sum(1 for c in chosen if c.hypothesis.name == s.hypothesis.name)
        # Every place of a placed effect is tried where its fit starts from afar: one start is enough.
        most = 1 if forgiving and "x_m" in s.hypothesis.settings else _A_FAMILY
        settled = all(p.neutral is not None for p in freed(s.hypothesis).parameters)
        worth = (_SETTLED if settled and not strained else _OPEN) * needed
        if s.visible and s.gain_nats > worth and same < most and len(chosen) < count:
            chosen.append(s)
    return tuple(chosen)


def second_list(
    current: Fit,
    left: Sequence[Hypothesis],
    first: Sequence[Hypothesis],
    needed: float,
    tell: Progress,
    team: Team = ALONE,
) -> tuple[Screened, ...]:
    """Of what is asked for after the ``first``, the few that promise most where the calibration stands, or far off."""
    straight, others = _asked(current, left, first, part(tell, 0.0, 0.5), team)
    near = screen(current, straight, part(tell, 0.5, 1.0), least_nats=_OPEN * needed, team=team)
    return (*(s for found in others for s in found), *short_list(near, _SHORT_LIST // 2, needed=needed))


def _asked(
    current: Fit, left: Sequence[Hypothesis], known: Sequence[Hypothesis], tell: Progress, team: Team
) -> tuple[list[Hypothesis], list[tuple[Screened, ...]]]:
    """What tangents are asked of, and the large effects that stand out, where a calibration is bent.

    What a joint whose stiffness depends on level does beside unknowns that imitate it says nothing: it is begun beside
    what of the ``known`` resembles it. And what is as large as that stands out before anything has a name.
    """
    if not bent(current):
        return list(left), []
    joints = [h for h in left if depends_on_level(current.problem, h)]
    straight = [h for h in left if h not in joints]
    if current.hypotheses:
        return straight, []
    found = [from_stated(current, left, part(tell, 0.0, 0.7), team)]
    if joints:
        found.append(beside_likeness(current, joints, known, part(tell, 0.7, 1.0), team))
    return straight, found


def _at_best_places(
    current: Fit,
    screened: Sequence[Screened],
    chosen: Sequence[Screened],
    spot: tuple[float, float, float] | None,
    tell: Progress,
    team: Team,
) -> list[Screened]:
    """Of each placed effect that is chosen the best of its variants, by short fits that forgive misplaced peaks.

    Each with what it arrived at; the rest as they are.
    """
    tried = [_placed(screened, s, spot) for s in chosen]
    tasks: list[Task] = [(_fitted_at, (current, s)) for same in tried for s in same]
    reached = iter(team.work_off(tasks, tell))
    found: list[Screened] = []
    for s, same in zip(chosen, tried, strict=True):
        fits = [f for f in itertools.islice(reached, len(same)) if f is not None]
        found.append(max(fits, key=lambda f: f[0])[1] if fits else s)
    return found


def _placed(
    screened: Sequence[Screened], chosen: Screened, spot: tuple[float, float, float] | None
) -> Sequence[Screened]:
    """The best variants of a placed effect, and those next to ``spot`` (x, y, z), where a free force explains most.

    None of an effect that has no place.
    """
    if "x_m" not in chosen.hypothesis.settings:
        return ()
    same = [c for c in screened if c.hypothesis.name == chosen.hypothesis.name]
    if spot is None:
        return same[: _BEST + _NEAREST]
    x, y, _ = spot
    return [*same[:_BEST], *sorted(same[_BEST:], key=lambda s: _distance(s, x, y))[:_NEAREST]]


def _fitted_at(current: Fit, s: Screened, tell: Progress) -> tuple[float, Screened] | None:
    """Evidence of a variant after a short fit, and the variant at what it arrived at; None where it cannot be."""
    tell(0.0, f"places of {s.hypothesis.name}")
    # Its frequency is what the screen knows best; where it sits, a biased calibration has smeared.
    start, hypotheses = np.concatenate([current.e, s.hypothesis.scores(s.values)]), (*current.hypotheses, s.hypothesis)
    try:
        near = fit(current.problem, hypotheses, np.zeros(current.u.size), start, _SHORT, judged=_SHORT[-1][0])
    except NoStructureError:
        return None
    here = {k: v[0] for k, v in near.values(len(current.hypotheses)).items()}
    return near.evidence_nats, replace(s, values=here, start=near.scores[: current.scores.size])


def _swinging(current: Fit, screened: Sequence[Screened], place: Place) -> list[Screened]:
    """What swings where and as fast as the residual itself shows, from the prior's middle: placed effects put there.

    And those that sit there by themselves, as near as a bent calibration knows a place. A screen from such a
    calibration passes over what is sharp.
    """
    if place.type != "resonant" or place.position_m is None:
        return []
    x, y, _ = place.position_m
    start = np.concatenate([np.zeros(current.u.size), current.e])
    found: list[Screened] = []
    for s in sorted((s for s in screened if "x_m" in s.hypothesis.settings), key=lambda s: _distance(s, x, y)):
        tuned = {p.name: place.size for p in s.hypothesis.parameters if p.unit == "Hz"}
        if tuned and s.hypothesis.name not in {f.hypothesis.name for f in found}:
            here = replace(s.hypothesis, settings={**s.hypothesis.settings, "x_m": x, "y_m": y})
            found.append(replace(s, hypothesis=here, values=tuned, start=start))
    own: list[tuple[float, Screened]] = []
    for s in (s for s in screened if "x_m" not in s.hypothesis.settings):
        known = tuned_to(current.problem, s.hypothesis, place.size)
        if known is not None:
            values, there = known
            away = min(float(np.hypot(there_x - x, there_y - y)) for there_x, there_y in there)
            own.append((away, replace(s, values=values, start=start)))
    for away, s in sorted(own, key=lambda o: o[0]):
        if away < BY_ITSELF_M and s.hypothesis.name not in {f.hypothesis.name for f in found}:
            found.append(s)
    return found


def _distance(s: Screened, x_m: float, y_m: float) -> float:
    """How far a placed variant is from a point, in metres."""
    settings = s.hypothesis.settings
    return float(np.hypot(settings["x_m"] - x_m, settings["y_m"] - y_m))
