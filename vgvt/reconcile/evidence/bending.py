"""Whether a campaign shows that an effect depends on the level of force, or only that it is there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.fitting.misfit import data_misfit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.level_grid import several_levels
from vgvt.reconcile.question.thresholds import Thresholds

if TYPE_CHECKING:
    from vgvt.reconcile.evidence.rivals import Rival


def straightened(confirmed: Sequence[Rival], set_nats: float) -> list[Rival]:
    """The confirmed without nonlinear joints that several levels show to be as good as a linear effect.

    That is where the linear one is within reach of their evidence, and where no level is answered otherwise than
    another.
    """
    straight = {r.name: r.gain_nats for r in reversed(confirmed) if r.hypothesis.linear}
    if not straight or not several_levels(confirmed[0].fit.problem):
        return list(confirmed)

    def needless(r: Rival) -> bool:
        alike: tuple[str, ...] = r.hypothesis.cls.confused_with  # type: ignore[attr-defined]
        likeness = max((straight.get(name, -np.inf) for name in alike), default=-np.inf)
        near = not r.hypothesis.linear and likeness > r.gain_nats - set_nats
        return near and level_nats(r.fit) < set_nats

    return [r for r in confirmed if not needless(r)]


def plain_likenesses(
    winner: Rival, confirmed: Sequence[Rival], equal: Sequence[Rival], thresholds: Thresholds
) -> tuple[Rival, ...]:
    """Linear effects that a nonlinear ``winner`` is confused with and that meet the data alone, beside those ``equal``.

    Where no level is answered otherwise than another, all that the winner is ahead by is one parameter more that acts
    linearly: a mass on a seat far above the band makes up for what the model's form misses of a mass. The best of each
    name among the confirmed, if it leaves no more than campaigns leave in which nothing is missing.
    """
    if winner.hypothesis.linear:
        return ()
    if several_levels(winner.fit.problem) and level_nats(winner.fit) >= thresholds.set_nats:
        return ()
    names = set(winner.hypothesis.cls.confused_with) - {r.name for r in equal}  # type: ignore[attr-defined]
    found: dict[str, Rival] = {}
    for r in sorted(confirmed, key=lambda r: -r.gain_nats):
        if r.name in names and r.hypothesis.linear and residual(r.fit, thresholds).adequate:
            found.setdefault(r.name, r)
    return tuple(found.values())


def level_nats(found: Fit) -> float:
    """What separates a fit from itself with every run as quiet as the quietest: nats of the fitted data for levels.

    A joint with play that its load keeps shut is a spring: at any level of the campaign it answers alike. Infinite
    where there would be no such aircraft.
    """
    problem = found.problem
    measured = problem.measured
    size = measured.level_n
    share = (size.min() / size)[:, None]
    quiet = replace(problem, measured=replace(measured, pushed=share * measured.pushed))
    try:
        there = anchor(quiet, found.u, found.hypotheses, found.e, slopes=False).predict(found.u, found.e)
    except NoStructureError:
        return np.inf
    apart = data_misfit(problem, there) - data_misfit(problem, found.predicted)
    return 0.5 * float(apart @ apart)
