"""The next test: small changes of procedure, each simulated under two rival explanations, ranked by what they tell."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.reconcile.descent import solved
from vgvt.reconcile.fit import Fit
from vgvt.reconcile.grouping import NoStructureError
from vgvt.reconcile.misfit import data_misfit, jacobian
from vgvt.reconcile.problem import Problem
from vgvt.reconcile.procedures import changed, levels_to_try, procedures
from vgvt.reconcile.surrogate import anchor

Array = NDArray[np.float64]
# What a test must promise to be worth its time: nats scatter by sqrt(2 nats), and five make two explanations two.
_TELLS = 10.0


@dataclass(frozen=True, slots=True)
class Suggestion:
    """A change of procedure, the nats it is expected to put between ``rivals``, and how long it takes."""

    test: str
    rivals: tuple[str, str]
    nats: float
    minutes: float

    def document(self) -> dict[str, object]:
        """Plain values."""
        return asdict(self)


def suggest(fits: Sequence[Fit], count: int = 3) -> tuple[Suggestion, ...]:
    """Rank procedures for every pair of rival fits by expected nats per lab minute; the smallest pair of each counts.

    What tells a pair at all comes before what does not, however quickly. Expected nats are half the square distance of
    the two predictions, after the other's own parameters have taken what they can (Box and Hill, Technometrics 9,
    1967, for normal errors), whichever of the two is true.
    """
    found: list[Suggestion] = []
    if len(fits) < 2:
        return ()
    for procedure in (*procedures(fits[0].problem), *levels_to_try(fits)):
        try:
            problem = changed(fits[0].problem, procedure)
        except (InputError, NoStructureError, ValueError, KeyError):
            continue
        pairs = []
        for one, other in itertools.combinations(fits[:3], 2):
            ways = [expected_nats(a, b, problem) for a, b in ((one, other), (other, one))]
            told = [nats for nats in ways if nats is not None]
            # Nobody knows which of the two is true.
            if len(told) == len(ways):
                pairs.append((min(told), (one.hypotheses[-1].name, other.hypotheses[-1].name)))
        if pairs:
            nats, names = min(pairs)
            found.append(Suggestion(procedure.words, names, nats, procedure.minutes))
    return tuple(sorted(found, key=lambda s: (s.nats < _TELLS, -s.nats / s.minutes))[:count])


def words_of_none(tests: Sequence[Suggestion], needed: float) -> tuple[str, ...]:
    """What is to be said where not even the best test is expected to bring the nats ``needed``."""
    if not tests or tests[0].nats >= needed:
        return ()
    one, other = tests[0].rivals
    return (
        f"None of the tests that were compared is expected to tell {one} from {other}: for all of them they are one",
    )


def expected_nats(one: Fit, other: Fit, problem: Problem) -> float | None:
    """Nats that a campaign by a changed procedure puts between two fits where ``one`` is true; None if impossible.

    By that campaign alone: what the first one knew of the unknowns is left out, as where it is reconciled by itself.
    """
    u, other_u = known_in(problem, one), known_in(problem, other)
    try:
        first = anchor(problem, u, one.hypotheses, one.e, slopes=False).predict(u, one.e)
        second = anchor(problem, other_u, other.hypotheses, other.e)
        predicted = second.predict(other_u, other.e)
    except (InputError, NoStructureError, ValueError, KeyError):
        return None
    measured = one.problem.measured
    relative = np.median(measured.sigma / np.abs(measured.values))
    sigma = relative * (np.abs(first) + np.median(np.abs(first), axis=1, keepdims=True))
    problem = replace(problem, measured=replace(problem.measured, values=first, sigma=sigma))
    second = replace(second, problem=problem)
    gap = data_misfit(problem, predicted)
    tangent = jacobian(second, other_u, other.e, predicted)
    true, scores = (np.concatenate(s) for s in ((u, one.e), (other_u, other.e)))
    gradient = tangent.T @ gap + scores
    taken = float(gradient @ solved(tangent.T @ tangent + np.eye(scores.size), gradient))
    return 0.5 * (float(gap @ gap + scores @ scores) - taken - float(true @ true))


def known_in(problem: Problem, fit: Fit) -> Array:
    """Scores (n,) of a fit's unknowns in another problem, by name: zero for what only that one has."""
    names = dict(zip(fit.problem.names, fit.u, strict=True))
    return np.array([names.get(name, 0.0) for name in problem.names])
