"""The cases of the study: which truth, from which laboratory, how big, how noisy; and the campaign of each."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import sys
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import loop_truth as lab
import numpy as np
from loop_places import NOWHERE, Where, where

from vgvt.data import Campaign
from vgvt.effects import available_effects, parameters_of
from vgvt.effects.protocol import Family
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.next_test.power import power
from vgvt.reconcile.question.data import measured_frfs
from vgvt.reconcile.question.holdout import Split
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import problem_of
from vgvt.reconcile.search.candidates import candidates
from vgvt.scenario import Scenario
from vgvt.scenario.effect import EffectTable
from vgvt.scenario.streams import named_stream
from vgvt.simulation import simulated_campaign

LINES = 160
SIZES = (1.0, 2.0, 6.0)
NOISE = (0.003, 0.01, 0.03)
# What the second laboratory needs lies with the tests that check it.
TESTS = Path(__file__).parents[2] / "tests"
SIMULATION, SECOND = "simulation", "second laboratory"
OPEN_SET = ("removed", "family", "never", "beside")
"""Groups whose truth the analysis cannot name as a whole.

It, its whole family, or one of two was taken out of the catalogue, or no catalogue ever had it.
"""
SHORT = (
    "added-inertia", "added-mass", "bend-twist-coupling", "channel-delay", "channel-gain", "drive-point-offset",
    "drive-remount", "high-pass-mismatch", "local-absorber", "loose-sensor-mount", "mount-compliance",
    "root-compliance", "roving-sensor-mass", "run-drift", "sensor-position-error", "stiffness-asymmetry",
    "stinger-moment", "suspension-surge", "swapped-sensors", "transducer-mass",
)  # fmt: skip
"""A catalogue for a machine with little time: two of five effects, those that are most often taken for others."""


@dataclass(frozen=True, slots=True)
class Case:
    """One campaign and one question.

    ``group`` is 'placebo', 'effect', 'pair', 'removed' (from the registry), 'family' (removed with all of its family),
    'never' (in it), 'beside' (two act, and the second is removed) or 'alone' (the only one in it); ``truth`` names the
    effects that act; ``size`` is a multiple of what gets a name in 95 of 100 campaigns, as ``vgvt reconcile --power``
    states it; ``source`` is the laboratory, ``engine`` its solver.
    """

    group: str
    truth: tuple[str, ...]
    draw: int
    size: float
    noise: float
    source: str = SIMULATION
    engine: str = "linear"
    base: int = 1
    short: bool = False

    @property
    def catalogue(self) -> dict[str, type]:
        """What the analysis may name: the installed effects or the short list, less what is removed."""
        known = available_effects()
        if self.group == "alone":
            return {n: known[n] for n in self.truth}
        names = [n for n in known if not self.short or n in SHORT]
        return {n: known[n] for n in names if not self._taken_out(n)}

    def _taken_out(self, name: str) -> bool:
        """Whether the analysis does not know an effect of the registry."""
        if self.group == "family":
            return family_of(name) in map(family_of, self.truth)
        gone = {"removed": self.truth, "beside": self.truth[1:]}
        return name in gone.get(self.group, ())

    @property
    def key(self) -> str:
        """A hash of all that the result depends on, the code aside."""
        text = json.dumps([*dataclasses.astuple(self), LINES, lab.RUNS, lab.SWEEP_S, lab.TRUE_CELLS, lab.STEPPED_CELLS])
        return hashlib.sha256(text.encode()).hexdigest()[:24]

    @property
    def title(self) -> str:
        """The case in words, for progress."""
        return f"{self.group} {' + '.join(self.truth) or '-'}, draw {self.draw}, {self.size:g}x, noise {self.noise:g}"

    def stream(self, *name: str) -> np.random.Generator:
        """A random stream of this case's own."""
        return named_stream(self.base, "closing the loop", self.key, *name)


@dataclass(frozen=True, slots=True, eq=False)
class Staged:
    """A campaign for the analysis, and beside it, for the umpire alone, what is true: settings by effect and sizes.

    ``ratio`` is the smallest size over what gets a name; ``place`` where a thing sits that has one.
    """

    campaign: Campaign | None
    truth: dict[str, dict[str, Any]]
    ratio: float
    place: Where = NOWHERE


def staged(case: Case) -> Staged:
    """Make the campaign of a case; none where no plausible size is visible."""
    scenario = lab.nominal()
    cells = lab.STEPPED_CELLS if case.engine == "mujoco" else lab.TRUE_CELLS
    true = lab.drawn(lab.quiet(scenario), case.stream("truth"), cells)
    true = true.model_copy(update={"seed": int(case.stream("seed").integers(2**31))})
    if case.source == SECOND:
        campaign, sizes, place = _second(case, true)
        ratio = min((_over_the_limit(case, name, said) for name, said in sizes.items()), default=float("nan"))
    else:
        sizes, ratio, place = {}, float("inf"), NOWHERE
        for name in case.truth:
            chosen = _chosen(case, name)
            if chosen is None:
                return Staged(None, {}, 0.0)
            sizes[name], own = chosen
            ratio = min(ratio, own)
        tables = tuple(EffectTable(name=name, **values) for name, values in sizes.items())
        campaign = simulated_campaign(true.model_copy(update={"effect": tables}), engine=case.engine)
    for name, said in sizes.items():
        own_place = where(name, said, true)
        place = own_place if own_place.known else place
    noisy = lab.read_by_instruments(campaign, scenario, case.stream("instruments"), case.noise)
    # A name or a note could tell: the analysis gets neither.
    blind = dataclasses.replace(noisy, name="campaign", notes={})
    return Staged(blind, sizes, ratio if case.truth else 0.0, place)


def second_laboratory_effects() -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of the catalogue's effects that the second laboratory can make, and of those that no catalogue has."""
    twins, never, _ = _second_laboratory()
    return tuple(twins), tuple(never)


def find_the_second_laboratory() -> None:
    """Let its modules be imported, which lie with the tests that check them."""
    for folder in ("physics", "reconcile_oracle"):
        if str(TESTS / folder) not in sys.path:
            sys.path.append(str(TESTS / folder))


def _second_laboratory() -> tuple[dict[str, Any], dict[str, Any], Any]:
    find_the_second_laboratory()
    import catalogue_twins
    import never_catalogued
    import second_laboratory

    return catalogue_twins.TWINS, never_catalogued.UNCATALOGUED, second_laboratory


def _second(case: Case, true: Scenario) -> tuple[Campaign, dict[str, dict[str, Any]], Where]:
    """The campaign, what the catalogue would call the effects that it has, and the place of one that it has not."""
    twins, never, laboratory = _second_laboratory()
    changes, sizes, place = [], {}, NOWHERE
    nodes = true.acquisition.runs[1]
    for name in case.truth:
        if name in never:
            change, node = never[name](case.stream("effect"), nodes)
            place = NOWHERE if node is None else Where(laboratory.place(true, node))
        else:
            change, sizes[name] = twins[name](case.stream("effect"), nodes)
        changes.append(change)
    campaign: Campaign = laboratory.campaign_of(true, tuple(changes))
    return campaign, sizes, place


def _over_the_limit(case: Case, name: str, said: dict[str, Any]) -> float:
    """The largest of an effect's sizes over what gets it a name; not a number for what has none.

    With every channel fitted: what happens to a held-out one alone is fitted in a second look.
    """
    here = expected(case.noise, whole=True)
    cls = available_effects()[name]
    sizes = {p.name for p in parameters_of(cls) if p.neutral is not None}
    fixed = Hypothesis(cls, {k: v for k, v in said.items() if k not in sizes})
    limits = power(here, [fixed])
    known = [p for p in limits if p.parameter in said and not np.isnan(p.named)]
    return max((abs(said[p.parameter]) / p.named for p in known), default=float("nan"))


def _chosen(case: Case, name: str) -> tuple[dict[str, Any], float] | None:
    """Settings and parameters of an effect at the case's size, and that size over what gets a name."""
    g = case.stream("effect", name)
    here = expected(case.noise)
    variants = candidates(here.problem, {name: available_effects()[name]})
    hypothesis = variants[int(g.integers(len(variants)))]
    values = {p.name: _between(g, p.low, p.high, p.scale) for p in hypothesis.parameters if p.neutral is None}
    settings = {k: _jittered(g, k, v) for k, v in hypothesis.settings.items()}
    limits = [p for p in power(here, [_fixed(hypothesis, values)]) if np.isfinite(p.named)]
    if not limits:
        return (settings | values, float("nan")) if not hypothesis.size else None
    limit = limits[int(g.integers(len(limits)))]
    highest = max(abs(limit.low), abs(limit.high))
    # What is lighter or softer than plausible is no hypothesis of the catalogue, however well it can be seen.
    size = min(max(case.size * limit.named, limit.low), highest)
    if size < 0.3 * case.size * limit.named:
        return None
    sign = -1.0 if limit.low < 0 and g.random() < 0.5 else 1.0
    return settings | values | {limit.parameter: sign * size}, size / limit.named


def _fixed(hypothesis: Hypothesis, values: dict[str, float]) -> Hypothesis:
    return dataclasses.replace(hypothesis, settings={**hypothesis.settings, **values})


def _between(g: np.random.Generator, low: float, high: float, scale: str) -> float:
    return float(np.exp(g.uniform(np.log(low), np.log(high)))) if scale == "log" else float(g.uniform(low, high))


def _jittered(g: np.random.Generator, name: str, value: Any) -> Any:
    """A place off the grid of the candidates; anything else as it is."""
    return float(value + 0.04 * g.standard_normal()) if name in ("x_m", "y_m") and value != 0 else value


@lru_cache(maxsize=4)
def expected(noise: float, whole: bool = False) -> Fit:
    """The nominal aircraft against its own campaign with some noise, nothing fitted: where limits are judged.

    ``whole`` with nothing held out.
    """
    scenario = lab.nominal()
    campaign = simulated_campaign(lab.quiet(scenario), engine="linear")
    exact = scenario.tolerances.model_copy(update={"gain": 0.0, "channel_gain": 0.0})
    instruments = scenario.model_copy(update={"tolerances": exact})
    noisy = lab.read_by_instruments(campaign, instruments, named_stream(0, "expected"), noise)
    measured = measured_frfs(noisy, lines=LINES, floor=scenario.tolerances.model_form)
    problem = problem_of(measured, scenario)
    if whole:
        every = np.ones(len(measured.channels), dtype=bool)
        problem = dataclasses.replace(problem, split=Split(every, ~every, ~every))
    return fit(problem, (), np.zeros(problem.size), np.zeros(0), ())


def family_of(name: str) -> Family:
    """Where an effect of the registry acts."""
    family: Family = available_effects()[name].family  # type: ignore[attr-defined]
    return family


def linear_effects() -> tuple[str, ...]:
    """Effects for which superposition holds, in alphabetical order."""
    return tuple(n for n, c in available_effects().items() if c.linear)  # type: ignore[attr-defined]
