"""Where a screen begins: the values of an effect's parameters that have no size, and a scan of what resonates."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vgvt.data import PluginError
from vgvt.effects.acting import action_of
from vgvt.effects.action import ChannelFilter
from vgvt.effects.elements import Absorber, HingedFlap, SuspensionFrame
from vgvt.effects.parameter import Parameter
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem

BY_ITSELF_M = 0.3
"""How far a bent calibration may see something from where it swings."""
# Of the logarithm of a resonance's frequency.
_STEP = 0.06
# How far past both ends of the band a resonance is still looked for.
_BELOW_BAND, _ABOVE_BAND = 0.85, 1.15
# Beyond this multiple of the band a sensor's own resonance only lifts the end of it, as its closed form says.
_ABOVE = 3.0
# Where a filter's own peak is looked for, and how high above what it does far from there.
_GRID_HZ, _PEAK = np.geomspace(0.5, 2000.0, 1500), 1.5
# An angle with more than this of a range, rad, points anywhere; one with less leans to either side.
_WHOLE_TURN = 6.28
# Shares of the plausible range of what makes a damper strong: a high loss, and that at a low frequency.
_HEAVY = {"loss_factor": 0.85, "frequency_hz": 0.2}
# The damping ratio of what is as wide as half a step to either side; how much narrower is sharp.
_WIDE, _SHARP = _STEP / 2, 3.0


@dataclass(frozen=True, slots=True)
class Scan:
    """Values of the parameters without a neutral one: the defaults, or a scan of ``tuned``, which moves a resonance.

    ``step`` is that of its logarithm. What resonates sharply is also taken as wide as the steps, or it would be met by
    luck alone. A resonance that can lie far above the band is a size there: one start leaves it to the closed form.
    """

    starts: tuple[dict[str, float], ...]
    tuned: str
    step: float


def scan_of(problem: Problem, hypothesis: Hypothesis) -> Scan:
    """The scan of a hypothesis over the campaign's band."""
    defaults = start_values(hypothesis)
    found = _resonant(problem, hypothesis)
    if found is None:
        return Scan((*_turned(hypothesis, defaults), *_heavily_damped(hypothesis, defaults)), "", 0.0)
    scanned, power, first = found
    low, high = math.log(scanned.low), math.log(scanned.high)
    band, starts = problem.measured.frequency_hz, []
    if scanned.unit == "Hz":
        low, high = max(low, math.log(_BELOW_BAND * band[0])), min(high, math.log(_ABOVE_BAND * band[-1]))
    elif scanned.neutral is not None and first > (top := 2 * math.pi * _ABOVE * float(band[-1])):
        low, starts = low + math.log(first / top) / power, [defaults]
    wide, step = _widened(problem, hypothesis, scanned), _STEP
    dense = [(defaults, step), *([({**defaults, **wide}, step)] if wide else [])]
    if _is_whole_thing(problem, hypothesis, scanned, wide):
        # Each answer is an exact one: as wide as twice the steps, half as many will do.
        step *= 2
        dense = [({**defaults, **wide}, step)]
    elif starts:
        # A sensor's own resonance is not sharp.
        step *= 2
        dense = [(start, step) for start, _ in dense]
    elif wide:
        # Sharp ones in half steps: what lies between them is met by the wide ones.
        dense[0] = (defaults, step / 2)
    for start, apart in dense:
        count = max(2, math.ceil((high - low) * power / apart))
        starts += [{**start, scanned.name: float(v)} for v in np.exp(np.linspace(low, high, count))]
        if scanned.unit != "Hz":
            starts += _beyond(problem, hypothesis, scanned, start, apart)
    return Scan(tuple(starts), scanned.name, step / power)


def start_values(hypothesis: Hypothesis) -> dict[str, float]:
    """Defaults of the parameters without a neutral value."""
    return {p.name: float(getattr(hypothesis.cls(), p.name)) for p in hypothesis.parameters if p.neutral is None}


def _is_whole_thing(problem: Problem, hypothesis: Hypothesis, scanned: Parameter, wide: dict[str, float]) -> bool:
    """Whether what is scanned is the size of a thing on the structure that is not sharp: a flap on its hinge."""
    own = start_values(hypothesis)
    sharp = any(value > _SHARP * own[name] * (1 + 1e-9) for name, value in wide.items())
    return bool(wide) and not sharp and scanned.neutral is not None and bool(where_it_swings(problem, hypothesis))


def _turned(hypothesis: Hypothesis, defaults: dict[str, float]) -> list[dict[str, float]]:
    """The defaults, and those with what may have either sign the other way round, an angle by every quarter of a turn.

    A size that is never negative says nothing of an effect that acts the opposite way: a lean to the left is no
    amount of a lean to the right.
    """
    found = [defaults]
    for p in hypothesis.parameters:
        value = defaults.get(p.name, 0.0)
        if p.neutral is not None or not p.low < 0 < p.high:
            continue
        if p.unit == "rad" and p.high - p.low > _WHOLE_TURN:
            others = [value + k * math.pi / 2 for k in (1, 2, -1)]
            others = [v - 2 * math.pi if v > math.pi else v for v in others]
        else:
            others = [-value] if value else []
        found += [{**start, p.name: v} for v in others for start in tuple(found)]
    return found


def _heavily_damped(hypothesis: Hypothesis, defaults: dict[str, float]) -> list[dict[str, float]]:
    """The defaults with a damper that is as strong as plausible, of what is damped by a loss factor at a frequency.

    A mount of clay is a damper more than it is a spring; from one that hardly damps the tangent does not lead there.
    """
    damped = {p.name: p.at(x) for p in hypothesis.parameters if (x := _HEAVY.get(p.name)) and p.neutral is None}
    return [{**defaults, **damped}] if len(damped) == len(_HEAVY) else []


def _resonant(problem: Problem, hypothesis: Hypothesis) -> tuple[Parameter, float, float] | None:
    """The parameter that moves the resonance of what an effect adds, the power of it that the frequency goes with.

    And the angular frequency at its lower end. Which parameter it is shows in the effect's elements, or in what it
    does to a channel, at either end of its range: a frequency, or else what moves it farthest. A hinge moves the
    resonance of its flap by a factor of ten, the arm of the flap's centre of gravity by six at most.
    """
    best, farthest = None, 0.1
    for p in sorted(hypothesis.parameters, key=lambda p: p.unit != "Hz"):
        if p.scale == "log":
            (low, _), (high, _) = (_resonance(problem, hypothesis, {p.name: value}) for value in (p.low, p.high))
            moved = abs(math.log(low / high)) if low and high else 0.0
            if moved > farthest:
                best, farthest = (p, moved / math.log(p.high / p.low), low), moved
            if best is not None and p.unit == "Hz":
                break
    return best


def _beyond(
    problem: Problem, hypothesis: Hypothesis, scanned: Parameter, start: dict[str, float], step: float
) -> list[dict[str, float]]:
    """Starts past both ends of what is scanned, as far as the band goes, by what else moves the resonance.

    The stiffest plausible hinge on the usual arm may leave a flap within the band; on a short arm it is faster.
    """
    band, found = problem.measured.frequency_hz, []
    limits = (2 * math.pi * _BELOW_BAND * float(band[0]), 2 * math.pi * _ABOVE_BAND * float(band[-1]))
    ends = [({**start, scanned.name: value}) for value in (scanned.low, scanned.high)]
    low, high = sorted(ends, key=lambda values: _resonance(problem, hypothesis, values)[0])
    for end, limit, outward in ((low, limits[0], -1.0), (high, limits[1], 1.0)):
        here = _resonance(problem, hypothesis, end)[0]
        for p in hypothesis.parameters:
            if p.name not in start or p.scale != "log":
                continue
            reached = {v: _resonance(problem, hypothesis, {**end, p.name: v})[0] for v in (p.low, p.high)}
            # An effect may refuse some of its values.
            if here == 0 or not all(reached.values()):
                continue
            bound = max(reached, key=lambda v: outward * reached[v])
            whole = outward * math.log(reached[bound] / here)
            wanted = min(whole, outward * math.log(limit / here))
            if whole > 0.1 and wanted > 0:
                count = math.ceil(wanted / step)
                way = np.linspace(0, wanted / whole, count + 1)[1:]
                found += [{**end, p.name: float(end[p.name] * (bound / end[p.name]) ** share)} for share in way]
    return found


def tuned_to(
    problem: Problem, hypothesis: Hypothesis, hz: float
) -> tuple[dict[str, float], tuple[tuple[float, float], ...]] | None:
    """The value by name at which what an effect adds first resonates at a frequency, and where it sits, (x, y) in m.

    None where nothing that it adds to the structure does at a plausible value. A spring's surge has a frequency as an
    absorber has, though no parameter of it is one.
    """
    found = _resonant(problem, hypothesis)
    places = where_it_swings(problem, hypothesis)
    if found is None or not places:
        return None
    p = found[0]
    low = _resonance(problem, hypothesis, {p.name: p.low})[0]
    value = p.low * (2 * math.pi * hz / low) ** (1 / _power(problem, hypothesis, p))
    return ({p.name: value}, places) if p.low <= value <= p.high else None


def where_it_swings(
    problem: Problem, hypothesis: Hypothesis, values: dict[str, float] | None = None
) -> tuple[tuple[float, float], ...]:
    """Where what an effect adds to the structure swings in every run, (x, y) in m each; empty where nothing of it does.

    ``values`` are its parameters', by default those in the middle of what is plausible.
    """
    effect = hypothesis.effect(values or {p.name: p.at(0.5) for p in hypothesis.parameters})
    if effect is None:
        return ()
    try:
        elements = action_of(effect, problem.scenario, 0).elements
    except ValueError:
        return ()
    found: list[tuple[float, float]] = []
    for e in elements:
        if isinstance(e, Absorber):
            found.append((float(e.position_m[0]), float(e.position_m[1])))
        elif isinstance(e, HingedFlap):
            found.append((float(e.centre_of_gravity_m[0]), float(e.centre_of_gravity_m[1])))
        elif isinstance(e, SuspensionFrame):
            x, y, _ = problem.scenario.suspension.hook_m
            found.append((float(x), float(y)))
    return tuple(dict.fromkeys(found))


def tuned_alike(
    problem: Problem, one: Hypothesis, values: dict[str, float], other: Hypothesis
) -> dict[str, float] | None:
    """Values with which another effect swings as fast as ``one`` does with its; None where nothing swings.

    What both have by the same name is kept, the rest is in its middle. As far as what tunes it reaches: a heavier flap
    may need a hinge that is stiffer than plausible.
    """
    found = _resonant(problem, other)
    own = {p.name: values.get(p.name, p.at(0.5)) for p in other.parameters}
    here, there = _resonance(problem, one, values)[0], _resonance(problem, other, own)[0]
    if found is None or not here or not there:
        return None
    p = found[0]
    value = own[p.name] * (here / there) ** (1 / _power(problem, other, p))
    return {**own, p.name: min(max(value, p.low), p.high)}


def _power(problem: Problem, hypothesis: Hypothesis, p: Parameter) -> float:
    """The power of a parameter that a resonance goes with, of either sign."""
    (low, _), (high, _) = (_resonance(problem, hypothesis, {p.name: value}) for value in (p.low, p.high))
    return math.log(high / low) / math.log(p.high / p.low)


def in_band(problem: Problem, hypothesis: Hypothesis) -> tuple[dict[str, float], ...]:
    """Coarse steps through the band of a thing that swings as a whole, as wide as it plausibly is; none of others.

    A few of its sizes would leave out most of where it swings.
    """
    found = _resonant(problem, hypothesis)
    if found is None or not _is_whole_thing(problem, hypothesis, found[0], _widened(problem, hypothesis, found[0])):
        return ()
    return scan_of(problem, hypothesis).starts[::2]


def _widened(problem: Problem, hypothesis: Hypothesis, scanned: Parameter) -> dict[str, float]:
    """The parameter that damps a resonance, at what makes it as wide as the steps; empty where it nearly is."""
    for p in hypothesis.parameters:
        if p.scale != "log" or p.neutral is not None or p.name == scanned.name:
            continue
        (one, low), (other, high) = (_resonance(problem, hypothesis, {p.name: value}) for value in (p.low, p.high))
        if one and other and low and high and abs(math.log(one / other)) < 0.1 < math.log(high / low):
            power = math.log(high / low) / math.log(p.high / p.low)
            wide, stated = p.low * (_WIDE / low) ** (1 / power), float(getattr(hypothesis.cls(), p.name))
            if wide <= _SHARP * stated:
                # What multiplies a record shows its damping at once: too high a peak is worse than none.
                return {p.name: min(_SHARP * stated, p.high)} if scanned.neutral is not None else {}
            return {p.name: wide}
    return {}


def _resonance(problem: Problem, hypothesis: Hypothesis, values: dict[str, float]) -> tuple[float, float]:
    """Angular frequency and damping ratio of the first resonance that an effect adds; zeros where it adds none."""
    values_at = {p.name: p.at(0.5) for p in hypothesis.parameters}
    effect = hypothesis.effect({**values_at, **values})
    if effect is None:
        return 0.0, 0.0
    # In the run in which it acts: the last is one where things between runs have happened.
    for run in reversed(range(len(problem.measured.runs))):
        try:
            action = action_of(effect, problem.scenario, run)
        except ValueError:
            return 0.0, 0.0
        for own in (*_own_resonances(action.elements), *_of_channels(action.channels)):
            return own
    return 0.0, 0.0


def _of_channels(changes: Sequence[object]) -> list[tuple[float, float]]:
    """Angular frequencies and damping ratios of the peaks that filters put on channels."""
    found = []
    for change in changes:
        if isinstance(change, ChannelFilter):
            try:
                height = np.abs(change.response(_GRID_HZ))
            except PluginError:  # beyond the lines that it was asked for before
                continue
            peak = int(height.argmax())
            if height[peak] > _PEAK * max(height[0], height[-1]):
                found.append((2 * math.pi * float(_GRID_HZ[peak]), 0.5 * float(height[0] / height[peak])))
    return found


def _own_resonances(elements: Sequence[object]) -> list[tuple[float, float]]:
    """Angular frequencies of what elements hold, and damping ratios there."""
    found = []
    for e in elements:
        if isinstance(e, Absorber | SuspensionFrame):
            mass, stiffness, damping = e.mass_kg, e.stiffness_n_per_m, e.damping_n_s_per_m
        elif isinstance(e, HingedFlap):
            arm = math.dist(e.hinge_m, e.centre_of_gravity_m)
            mass, stiffness = e.mass_kg * arm**2 + min(e.inertia_kg_m2), e.stiffness_n_m_per_rad
            damping = e.damping_n_m_s_per_rad
        else:
            continue
        found.append((math.sqrt(stiffness / mass), damping / (2 * math.sqrt(stiffness * mass))))
    return found
