"""Effects too large for any tangent, looked for where the calibration has not been yet: at the stated values.

A root that gives way by a fifth of its wing moves peaks by many widths. Unknowns that had to imitate it stand tens of
standard deviations away, and nothing that is small there leads back. At the stated values a few sizes of every effect
are compared by log magnitudes, which have no local minimum at every pair of peaks; the best are brought near by a fit.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.action import NOTHING
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.fitting.rough_start import log_distance, nearest
from vgvt.reconcile.prediction.grouping import NoStructureError, effects_at, run_actions
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.level_grid import depends_on_level
from vgvt.reconcile.search.scan import in_band, start_values
from vgvt.reconcile.search.screened import Screened
from vgvt.reconcile.work.progress import Progress, naming, part
from vgvt.reconcile.work.team import ALONE, Task, Team

Array = NDArray[np.float64]
# How far from the data, with which effect, at which scores.
_Reached = tuple[float, Hypothesis, Array]
BENT = 10.0
"""Standard deviations of an unknown from which on a calibration stands for something else."""
# Of a logarithmic range, and of one about its neutral value: small sizes are in sight of a tangent.
_LARGE, _EITHER_SIDE = (0.55, 0.75, 0.95), (0.05, 0.3, 0.7, 0.95)
# Sizes of a joint whose stiffness depends on level, and its other values.
_BENDING, _HELD = (0.35, 0.6), (0.3, 0.55, 0.8)
# More sizes than this a coarse look does not afford.
_MOST_SIZES, _MOST_POINTS = 2, 20
# An effect that stands out leaves no more than this share of the distance; so many are brought near.
_STANDS_OUT, _STARTED = 0.8, 4
# Variants that line searches are made for, of one effect and in all.
_OF_ONE, _SEARCHED = 3, 12
_NEARER = ((0.6, 6),)
# Of the least plausible size: as good as none.
_HARDLY = 0.1


def bent(current: Fit) -> bool:
    """Whether a calibration had to move something so far that it stands for something else."""
    return bool(np.abs(current.u).max(initial=0.0) > BENT)


def from_stated(
    current: Fit, hypotheses: Sequence[Hypothesis], tell: Progress, team: Team = ALONE
) -> tuple[Screened, ...]:
    """Starts of the effects that come nearest to the data from the stated values, best first, one of each effect.

    Looked at is what acts in all runs alike and has no place: places have their own scan, changes between runs no
    cause to bend a calibration that all runs share. Of what has no size, as a sign, phases are looked at.
    """
    plain = _distance(current, (), np.zeros(0))
    # Variants of one effect cost alike, and follow each other.
    shares: list[Task] = [(_nearest_sizes, (current, hypotheses[k :: team.workers])) for k in range(team.workers)]
    together = itertools.zip_longest(*team.work_off(shares, part(tell, 0.0, 0.5)))
    reached = [f for one in together for f in one if f is not None and f[0] < _STANDS_OUT * plain]
    found = _first_of_each(sorted(reached, key=lambda f: f[0]), _OF_ONE)[:_SEARCHED]
    searched = team.work_off([(_overlapping, (current, h, e)) for _, h, e in found], part(tell, 0.5, 0.8))
    best = _first_of_each(sorted((s for s in searched if s is not None), key=lambda s: s[0]), 1)[:_STARTED]
    starts = team.work_off([(_brought_near, (current, h, scores)) for _, h, scores in best], part(tell, 0.8, 1.0))
    return tuple(sorted((s for s in starts if s is not None), key=lambda s: s.remaining))


def _nearest_sizes(current: Fit, hypotheses: Sequence[Hypothesis], tell: Progress) -> list[_Reached | None]:
    """Of every hypothesis the size that comes nearest from the stated values; None where it is not looked at."""
    found: list[_Reached | None] = []
    for k, hypothesis in enumerate(hypotheses):
        tell(k / len(hypotheses), f"from the stated values {hypothesis.name}")
        if not hypothesis.parameters:
            found.append(_by_phases(current, hypothesis))
            continue
        reached = [(_distance(current, (hypothesis,), e), hypothesis, e) for e in _sizes(current, hypothesis)]
        found.append(min(reached, key=lambda r: r[0], default=None))
    return found


def _by_phases(current: Fit, hypothesis: Hypothesis) -> _Reached | None:
    """How near what is there or not brings the phases, as if magnitudes came as much nearer.

    A gauge the wrong way round leaves every magnitude as it is. From the stated values phases tell it at once; a
    calibration has turned the aircraft round until they are met.
    """
    turned = [_out_of_phase(current, given) for given in ((), (hypothesis,))]
    if not math.isfinite(turned[1]) or turned[0] <= 0:
        return None
    return _distance(current, (), np.zeros(0)) * turned[1] / turned[0], hypothesis, np.zeros(0)


def _overlapping(current: Fit, hypothesis: Hypothesis, e: Array, tell: Progress) -> _Reached | None:
    """How near line searches bring an effect, and to which scores; None where there is no such aircraft."""
    tell(0.0, f"peaks overlap with {hypothesis.name}")
    try:
        u, scores, left = nearest(current.problem, (*current.hypotheses, hypothesis), np.concatenate([current.e, e]))
    except NoStructureError:
        return None
    return left, hypothesis, np.concatenate([u, scores])


def _brought_near(current: Fit, hypothesis: Hypothesis, start: Array, tell: Progress) -> Screened | None:
    """An effect fitted coarsely from some scores; None where there is no such aircraft."""
    u, scores = np.split(start, [current.u.size])
    told = naming(tell, hypothesis)
    try:
        near = fit(current.problem, (*current.hypotheses, hypothesis), u, scores, _NEARER, told, judged=_NEARER[-1][0])
    except NoStructureError:
        return None
    values = {name: value[0] for name, value in near.values(len(current.hypotheses)).items()}
    known = near.scores[: current.scores.size]
    return Screened(hypothesis, values, 0.5 * current.chi2, remaining=near.chi2, start=known)


def _first_of_each(found: Sequence[_Reached], most: int) -> list[_Reached]:
    """The first few of every effect, in their order."""
    kept: list[_Reached] = []
    for f in found:
        if sum(1 for k in kept if k[1].name == f[1].name) < most:
            kept.append(f)
    return kept


def _sizes(current: Fit, hypothesis: Hypothesis) -> list[Array]:
    """Scores (parameters,) of some large sizes of an effect; none where it is not looked at."""
    sizes = [p for p in hypothesis.parameters if p.neutral is not None]
    if not sizes or len(sizes) > _MOST_SIZES or "x_m" in hypothesis.settings:
        return []
    if depends_on_level(current.problem, hypothesis):
        choices = [[p.at(x) for x in (_HELD if p.neutral is None else _BENDING)] for p in hypothesis.parameters]
    elif swinging := in_band(current.problem, hypothesis):
        return [hypothesis.scores(values) for values in swinging]
    else:
        choices = [
            [float(p.neutral or 0.0), *(p.at(x) for x in (_LARGE if p.scale == "log" else _EITHER_SIDE))] for p in sizes
        ]
        rest = start_values(hypothesis)
        choices = [choices[sizes.index(p)] if p in sizes else [rest[p.name]] for p in hypothesis.parameters]
    names = [p.name for p in hypothesis.parameters]
    points = [dict(zip(names, values, strict=True)) for values in itertools.product(*choices)]
    points = [v for v in points if any(v[p.name] != p.neutral for p in sizes)]
    if len(points) > _MOST_POINTS or not _holds_for_all_runs(current, hypothesis, points[-1]):
        return []
    return [hypothesis.scores(_no_zeros(hypothesis, v)) for v in points]


def _no_zeros(hypothesis: Hypothesis, values: dict[str, float]) -> dict[str, float]:
    """Values that have a logarithm where their scale asks for one: a share of the least plausible size for none."""
    return {
        p.name: max(values[p.name], _HARDLY * p.low) if p.scale == "log" else values[p.name]
        for p in hypothesis.parameters
    }


def _holds_for_all_runs(current: Fit, hypothesis: Hypothesis, values: dict[str, float]) -> bool:
    """Whether an effect changes the rig, and in all runs alike."""
    made = effects_at(current.problem, (hypothesis,), hypothesis.scores(_no_zeros(hypothesis, values)))
    if made is None:
        return False
    try:
        runs = len(current.problem.measured.runs)
        acts = [actions[-1] for _, actions in run_actions(current.problem.scenario, made, runs)]
    except ValueError:
        return False
    return not acts[0].same_rig(NOTHING) and all(acts[0].same_rig(other) for other in acts[1:])


def _out_of_phase(current: Fit, hypotheses: tuple[Hypothesis, ...]) -> float:
    """Mean of 1 - cos of the angle between model and data with the unknowns as stated; infinite for no aircraft."""
    problem, e, keep = current.problem, current.e, current.problem.split.train
    u = np.zeros(problem.size)
    try:
        here = anchor(problem, u, (*current.hypotheses, *hypotheses), e, slopes=False)
    except NoStructureError:
        return math.inf
    ratio = here.predict(u, e, ended=False)[keep] / problem.measured.values[keep]
    return float(np.mean(1 - ratio.real / np.abs(ratio)))


def _distance(current: Fit, hypotheses: tuple[Hypothesis, ...], e: Array) -> float:
    """Mean square of log|model/data| with the unknowns as stated; infinite where there is no such aircraft."""
    problem, scores = current.problem, np.concatenate([current.e, e])
    u = np.zeros(problem.size)
    try:
        here = anchor(problem, u, (*current.hypotheses, *hypotheses), scores, slopes=False)
        return log_distance(problem, here.predict(u, scores, ended=False))
    except NoStructureError:
        return math.inf
