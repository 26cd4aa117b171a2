"""One reconciliation: the scenario lined up with a campaign, what is open, and how the matrices depend on it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, InputError
from vgvt.data.shown import brief, counted, headed
from vgvt.effects.acting import acted
from vgvt.effects.registry import effects_of
from vgvt.effects.root_joint import require_one_stiffness
from vgvt.reconcile.mechanics.refinement import Refinement, meshed, to_continuum, towards, twice_as_fine
from vgvt.reconcile.question.arguments import check_campaign, check_scenario, floor_for
from vgvt.reconcile.question.data import Measured, measured_frfs
from vgvt.reconcile.question.holdout import Split, split
from vgvt.reconcile.question.kept_slopes import kept_slopes
from vgvt.reconcile.question.stretches import with_stretches
from vgvt.reconcile.question.structure_code import structure_code
from vgvt.reconcile.question.suitable import check_suitable
from vgvt.reconcile.question.uncertain import Unknown, edited, prepared, unknowns
from vgvt.scenario.model import Scenario
from vgvt.scenario.write import to_toml
from vgvt.simulation.reduced import Layouts, Structure, structure

Array = NDArray[np.float64]

# In units of the prior's standard deviation: linear within it to round-off of the differences.
_STEP = 0.1
# One-sided: second order is small against what products of first order do.
_ASIDE = 0.02
MATRICES = ("mass", "damping", "stiffness", "drive", "axis", "tilt")
"""What of a structure changes with the unknowns."""
# Of a mode's frequency, more than what is made up for without its shape.
_FURTHEST = 0.02
# A campaign may come from a coarse chain too: 0 is the continuum, -1 the chain as stated, which stands for it.
CELLS = Unknown("cells", "refinement of the beams' cells", "", 0.5, "bounded", lambda scenario, _: scenario)


@dataclass(frozen=True, slots=True, eq=False)
class Nuisance:
    """A gain or corner of the measuring chain with a unit normal prior; ``rows`` (C,) are the channels it scales.

    A gain scales A/F by its ``power``: what reads too much of the force makes it smaller.
    """

    name: str
    sd: float
    kind: str
    rows: NDArray[np.bool_]
    power: int = 1

    def __repr__(self) -> str:
        return f"<Nuisance {self.name}: ± {100 * self.sd:.3g} %, of {counted(int(self.rows.sum()), 'channel')}>"


@dataclass(frozen=True, slots=True, eq=False)
class Nominal:
    """The aircraft as stated, sides written out, before any effect: what the derivatives refer to."""

    scenario: Scenario
    layouts: Layouts
    structure: Structure


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """Everything that fits share. Scores u: first the ``unknowns``, then the ``nuisances``.

    ``slopes`` maps 'mass', … to the change per unit of each unknown's factor or shift, (unknowns, …), at the scores
    ``centre`` (unknowns,), None for the values as stated;
    ``refinement`` is what the chain's cells lack of a continuum, ``coarseness`` the way from the chain as ``stated``,
    the scenario with the cells that it states, to that.
    """

    scenario: Scenario
    measured: Measured
    split: Split
    unknowns: tuple[Unknown, ...]
    nuisances: tuple[Nuisance, ...]
    start: Nominal
    slopes: dict[str, Array]
    refinement: Refinement
    coarseness: Refinement
    stated: Scenario
    centre: Array | None = None

    def __repr__(self) -> str:
        unknown = f"{counted(len(self.unknowns), 'unknown')} of the scenario, {len(self.nuisances)} of the instruments"
        return headed(f"Problem {self.scenario.name}: {unknown}", map(brief, (self.measured, self.split)))

    @property
    def at(self) -> Array:
        """Scores (unknowns,) that the slopes were taken at."""
        return np.zeros(len(self.unknowns)) if self.centre is None else self.centre

    @property
    def layouts(self) -> Layouts:
        """Plans of edits of the nominal aircraft."""
        return self.start.layouts

    @property
    def nominal(self) -> Structure:
        """The nominal aircraft's structure."""
        return self.start.structure

    @property
    def size(self) -> int:
        """Number of scores."""
        return len(self.unknowns) + len(self.nuisances)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the scores."""
        return (*(u.name for u in self.unknowns), *(n.name for n in self.nuisances))


def make_problem(
    campaign: Campaign,
    scenario: Scenario,
    *,
    floor: float | None = None,
    lines: int = 500,
    cache: Path | str | None = None,
) -> Problem:
    """Line a scenario up with a campaign; derivatives are kept in ``cache`` (default: the user's temporary folder).

    ``floor`` is the relative model-form error, by default that of the scenario's tolerances. InputError where the two
    do not speak of the same test (:func:`~vgvt.reconcile.question.suitable.check_suitable`), and where the scenario's
    own effects contradict each other.
    """
    check_campaign(campaign)
    check_scenario(scenario)
    check_suitable(campaign, scenario)
    measured = measured_frfs(campaign, lines=lines, floor=floor_for(scenario, floor))
    stated = aligned(scenario, measured)
    require_one_stiffness(acted(effects_of(stated), stated, 0)[1])
    return problem_of(measured, scenario, cache=cache)


def problem_of(measured: Measured, scenario: Scenario, *, cache: Path | str | None = None) -> Problem:
    """The problem for data that are there already."""
    stated = aligned(scenario, measured)
    lined_up = _fine_enough(stated, limit_hz(measured))
    known, start, slopes, finer, span = assembled_once(
        lined_up, stated, limit_hz(measured), None if cache is None else Path(cache)
    )
    return Problem(
        lined_up,
        measured,
        split(lined_up, measured),
        known,
        nuisances_of(lined_up, measured),
        start,
        slopes,
        finer,
        span,
        stated,
    )


def _fine_enough(stated: Scenario, limit_hz: float) -> Scenario:
    """A scenario with as many cells as its modes up to twice the band ask for.

    What cells cost is made up for in frequency, each mode in its own shape. Where they cost much of one it has another
    shape, and a neighbour's, too: a placebo of the bundled BFF, whose items sit between its sixteen cells, leant on
    its tolerances by 73 deviations, and with twice as many by none.
    """
    found = meshed(stated)
    while _hung(found, stated, limit_hz)[1].furthest > _FURTHEST:
        finer = twice_as_fine(found)
        if finer is None:
            break
        found = finer
    return found


@lru_cache(maxsize=4)
def at_rest(problem: Problem) -> Problem:
    """The same problem, always the same one, as if its records had ended at rest."""
    return replace(problem, measured=replace(problem.measured, endings=())) if problem.measured.endings else problem


def with_more_cells(problem: Problem) -> Problem | None:
    """The same problem with the beams cut into twice as many cells, scores meaning what they did; None for fine ones.

    To be predicted with, not fitted: its ``slopes`` are those of the coarser aircraft.
    """
    finer = twice_as_fine(problem.scenario)
    if finer is None:
        return None
    start, lacking, span = _hung(finer, problem.stated, limit_hz(problem.measured))
    return replace(problem, scenario=finer, start=start, refinement=lacking, coarseness=span)


def limit_hz(measured: Measured) -> float:
    """Up to where modes are made up for; rounded up: many campaigns of one scenario then share what is assembled."""
    return float(np.ceil(3 * measured.frequency_hz[-1]))


def recentred(problem: Problem, u: Array) -> Problem:
    """The problem with slopes taken at scores u (n,); the same where there is no such aircraft a step further.

    Matrices are products of what the unknowns scale: a stretch's own factor counts for a tenth less on a wing that
    is a tenth softer. What a fit decides is what is left where such products nearly cancel, and a slope that is
    wrong by that much stops it anywhere along the valley.
    """
    known, centre = problem.unknowns[:-1], u[: len(problem.unknowns)].copy()

    def there(scores: Array) -> Structure:
        layout = problem.layouts.plan(edited(problem.start.scenario, problem.unknowns, scores))
        return structure(layout, layout.grid, problem.nominal)

    try:
        here, found = there(centre), {name: values.copy() for name, values in problem.slopes.items()}
        for k, unknown in enumerate(known):
            aside = centre.copy()
            aside[k] += _ASIDE
            span = unknown.change(float(aside[k])) - unknown.change(float(centre[k]))
            if span == 0:
                # As far as a bounded quantity goes: the slope at its stated value will do.
                continue
            moved = there(aside)
            if moved.joints != here.joints or moved.places != here.places:
                return problem
            for name in MATRICES:
                found[name][k] = (getattr(moved, name) - getattr(here, name)) / span
    except (InputError, RuntimeError, ValueError, np.linalg.LinAlgError):
        return problem
    return replace(problem, slopes=found, centre=centre)


@lru_cache(maxsize=4)
def assembled_once(
    lined_up: Scenario, as_stated: Scenario, limit_hz: float, cache: Path | None
) -> tuple[tuple[Unknown, ...], Nominal, dict[str, Array], Refinement, Refinement]:
    """What does not depend on the campaign's records: unknowns, nominal aircraft, derivatives and refinement.

    The last are what its cells lack of a continuum, and the way from the cells ``as_stated`` to that.
    """
    start, finer, span = _hung(lined_up, as_stated, limit_hz)
    known = unknowns(lined_up)
    slopes = _slopes(start.scenario, known, start.layouts, start.structure, cache)
    for name in MATRICES:
        own = getattr(span, name, None)
        row = np.zeros((1, *slopes[name].shape[1:])) if own is None else own[None]
        slopes[name] = np.concatenate([slopes[name], row])
    return (*known, CELLS), start, slopes, finer, span


@lru_cache(maxsize=8)
def _hung(lined_up: Scenario, as_stated: Scenario, limit_hz: float) -> tuple[Nominal, Refinement, Refinement]:
    """The nominal aircraft, what its cells lack of a continuum, and the way from the cells as stated to that."""
    stated, start = prepared(as_stated), prepared(lined_up)
    layouts = Layouts.of(start)
    layout = layouts.plan(start)
    nominal = structure(layout, layout.grid)
    finer = to_continuum(start, layouts, nominal, limit_hz)
    span = finer.less(towards(stated, layouts, nominal, limit_hz))
    return Nominal(start, layouts, nominal), finer, span


def aligned(scenario: Scenario, measured: Measured) -> Scenario:
    """The scenario with the campaign's runs and stretches; InputError for a channel that it has no point for."""
    nodes = scenario.accelerometers.grid.node
    for channel in measured.channels:
        if channel.dof.node not in nodes:
            raise InputError(
                f"scenario {scenario.name}: accelerometers.grid",
                f"has no node {channel.dof.node}, which {channel.label} measured",
                "Give the scenario a point for every channel of the campaign.",
            )
    acquisition = scenario.acquisition.with_runs(measured.runs)
    # Rounded up: campaigns of one scenario then share what is assembled, wherever their last line is.
    return with_stretches(scenario, math.ceil(measured.frequency_hz[-1])).model_copy(
        update={"acquisition": acquisition}
    )


def nuisances_of(scenario: Scenario, measured: Measured) -> tuple[Nuisance, ...]:
    """What the tolerances leave open of the measuring chain of a campaign."""
    t, count = scenario.tolerances, len(measured.channels)
    everything = np.ones(count, dtype=bool)
    found = [Nuisance("gain force", t.gain, "gain", everything, power=-1)]
    instruments = np.array([c.instrument for c in measured.channels])
    found += [Nuisance(f"gain sensor-{k + 1}", t.gain, "gain", instruments == k) for k in np.unique(instruments)]
    # With every sensor in one place only its own gain and its channel's are the same thing.
    if len(measured.runs) > 1:
        found += [
            Nuisance(f"gain {channel.label}", t.channel_gain, "gain", np.arange(count) == i)
            for i, channel in enumerate(measured.channels)
        ]
    if scenario.transducer.high_pass_hz > 0:
        found.append(Nuisance("corner force", t.high_pass, "corner force", everything))
    if scenario.accelerometers.high_pass_hz > 0:
        found.append(Nuisance("corner sensors", t.high_pass, "corner sensors", everything))
    return tuple(n for n in found if n.sd > 0)


def _slopes(
    start: Scenario, known: tuple[Unknown, ...], layouts: Layouts, nominal: Structure, cache: Path | None
) -> dict[str, Array]:
    text = "\n".join((structure_code(), to_toml(start.model_copy(update={"seed": 0})), *nominal.joints))
    return kept_slopes(cache, text, MATRICES, lambda: slopes_in(start, known, layouts, nominal))


def slopes_in(start: Scenario, known: tuple[Unknown, ...], layouts: Layouts, nominal: Structure) -> dict[str, Array]:
    """Changes (unknowns, …) of the matrices of an aircraft per unit of each unknown's amount, by name of the matrix."""
    found: dict[str, list[Array]] = {name: [] for name in MATRICES}
    for unknown in known:
        sides = []
        for u in (_STEP, -_STEP):
            layout = layouts.plan(unknown.edit(start, unknown.amount(u)))
            sides.append(structure(layout, layout.grid, nominal))
        span = unknown.change(_STEP) - unknown.change(-_STEP)
        for name in MATRICES:
            found[name].append((getattr(sides[0], name) - getattr(sides[1], name)) / span)
    return {name: np.array(rows) for name, rows in found.items()}
