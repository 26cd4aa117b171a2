"""The next test: changes of procedure and readings, each under two rival explanations, ranked by what they tell."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from functools import lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.data.shown import headed
from vgvt.reconcile.fitting.descent import solved
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.fitting.misfit import data_misfit, jacobian
from vgvt.reconcile.next_test.checks import Check, checks
from vgvt.reconcile.next_test.procedures import Procedure, changed, levels_to_try, procedures
from vgvt.reconcile.next_test.with_reading import followed_nats, reading_nats
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.question.shared_noise import in_phase
from vgvt.reconcile.question.thresholds import noise_share
from vgvt.reconcile.work.one_thread import one_thread

Array = NDArray[np.float64]
Nats = Callable[[Fit, Fit], float | None]
COMPARED = 3
"""Of explanations that are as good so many are compared."""
# What a test must promise to be worth its time: nats scatter by sqrt(2 nats), and five make two explanations two.
_TELLS = 10.0
# What leaves no doubt: a test that promises more is not worth more minutes.
_CERTAIN = 50.0
# Parameters that say where an effect sits.
_PLACE = ("x_m", "y_m", "other_x_m", "other_y_m")
# Tests whose promise is followed to the end by fits, where one of them holds it and where none does; each takes
# seconds.
_FOLLOWED, _AT_MOST = 8, 24


@dataclass(frozen=True, slots=True)
class Suggestion:
    """A test, the nats it is expected to put between ``rivals``, and how long it takes.

    ``unfollowed`` is how many others promise more at first sight, and may not hold it.
    """

    test: str
    rivals: tuple[str, str]
    nats: float
    minutes: float
    unfollowed: int = 0

    def __repr__(self) -> str:
        return headed(f"Suggestion: {self.in_words}")

    @property
    def in_words(self) -> str:
        """What it tells, in which time, and the test."""
        return f"{self.nats:.0f} nats between {' and '.join(self.rivals)} in {self.minutes:.0f} min by {self.test}"

    def document(self) -> dict[str, object]:
        """Plain values of the test itself."""
        return {name: value for name, value in asdict(self).items() if name != "unfollowed"}


@dataclass(frozen=True, slots=True, eq=False)
class _Test:
    """A test in words, the nats that it promises between two fits at first sight, and ``followed`` to the end."""

    words: str
    minutes: float
    promised: Nats
    followed: Nats | None = None

    def worth(self, fits: Sequence[Fit], nats: Nats) -> Suggestion | None:
        """What it tells of the pair that it tells least of, whichever is true; None where that cannot be said."""
        least: tuple[float, Fit, Fit] | None = None
        for one, other in itertools.combinations(fits, 2):
            for true, wrong in ((one, other), (other, one)):
                told = nats(true, wrong)
                if told is None:
                    return None
                if least is None or told < least[0]:
                    least = (told, one, other)
        return None if least is None else Suggestion(self.words, _names(*least[1:]), least[0], self.minutes)


def _names(one: Fit, other: Fit) -> tuple[str, str]:
    """What two fits say: their effects' names, and where these are one, with the settings and place of each."""
    first, second = one.hypotheses[-1].name, other.hypotheses[-1].name
    return (first, second) if first != second else (in_its_place(one), in_its_place(other))


def in_its_place(fit: Fit) -> str:
    """The label of a fit's effect; a place that was fitted is told as one that was chosen."""
    hypothesis, found = fit.hypotheses[-1], fit.values(len(fit.hypotheses) - 1)
    # Plus nothing, lest the centre line reads -0.
    place = {name: round(found[name][0], 3) + 0.0 for name in _PLACE if name in found}
    return replace(hypothesis, settings={**hypothesis.settings, **place}).label


@one_thread
def suggest(fits: Sequence[Fit], count: int = 3, *, levels_alone: bool = False) -> tuple[Suggestion, ...]:
    """Rank tests for every pair of the first three rival fits by expected nats a lab minute; the smallest pair counts.

    What tells a pair at all comes before what does not, however quickly; more than 50 nats are no more than 50, and
    where nothing tells, minutes do not count.
    What a changed campaign promises is the linear distance (:func:`expected_nats`); the best of them are followed
    by fits until the first ``count`` hold what they promise, on and on where none does. ``levels_alone`` compares
    sweeps at other levels of force.
    """
    if len(fits) < 2:
        return ()
    fits = fits[:COMPARED]
    ranked = [
        (found, test) for test in _tests(fits, levels_alone) if (found := test.worth(fits, test.promised)) is not None
    ]
    for done in range(_AT_MOST + 1):
        ranked.sort(key=lambda pair: _order(pair[0]))
        ahead = [(i, test) for i, (_, test) in enumerate(ranked[:count]) if test.followed is not None]
        holds = any(test.followed is None and found.nats >= _TELLS for found, test in ranked)
        if not ahead or done >= (_FOLLOWED if holds else _AT_MOST):
            break
        index, test = ahead[0]
        assert test.followed is not None
        found = test.worth(fits, test.followed)
        if found is None:
            ranked.pop(index)
        else:
            ranked[index] = (found, replace(test, followed=None))
    sure = sorted((found for found, test in ranked if test.followed is None), key=_order)
    hollow = [found.nats for found, test in ranked if test.followed is not None]
    return tuple(replace(found, unfollowed=sum(nats > found.nats for nats in hollow)) for found in sure[:count])


def _order(found: Suggestion) -> tuple[bool, float]:
    if found.nats < _TELLS:
        return True, -found.nats
    return False, -min(found.nats, _CERTAIN) / found.minutes


def _tests(fits: Sequence[Fit], levels_alone: bool) -> Iterator[_Test]:
    """All tests that a scenario allows, or sweeps at other levels."""
    problem = fits[0].problem
    for check in () if levels_alone else checks(problem):
        yield _Test(check.words, check.minutes, partial(reading_nats, check=check), partial(_followed, check=check))
    for procedure in (*(() if levels_alone else procedures(problem)), *levels_to_try(fits)):
        after = _after(problem, procedure)
        if after is not None:
            yield _Test(
                procedure.words, procedure.minutes,
                partial(expected_nats, problem=after), partial(found_nats, problem=after),
            )  # fmt: skip


def _followed(true: Fit, other: Fit, check: Check) -> float | None:
    """What a reading tells where the other explanation may bend to it, unless it is beyond doubt at first sight.

    That is dear, as the whole campaign is fitted again. Bending takes of such a promise, at most until the effect is
    gone that the campaign had asked for.
    """
    promised = reading_nats(true, other, check)
    return promised if promised is None or promised >= _CERTAIN else followed_nats(true, other, check)


def _after(problem: Problem, procedure: Procedure) -> Problem | None:
    try:
        return changed(problem, procedure)
    except (InputError, NoStructureError, ValueError, KeyError):
        return None


def words_of_none(tests: Sequence[Suggestion], needed: float) -> tuple[str, ...]:
    """What is to be said where not even the best test is expected to bring the nats ``needed``."""
    if not tests or tests[0].nats >= needed:
        return ()
    one, other = tests[0].rivals
    if tests[0].unfollowed:
        return (
            f"None of the tests that were followed to the end is expected to tell {one} from {other}; at first sight "
            f"{tests[0].unfollowed} more {'promises' if tests[0].unfollowed == 1 else 'promise'} more than these",
        )
    return (
        f"None of the tests that were compared is expected to tell {one} from {other}: for all of them they are one",
    )


def expected_nats(one: Fit, other: Fit, problem: Problem) -> float | None:
    """Nats that a campaign by a changed procedure puts between two fits where ``one`` is true; None if impossible.

    Half the square distance of the two predictions, after the other's own parameters have taken what they can (Box and
    Hill, Technometrics 9, 1967, for normal errors). By that campaign alone: what the first one knew of the unknowns
    is left out, as where it is reconciled by itself; and as a verdict on it counts nats: of data that are judged by
    the model's form rather than by noise a value is worth less than one.
    """
    other_u = known_in(problem, other)
    try:
        told, own = foretold_by(one, problem)
        second = anchor(told, other_u, other.hypotheses, other.e)
        predicted = second.predict(other_u, other.e)
    except (InputError, NoStructureError, ValueError, KeyError):
        return None
    gap = data_misfit(told, predicted)
    return 0.5 * (_tempered_bottom(told, gap, jacobian(second, other_u, other.e, predicted), other_u, other.e) - own)


def found_nats(one: Fit, other: Fit, problem: Problem) -> float | None:
    """What :func:`expected_nats` foretells, after the other explanation was fitted to the campaign by iteration."""
    try:
        told, own = foretold_by(one, problem)
        ended = fit(told, other.hypotheses, known_in(problem, other), other.e, NEAR)
    except (InputError, NoStructureError, ValueError, KeyError):
        return None
    return 0.5 * (ended.cost - (1 - _worth(told)) * ended.chi2 - own)


@lru_cache(maxsize=8)
def foretold_by(true: Fit, problem: Problem) -> tuple[Problem, float]:
    """A problem whose data are what a fit foretells, and what the fit itself would then cost, tempered.

    The data have no noise but are judged by it, as measured ones are: by the noise of A/F that instruments add and the
    floor beside it. The fit gives way to its own priors as any other may, to first order.
    """
    u, measured = known_in(problem, true), problem.measured
    here = anchor(problem, u, true.hypotheses, true.e)
    values = here.predict(u, true.e)
    of_force = None if measured.of_force is None else in_phase(np.abs(measured.of_force) ** 2, values)
    judged = replace(measured, values=values, of_force=of_force)
    told = replace(problem, measured=judged.with_floor(noise_share(measured, measured.used).floor))
    tangent = jacobian(replace(here, problem=told), u, true.e, values)
    return told, _tempered_bottom(told, np.zeros(tangent.shape[0]), tangent, u, true.e)


def _tempered_bottom(told: Problem, gap: Array, tangent: Array, u: Array, e: Array) -> float:
    """What a fit costs where its linearised parameters, at ``u`` and ``e`` now, have taken what they can of a ``gap``.

    They take by χ² as it is, as a fit does; counted is what of that is worth anything.
    """
    scores = np.concatenate([u, e])
    step = solved(tangent.T @ tangent + np.eye(scores.size), tangent.T @ gap + scores)
    left, there = gap - tangent @ step, scores - step
    return float(_worth(told) * (left @ left) + there @ there)


def _worth(told: Problem) -> float:
    """What one of the values to be fitted is worth to a verdict on them."""
    return noise_share(told.measured, told.split.train).worth


def known_in(problem: Problem, fit: Fit) -> Array:
    """Scores (n,) of a fit's unknowns in another problem, by name: zero for what only that one has."""
    names = dict(zip(fit.problem.names, fit.u, strict=True))
    return np.array([names.get(name, 0.0) for name in problem.names])
