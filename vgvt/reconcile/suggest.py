"""The next test: small changes of procedure, each simulated under two rival explanations, ranked by what they tell."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.effects.added_mass import with_lump
from vgvt.reconcile.candidates import places
from vgvt.reconcile.fit import Fit
from vgvt.reconcile.grouping import NoStructureError
from vgvt.reconcile.misfit import jacobian
from vgvt.reconcile.problem import Nominal, Problem
from vgvt.reconcile.surrogate import anchor
from vgvt.reconcile.uncertain import prepared
from vgvt.scenario.model import Scenario
from vgvt.simulation.reduced import Layouts, structure

Array = NDArray[np.float64]
_DUMMY_KG = 0.05


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


@dataclass(frozen=True, slots=True, eq=False)
class Procedure:
    """A change of procedure: in words, as an edit of the scenario, and its lab time beyond the runs themselves.

    ``force`` multiplies what the shaker pushed with.
    """

    words: str
    edit: Callable[[Scenario], Scenario]
    minutes: float
    force: float = 1.0


def suggest(fits: Sequence[Fit], count: int = 3) -> tuple[Suggestion, ...]:
    """Rank procedures for every pair of rival fits by expected nats per lab minute; the smallest pair of each counts.

    Expected nats are half the square distance of the two predictions, after the other's own parameters have taken
    what they can (Box and Hill, Technometrics 9, 1967, for normal errors).
    """
    found: list[Suggestion] = []
    if len(fits) < 2:
        return ()
    for procedure in (*procedures(fits[0].problem), *levels_to_try(fits)):
        pairs = []
        for one, other in itertools.combinations(fits[:3], 2):
            nats = expected_nats(one, other, procedure)
            if nats is not None:
                pairs.append((nats, (one.hypotheses[-1].name, other.hypotheses[-1].name)))
        if pairs:
            nats, names = min(pairs)
            found.append(Suggestion(procedure.words, names, nats, procedure.minutes))
    return tuple(sorted(found, key=lambda s: -s.nats / s.minutes)[:count])


def expected_nats(one: Fit, other: Fit, procedure: Procedure) -> float | None:
    """Nats that a repeated campaign with a changed procedure puts between two fits; None where it is impossible."""
    try:
        problem = _changed(one.problem, procedure)
        first = anchor(problem, one.u, one.hypotheses, one.e, slopes=False).predict(one.u, one.e)
        second = anchor(problem, other.u, other.hypotheses, other.e)
        predicted = second.predict(other.u, other.e)
    except (InputError, NoStructureError, ValueError, KeyError):
        return None
    relative = np.median(problem.measured.sigma / np.abs(problem.measured.values))
    sigma = relative * (np.abs(first) + np.median(np.abs(first), axis=1, keepdims=True))
    problem = replace(problem, measured=replace(problem.measured, values=first, sigma=sigma))
    second = replace(second, problem=problem)
    keep = problem.split.train
    difference = ((predicted - first) / sigma)[keep]
    gap = np.sqrt(2) * np.concatenate([difference.real.ravel(), difference.imag.ravel()])
    tangent = jacobian(second, other.u, other.e, predicted)
    # The first campaign has pinned the parameters already: they move within their posterior.
    precision = np.linalg.inv(other.covariance)
    both = tangent.T @ tangent + precision
    taken = float((tangent.T @ gap) @ np.linalg.solve(both, tangent.T @ gap))
    return 0.5 * (float(gap @ gap) - taken)


def levels_to_try(fits: Sequence[Fit]) -> tuple[Procedure, ...]:
    """Sweeps at other levels, where one of the fits holds an effect that depends on it."""
    if all(h.linear for fit in fits for h in fit.hypotheses):
        return ()
    return tuple(
        Procedure(f"sweep again with {words} the force", lambda s: s, 5.0, factor)
        for words, factor in (("twice", 2.0), ("half", 0.5), ("a quarter of", 0.25))
    )


def procedures(problem: Problem) -> tuple[Procedure, ...]:
    """What a lab can change within minutes: drive point, dummy mass, suspension."""
    scenario = problem.scenario
    x, y, z = scenario.shaker.position_m

    def driven(at: tuple[float, float, float]) -> Callable[[Scenario], Scenario]:
        return lambda s: s.model_copy(update={"shaker": s.shaker.model_copy(update={"position_m": at})})

    def sprung(factor: float) -> Callable[[Scenario], Scenario]:
        return lambda s: s.model_copy(
            update={
                "suspension": s.suspension.model_copy(
                    update={"stiffness_n_per_m": s.suspension.stiffness_n_per_m * factor}
                )
            }
        )

    def loaded(place: tuple[float, float]) -> Callable[[Scenario], Scenario]:
        return lambda s: with_lump(s, "dummy", _DUMMY_KG, place)

    found = []
    if y != 0:
        found.append(Procedure("excite at the mirror image of the drive point", driven((x, -y, z)), 20.0))
        found.append(Procedure("excite on the centre line", driven((x, 0.0, z)), 20.0))
    found.append(Procedure("excite 10 cm further forward", driven((x - 0.1, y, z)), 20.0))
    found.append(Procedure("hang it on a spring half as stiff", sprung(0.5), 15.0))
    found.append(Procedure("hang it on a spring twice as stiff", sprung(2.0), 15.0))
    for place in places(problem):
        words = f"tape a dummy mass of {1000 * _DUMMY_KG:.0f} g at x = {place[0]:.2f} m, y = {place[1]:.2f} m"
        found.append(Procedure(words, loaded(place), 5.0))
    return tuple(found)


def _changed(problem: Problem, procedure: Procedure) -> Problem:
    scenario = procedure.edit(problem.scenario)
    start = prepared(scenario)
    layouts = Layouts.of(start)
    layout = layouts.plan(start)
    nominal = Nominal(start, layouts, structure(layout, layout.grid, problem.nominal))
    measured = problem.measured
    if procedure.force != 1:
        pushed, force = procedure.force * measured.pushed, procedure.force * measured.force
        measured = replace(measured, pushed=pushed, force=force)
    return replace(problem, scenario=scenario, measured=measured, start=nominal)
