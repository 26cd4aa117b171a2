"""Screen the catalogue: how much χ² each effect could buy beyond what the declared uncertainties could.

Data and each candidate's change of the prediction are projected off the tangent space of the calibrated
unknowns (one QR); the effect's sizes then have a closed form. Resonances are scanned.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.elements import Absorber, HingedFlap, SuspensionFrame
from vgvt.effects.parameter import Parameter
from vgvt.reconcile.fit import Fit
from vgvt.reconcile.grouping import Group, NoStructureError
from vgvt.reconcile.hypothesis import Hypothesis
from vgvt.reconcile.misfit import data_misfit
from vgvt.reconcile.surrogate import anchor

Array = NDArray[np.float64]
_COARSE, _FINE = 0.06, 0.015
_CHECKED, _WORTH_REFINING = 3, 1.0
_SMALL_SHARE = 0.2
_SMALL_SD = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class Screened:
    """A variant with the values to start a fit from, and the nats it could buy at best: half the drop of χ².

    ``remaining`` is the χ² that it would leave, ``start`` (u,) the scores it was screened at.
    """

    hypothesis: Hypothesis
    values: dict[str, float]
    gain_nats: float
    visible: bool = True
    remaining: float = math.inf
    start: Array | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Screen:
    """The null fit as a place to stand on: its groups, misfit, and the basis of what its scores can imitate."""

    fit: Fit
    groups: tuple[Group, ...]
    basis: Array
    misfit: Array
    left: Array

    @classmethod
    def of(cls, null: Fit) -> Screen:
        """Stand on a fit without hypotheses, or on one whose hypotheses stay."""
        stacked = np.vstack([null.tangent, np.eye(null.scores.size)])
        basis, _ = np.linalg.qr(stacked)
        here = anchor(null.problem, null.u, null.hypotheses, null.e, slopes=False)
        misfit = np.concatenate([data_misfit(null.problem, null.predicted, null.sigma), null.scores])
        return cls(null, here.assembled, basis, misfit, misfit - basis @ (basis.T @ misfit))

    def change(self, hypothesis: Hypothesis, values: dict[str, float]) -> Array | None:
        """Change of the misfit vector by an effect added with some values; None where it is impossible."""
        null = self.fit
        fixed = _with_values(hypothesis, values)
        try:
            there = anchor(
                null.problem, null.u, (*null.hypotheses, fixed), null.e, slopes=False,
                fast=self.groups,
            )  # fmt: skip
            predicted = there.predict(null.u, null.e)
        except NoStructureError:
            return None
        moved = data_misfit(null.problem, predicted, null.sigma) - self.misfit[: null.points]
        return np.concatenate([moved, np.zeros(null.scores.size)])

    def projected(self, vectors: Array) -> Array:
        """What of vectors (2 N + scores, k) no score can imitate."""
        return np.asarray(vectors - self.basis @ (self.basis.T @ vectors))


def screen(
    null: Fit, hypotheses: Sequence[Hypothesis], progress: Callable[[float, str], None] | None = None
) -> tuple[Screened, ...]:
    """All variants by what they could buy, best first; an effect that leaves A/F alone is not ``visible``."""
    stand = Screen.of(null)
    found = []
    for k, hypothesis in enumerate(hypotheses):
        if progress is not None:
            progress(k / len(hypotheses), f"screen {hypothesis.name}")
        best = _best(stand, hypothesis)
        found.append(replace(best, remaining=float(stand.left @ stand.left) - 2 * best.gain_nats, start=null.u))
    return tuple(sorted(found, key=lambda s: -s.gain_nats))


def _best(stand: Screen, hypothesis: Hypothesis) -> Screened:
    grid = _grid(stand, hypothesis)
    sized = [_sized(stand, hypothesis, values) for values in grid]
    promising = sorted(sized, key=lambda s: -s.gain_nats)[:_CHECKED]
    best = max((_checked(stand, s) for s in promising), key=lambda s: s.gain_nats)
    if len(grid) > 1 and best.gain_nats > _WORTH_REFINING:
        scanned = next(name for name in grid[0] if grid[0][name] != grid[1][name])
        centre, switches = best.values[scanned], {p.name for p in hypothesis.parameters if p.neutral is not None}
        others = {k: v for k, v in best.values.items() if k not in switches}
        steps = math.exp(_FINE) ** np.array([-3, -2, -1, 1, 2, 3])
        again = [_sized(stand, hypothesis, {**others, scanned: float(centre * s)}) for s in steps]
        again = sorted(again, key=lambda s: -s.gain_nats)[:1]
        best = max([best, *(_checked(stand, s) for s in again)], key=lambda s: s.gain_nats)
    return best


def _checked(stand: Screen, s: Screened) -> Screened:
    """What a variant buys in truth at the sizes that the closed form gave, or at half of them: effects saturate."""
    if not s.visible:
        return s
    used = [p for p in s.hypothesis.parameters if p.neutral is not None]
    return max(
        (_at(stand, s.hypothesis, {**s.values, **v}) for v in _around(used, s.values)), key=lambda c: c.gain_nats
    )


def _sized(stand: Screen, hypothesis: Hypothesis, start: dict[str, float]) -> Screened:
    """The best sizes of an effect whose other values are given, by the closed form, checked at what it gives."""
    switches = [p for p in hypothesis.parameters if p.neutral is not None and p.name not in start]
    neutral = {p.name: float(p.neutral) for p in switches if p.neutral is not None}
    if not switches:
        return _at(stand, hypothesis, start)
    left = stand.left
    columns, steps, used = [], [], []
    for p in switches:
        step = step_from_neutral(p)
        moved = stand.change(hypothesis, {**start, **neutral, p.name: neutral[p.name] + step})
        if moved is not None and np.abs(moved).max() > 1e-9:
            columns.append(stand.projected(moved[:, None])[:, 0] / step)
            steps.append(step)
            used.append(p)
    if not columns:
        return Screened(hypothesis, {**start, **{p.name: _middle(p) for p in switches}}, 0.0, visible=False)
    amounts = _non_negative(np.array(columns).T, left, [p.scale == "log" for p in used])
    values = {**start, **neutral}
    for p, amount in zip(used, amounts, strict=True):
        values[p.name] = neutral[p.name] + float(amount)
    predicted = left + np.array(columns).T @ amounts
    linear = 0.5 * float(left @ left - predicted @ predicted)
    inside = {p.name: _inside(p, values[p.name]) for p in used}
    return Screened(hypothesis, {**values, **inside}, linear)


def _at(stand: Screen, hypothesis: Hypothesis, values: dict[str, float]) -> Screened:
    moved = stand.change(hypothesis, values)
    if moved is None:
        return Screened(hypothesis, values, -math.inf)
    visible = bool(np.abs(moved).max() > 1e-9)
    before = stand.left
    after = stand.projected((stand.misfit + moved)[:, None])[:, 0]
    return Screened(hypothesis, values, 0.5 * float(before @ before - after @ after), visible)


def _around(used: list[Parameter], inside: dict[str, float]) -> Iterator[dict[str, float]]:
    """The closed form's sizes, and half of them where they reach far: an effect saturates."""
    yield inside
    if any(abs(inside[p.name] - (p.neutral or 0.0)) > 0.1 * (p.high - p.low) for p in used):
        yield {p.name: _inside(p, (p.neutral or 0.0) + 0.5 * (inside[p.name] - (p.neutral or 0.0))) for p in used}


def _grid(stand: Screen, hypothesis: Hypothesis) -> list[dict[str, float]]:
    """Values of the parameters without a neutral one: the default, or a scan of what moves a resonance."""
    defaults = start_values(hypothesis)
    scanned = _resonant(stand, hypothesis)
    if scanned is None:
        return [defaults]
    low, high = math.log(scanned.low), math.log(scanned.high)
    if scanned.unit == "Hz":
        band = stand.fit.problem.measured.frequency_hz
        low, high = max(low, math.log(0.85 * band[0])), min(high, math.log(1.15 * band[-1]))
    count = max(2, math.ceil((high - low) / _COARSE))
    return [{**defaults, scanned.name: float(v)} for v in np.exp(np.linspace(low, high, count))]


def start_values(hypothesis: Hypothesis) -> dict[str, float]:
    """Defaults of the parameters without a neutral value."""
    return {p.name: float(getattr(hypothesis.cls(), p.name)) for p in hypothesis.parameters if p.neutral is None}


def _resonant(stand: Screen, hypothesis: Hypothesis) -> Parameter | None:
    """The parameter that moves the resonance of what an effect adds, by comparing its elements."""
    problem = stand.fit.problem
    middle = {p.name: _middle(p) for p in hypothesis.parameters}
    candidates = sorted(hypothesis.parameters, key=lambda p: (p.unit != "Hz", p.neutral is not None))
    for p in candidates:
        if p.scale != "log":
            continue
        own = []
        for value in (p.low, p.high):
            effect = hypothesis.effect({**middle, p.name: value})
            if effect is None:
                break
            try:
                own.append(_own_frequencies(effect.act(problem.scenario, len(problem.measured.runs) - 1).elements))
            except ValueError:
                break
        if len(own) == 2 and own[0] and own[1] and abs(math.log(own[0][0] / own[1][0])) > 0.1:
            return p
    return None


def _own_frequencies(elements: Sequence[object]) -> list[float]:
    found = []
    for e in elements:
        if isinstance(e, Absorber | SuspensionFrame):
            found.append(math.sqrt(e.stiffness_n_per_m / e.mass_kg))
        elif isinstance(e, HingedFlap):
            arm = math.dist(e.hinge_m, e.centre_of_gravity_m)
            found.append(math.sqrt(e.stiffness_n_m_per_rad / (e.mass_kg * arm**2 + min(e.inertia_kg_m2))))
    return found


def _non_negative(columns: Array, left: Array, positive: list[bool]) -> Array:
    """Least-squares amounts (k,), those of positive quantities not below zero."""
    best, amounts = math.inf, np.zeros(columns.shape[1])
    free = [k for k, p in enumerate(positive) if p]
    for off in itertools.chain.from_iterable(itertools.combinations(free, r) for r in range(len(free) + 1)):
        on = [k for k in range(columns.shape[1]) if k not in off]
        trial = np.zeros(columns.shape[1])
        if on:
            trial[on] = -np.linalg.lstsq(columns[:, on], left, rcond=1e-10)[0]
        if any(trial[k] < 0 for k in free):
            continue
        cost = float(np.sum((left + columns @ trial) ** 2))
        if cost < best:
            best, amounts = cost, trial
    return amounts


def step_from_neutral(p: Parameter) -> float:
    """A step from the neutral value in which the effect is linear."""
    return _SMALL_SHARE * p.low if p.scale == "log" else _SMALL_SD * (p.high - p.low) / 4


def _middle(p: Parameter) -> float:
    return math.sqrt(p.low * p.high) if p.scale == "log" else (p.low + p.high) / 2


def _inside(p: Parameter, value: float) -> float:
    return min(max(value, p.low), p.high)


def _with_values(hypothesis: Hypothesis, values: dict[str, float]) -> Hypothesis:
    """The variant with every value a setting: nothing left to fit."""
    return Hypothesis(hypothesis.cls, {**hypothesis.settings, **values}, hypothesis.share)
