"""What a lab can change within minutes between two campaigns, and the campaign that a scenario then foretells."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vgvt.effects.added_mass import with_lump
from vgvt.reconcile.candidates import places
from vgvt.reconcile.data import measured_frfs
from vgvt.reconcile.fit import Fit
from vgvt.reconcile.holdout import Split
from vgvt.reconcile.problem import Nominal, Problem, problem_of
from vgvt.reconcile.uncertain import prepared
from vgvt.scenario.model import Scenario
from vgvt.simulation import simulate
from vgvt.simulation.reduced import Layouts, structure

_DUMMY_KG = 0.05

Runs = tuple[tuple[int, ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Procedure:
    """A change of procedure: in words, as an edit of the scenario, and its lab time beyond the runs themselves.

    ``force`` multiplies what the shaker pushed with; ``other_runs`` says that the edit changes what is measured when.
    """

    words: str
    edit: Callable[[Scenario], Scenario]
    minutes: float
    force: float = 1.0
    other_runs: bool = False


def levels_to_try(fits: Sequence[Fit]) -> tuple[Procedure, ...]:
    """Sweeps at other levels, where one of the fits holds an effect that depends on it."""
    if all(h.linear for fit in fits for h in fit.hypotheses):
        return ()
    return tuple(
        Procedure(f"sweep again with {words} the force", lambda s: s, 5.0, factor)
        for words, factor in (("twice", 2.0), ("half", 0.5), ("a quarter of", 0.25))
    )


def procedures(problem: Problem) -> tuple[Procedure, ...]:
    """What a lab can change within minutes: drive point, dummy mass, suspension, and what is measured when."""
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
    return (*found, *_other_runs(problem.measured.runs))


def _other_runs(runs: Runs) -> list[Procedure]:
    """What tells an instrument from the point where it sat, and what happened in the meantime from either."""

    def measured(order: Callable[[Runs], Runs]) -> Callable[[Scenario], Scenario]:
        def edit(s: Scenario) -> Scenario:
            changed = {"runs": order(runs), "repeats": 1}
            return s.model_copy(update={"acquisition": s.acquisition.model_copy(update=changed)})

        return edit

    found = []
    if len(runs) > 1:
        words = "make the first run once more after the last"
        found.append(Procedure(words, measured(lambda r: (*r, r[0])), 5.0, other_runs=True))
    if any(len(run) > 1 for run in runs):
        words = "exchange the sensors: every run again with their places in reverse order"
        # As long as the campaign was.
        minutes = 5.0 * len(runs)
        found.append(Procedure(words, measured(lambda r: tuple(run[::-1] for run in r)), minutes, other_runs=True))
    return found


def changed(problem: Problem, procedure: Procedure) -> Problem:
    """The problem of a campaign by a changed procedure, the data of the first standing in for its own."""
    scenario = procedure.edit(problem.scenario)
    if procedure.other_runs:
        return _expected(problem, scenario)
    start = prepared(scenario)
    layouts = Layouts.of(start)
    layout = layouts.plan(start)
    nominal = Nominal(start, layouts, structure(layout, layout.grid, problem.nominal))
    measured = problem.measured
    if procedure.force != 1:
        pushed, force = procedure.force * measured.pushed, procedure.force * measured.force
        measured = replace(measured, pushed=pushed, force=force)
    return replace(problem, scenario=scenario, measured=measured, start=nominal)


def _expected(problem: Problem, scenario: Scenario) -> Problem:
    """The problem of a campaign of other runs, simulated with nothing missing; whatever it adds is there to be fitted.

    Of runs that the first campaign had, the same channels are held out.
    """
    first = problem.measured
    band = (float(first.frequency_hz[0]), float(first.frequency_hz[-1]))
    campaign = simulate(scenario, engine="linear").campaign
    measured = measured_frfs(campaign, lines=first.frequency_hz.size, band_hz=band)
    held = {(c.run, c.dof) for c, out in zip(first.channels, problem.split.held, strict=True) if out}
    train = np.array([(c.run, c.dof) not in held for c in measured.channels])
    found = problem_of(measured, scenario)
    return replace(found, split=Split(train, np.zeros_like(train), ~train))
