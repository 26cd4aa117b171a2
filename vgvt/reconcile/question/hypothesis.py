"""A hypothesis: one effect of the catalogue with its settings chosen and priors on its parameters."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data.plugin import PluginError, whose_fault
from vgvt.data.shown import headed
from vgvt.effects.parameter import Parameter, parameters_of
from vgvt.effects.protocol import Effect
from vgvt.effects.registry import EffectPluginWarning

Array = NDArray[np.float64]
# A plausible range is taken as plus and minus this many standard deviations of the prior.
_RANGE_SD = 2.0
# The setting that counts runs: from 1, in their order, as scenarios do.
_COUNTS_RUNS = "from_run"
# No less than this share of a value in one step.
_LEAST_LEFT = 0.1
_BEYOND = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Hypothesis:
    """An effect with settings (choices of channels, sides, …) fixed; scores e of unit normal prior for its parameters.

    Log-normal where the parameter's scale is 'log', normal otherwise, with the plausible range as ±2 standard
    deviations around its middle, or around the neutral value where that lies inside.
    ``share`` is the prior probability that this variant gets of its effect's (the look-elsewhere factor).
    ``spans`` are plausible ranges of this aircraft by parameter, where they are not those of the catalogue: its places.
    ``places`` is how many variants differ by their place alone: with its place free one stands for all of them.
    ``numbers`` (R,) are what the campaign calls its runs, empty where that is not known: settings count runs from 1.
    """

    cls: type
    settings: Mapping[str, Any] = field(default_factory=dict)
    share: float = 1.0
    spans: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    places: int = 1
    numbers: tuple[int, ...] = ()

    def __repr__(self) -> str:
        ranges = [f"{p.name} {p.low:.4g} to {p.high:.4g} {p.unit}".rstrip() for p in self.parameters]
        return headed("; ".join((f"Hypothesis {self.label}", *ranges)))

    @property
    def name(self) -> str:
        """The effect's name as scenarios write it."""
        return str(self.cls.name)  # type: ignore[attr-defined]

    def same(self, other: Hypothesis) -> bool:
        """Whether both are one variant: a process or a file that hands one on makes another object of it."""
        return self.cls is other.cls and dict(self.settings) == dict(other.settings)

    @property
    def family(self) -> str:
        """Where the effect acts."""
        return str(self.cls.family)  # type: ignore[attr-defined]

    @property
    def linear(self) -> bool:
        """Whether superposition holds with the effect."""
        return bool(self.cls.linear)  # type: ignore[attr-defined]

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The parameters to fit, in the order of their scores."""
        free = (p for p in parameters_of(self.cls) if p.name not in self.settings)
        spans = self.spans
        return tuple(replace(p, low=spans[p.name][0], high=spans[p.name][1]) if p.name in spans else p for p in free)

    @property
    def size(self) -> Parameter | None:
        """The parameter that says how big the effect is; None for one that is switched by a choice."""
        return next((p for p in self.parameters if p.neutral is not None), None)

    @property
    def label(self) -> str:
        """``channel-gain (channels = odd)``; ``re-hang (from run 4)`` where the third run has that number."""
        told = self.run_numbers
        chosen = ", ".join(
            f"from run {told[k]}" if told.get(k, v) != v else f"{k} = {v:.4g}" if isinstance(v, float) else f"{k} = {v}"
            for k, v in self.settings.items()
        )
        return f"{self.name} ({chosen})" if chosen else self.name

    @property
    def run_numbers(self) -> dict[str, int]:
        """What the campaign calls the run that a setting counts, by the setting; empty where there is none."""
        run = self.settings.get(_COUNTS_RUNS)
        if not isinstance(run, int) or not 1 <= run <= len(self.numbers):
            return {}
        return {_COUNTS_RUNS: self.numbers[run - 1]}

    def values(self, scores: Array) -> dict[str, float]:
        """Parameter values at scores (parameters,), kept within half a range beyond what is plausible.

        And not below what the effect refuses: a fit that leans on that limit has a value there, and a slope inwards.
        """
        found = {}
        for p, e in zip(self.parameters, scores, strict=True):
            mean, sd = prior(p)
            value = mean + sd * float(e)
            low, high = (math.log(p.low), math.log(p.high)) if p.scale == "log" else (p.low, p.high)
            margin = _BEYOND * (high - low)
            value = min(max(value, low - margin), high + margin)
            value = math.exp(value) if p.scale == "log" else value
            found[p.name] = value if p.least is None else max(value, p.least)
        return found

    def scores(self, values: Mapping[str, float]) -> Array:
        """Scores (parameters,) of parameter values; left out ones at their prior's middle."""
        found = []
        for p in self.parameters:
            mean, sd = prior(p)
            if p.name not in values:
                found.append(0.0)
                continue
            value = values[p.name]
            found.append(((math.log(value) if p.scale == "log" else value) - mean) / sd)
        return np.array(found)

    def without(self, size: str) -> Hypothesis:
        """The variant with one of its sizes a setting, where it does nothing; which of them is a choice, and paid for.

        ValueError for a name that is no size of it.
        """
        sizes = {p.name: p.neutral for p in self.parameters if p.neutral is not None}
        if size not in sizes:
            raise ValueError(f"{size!r} is no size of {self.label}; name one of {', '.join(sizes)}")
        return replace(self, settings={**self.settings, size: sizes[size]}, share=self.share / len(sizes))

    def moved(self, scores: Array, step: Array) -> Array:
        """Scores (parameters,) after a step (parameters,) that is straight in the values, not in their logarithms."""
        there = np.asarray(scores + step, dtype=float)
        for k, p in enumerate(self.parameters):
            factor = 1 + prior(p)[1] * float(step[k])
            if p.scale == "log" and factor > _LEAST_LEFT:
                there[k] = scores[k] + math.log(factor) / prior(p)[1]
        return there

    def reach(self, index: int, step: float) -> float:
        """Scores by which a tangent reaches the value that a step of a parameter's score leads to.

        Matrices are straight in values: divided by this, their differences over a step hold no curvature of its scale.
        """
        p = self.parameters[index]
        sd = prior(p)[1]
        return math.expm1(sd * step) / sd if p.scale == "log" else step

    def effect(self, values: Mapping[str, float]) -> Effect | None:
        """The effect itself; None where it refuses the values, or a scenario would: below a parameter's least.

        And, with a warning, where the constructor of somebody else's fails otherwise.
        """
        try:
            return self.made(values)
        except PluginError as error:
            refused(error)
            return None

    def made(self, values: Mapping[str, float]) -> Effect | None:
        """:meth:`effect`, but PluginError where the constructor of somebody else's fails."""
        chosen = {**self.settings, **values}
        if any(p.least is not None and chosen.get(p.name, p.least) < p.least for p in parameters_of(self.cls)):
            return None
        with whose_fault(self.cls, f"effect {self.name!r}", "its constructor"):
            try:
                made: Effect = self.cls(**chosen)
            except ValueError:
                return None
        return made


def refused(error: PluginError) -> None:
    """Say which effect of somebody else's a search goes on without."""
    warnings.warn(f"{error}; the search goes on without it there", EffectPluginWarning, stacklevel=1)


def prior(p: Parameter) -> tuple[float, float]:
    """Mean and standard deviation of a parameter, of its logarithm for a logarithmic scale."""
    if p.scale == "log":
        low, high = math.log(p.low), math.log(p.high)
    else:
        low, high = p.low, p.high
        if p.neutral is not None and low < p.neutral < high:
            return p.neutral, max(high - p.neutral, p.neutral - low) / _RANGE_SD
    return (low + high) / 2, (high - low) / (2 * _RANGE_SD)
