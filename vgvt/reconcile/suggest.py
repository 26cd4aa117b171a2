"""The next test: small changes of procedure, each simulated under two rival explanations, ranked by what they tell."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.reconcile.fit import Fit
from vgvt.reconcile.grouping import NoStructureError
from vgvt.reconcile.misfit import jacobian
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
    1967, for normal errors).
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
            nats = expected_nats(one, other, problem)
            if nats is not None:
                pairs.append((nats, (one.hypotheses[-1].name, other.hypotheses[-1].name)))
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
    """Nats that a campaign by a changed procedure puts between two fits; None where it is impossible."""
    (u, _), (other_u, covariance) = (known_in(problem, fit) for fit in (one, other))
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
    keep = problem.split.train
    difference = ((predicted - first) / sigma)[keep]
    gap = np.sqrt(2) * np.concatenate([difference.real.ravel(), difference.imag.ravel()])
    tangent = jacobian(second, other_u, other.e, predicted)
    # The first campaign has pinned the parameters already: they move within their posterior.
    both = tangent.T @ tangent + np.linalg.inv(covariance)
    taken = float((tangent.T @ gap) @ np.linalg.solve(both, tangent.T @ gap))
    return 0.5 * (float(gap @ gap) - taken)


def known_in(problem: Problem, fit: Fit) -> tuple[Array, Array]:
    """Scores (n,) of a fit's unknowns in another problem, by name, and covariance (n + e, n + e) with its effects'.

    What only the other problem has, channels of more runs, is known from its tolerance alone.
    """
    names = {name: k for k, name in enumerate(fit.problem.names)}
    shared = [(k, names[name]) for k, name in enumerate(problem.names) if name in names]
    u, covariance = np.zeros(problem.size), np.eye(problem.size + fit.e.size)
    new = [k for k, _ in shared] + [problem.size + k for k in range(fit.e.size)]
    old = [k for _, k in shared] + [fit.u.size + k for k in range(fit.e.size)]
    u[[k for k, _ in shared]] = fit.u[[k for _, k in shared]]
    covariance[np.ix_(new, new)] = fit.covariance[np.ix_(old, old)]
    return u, covariance
