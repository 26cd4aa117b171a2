"""A fitted model as a place to stand on: what an effect would change there, and what the unknowns could make up for.

An effect that the unknowns imitate well is seen in what is left between two large changes. Its derivative is
therefore taken at no size at all, and at a finite size the unknowns are moved along before χ² is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from vgvt.effects.parameter import Parameter
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.fitting.misfit import data_misfit, jacobian
from vgvt.reconcile.prediction.adjacent import beside, groups_at
from vgvt.reconcile.prediction.first_order import FirstOrder
from vgvt.reconcile.prediction.grouping import Group, NoStructureError
from vgvt.reconcile.prediction.scheduled import whole_and_shares
from vgvt.reconcile.prediction.sides import Side, sides_of
from vgvt.reconcile.prediction.surrogate import Anchor, anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, at_rest
from vgvt.reconcile.search.follow import Follower, Reached
from vgvt.simulation.attached import vanishes

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Change = Callable[[Hypothesis, dict[str, float]], tuple[Array, bool] | None]
_SMALL_SHARE, _SMALL_SD = 0.2, 0.02
# Beyond a joint's own step by this factor, in steps ever longer, from a share of the usual step on: of what is large
# where it begins to be plausible, a fifth of that swings within the band already.
_MORE_THAN_A_JOINT, _LONGER, _LONGER_STEPS, _AT_FIRST = 2.0, 3.0, 7, 1 / 27
# Twice the size does more than this many times as much: not two, but four times.
_SQUARED = 3.0
# Standard deviations by which ends of records must show.
_NOTHING_RINGS = 1e-6
# Derivatives that are kept: those that what is looked at closer asks for again.
_KNOWN = 128


def _at_rest(null: Fit) -> Fit:
    """The fit as if its records had ended at rest: what their ends leave out is taken off data, prediction and slopes.

    Motions know nothing of ends, and what the unknowns imitate must be seen with the same eyes as what effects do.
    """
    measured = null.problem.measured
    problem = at_rest(null.problem)

    def of(which: Problem, slopes: bool) -> Anchor:
        # What ends do to slopes is small, and so is where the others were taken.
        return anchor(which, null.u, null.hypotheses, null.e, slopes=slopes, rough=True)

    predicted = of(problem, slopes=False).predict(null.u, null.e)
    if np.abs((predicted - null.predicted) / measured.sigma).max() < _NOTHING_RINGS:
        return null
    rest, ringing = (
        jacobian(of(which, slopes=True), null.u, null.e, there, null.sigma)
        for which, there in ((problem, predicted), (null.problem, null.predicted))
    )
    values = measured.values + predicted - null.predicted
    problem = replace(problem, measured=replace(problem.measured, values=values))
    return replace(null, problem=problem, predicted=predicted, tangent=null.tangent + rest - ringing)


@dataclass(frozen=True, slots=True, eq=False)
class Stand:
    """A fit with the basis (2 N + scores, scores) of what its scores imitate, and its misfit with and without that.

    ``inverse`` (scores, scores) is of the tangent's normal matrix, and ``back`` leads by it to what the fit foretells;
    ``motions`` are what slopes are taken from, ``known`` the last of these, and ``sides`` are what its hypotheses'
    parameters change.
    """

    fit: Fit
    here: Anchor
    motions: FirstOrder | None
    basis: Array
    misfit: Array
    left: Array
    inverse: Array
    back: Follower
    sides: Sequence[Side] | None
    known: dict[tuple[Any, ...], Array | None] = field(default_factory=dict)

    @classmethod
    def of(cls, null: Fit) -> Stand:
        """Stand on a fit without hypotheses, or on one whose hypotheses stay."""
        null = _at_rest(null)
        stacked = np.vstack([null.tangent, np.eye(null.scores.size)])
        basis, _ = np.linalg.qr(stacked)
        here = anchor(null.problem, null.u, null.hypotheses, null.e, slopes=False)
        misfit = np.concatenate([data_misfit(null.problem, null.predicted, null.sigma), null.scores])
        inverse = scipy.linalg.inv(null.tangent.T @ null.tangent + np.eye(null.scores.size))
        left = misfit - basis @ (basis.T @ misfit)
        # What joints show along their way is another matter beside something else.
        straight = all(h.linear for h in null.hypotheses)
        sides = sides_of(here.structures, null.u, null.hypotheses, null.e, here.assembled) if straight else None
        back = Follower.back(null, inverse)
        return cls(null, here, FirstOrder.of(here), basis, misfit, left, inverse, back, sides)

    @property
    def groups(self) -> tuple[Group, ...]:
        """The structures that it stands on."""
        return self.here.assembled

    @property
    def cost(self) -> float:
        """Least square sum of misfit and scores that the linearised unknowns reach alone."""
        return float(self.left @ self.left)

    def change(self, hypothesis: Hypothesis, values: dict[str, float]) -> Array | None:
        """Change of the misfit vector by an effect added with some values; None where it is impossible."""
        found = self._changed(hypothesis, values)
        return None if found is None else found[0]

    def _changed(self, hypothesis: Hypothesis, values: dict[str, float]) -> tuple[Array, bool] | None:
        """:meth:`change`, and whether the effect gives the structure a joint more."""
        null = self.fit
        added = (*null.hypotheses, _with_values(hypothesis, values))
        near = beside(null.problem, null.u, self.groups, added, null.e)
        try:
            if near is not None and self._unmoved(near):
                return self._change_to(null.predicted + self._of_filters(added, near)), False
            there = anchor(null.problem, null.u, added, null.e, slopes=False, groups=near)
            predicted = there.predict(null.u, null.e)
        except NoStructureError:
            return None
        return self._change_to(predicted), self._wider(there.assembled)

    def _change_to(self, predicted: ComplexArray) -> Array:
        """Change of the misfit vector by another prediction (C, L)."""
        null = self.fit
        moved = data_misfit(null.problem, predicted, null.sigma) - self.misfit[: null.points]
        return np.concatenate([moved, np.zeros(null.scores.size)])

    def _unmoved(self, there: tuple[Group, ...]) -> bool:
        """Whether structures and sensors are those it stands on: what there is to see happens to channels alone."""
        pairs = [(g, next((o for o in self.groups if o.structure is g.structure), None)) for g in there]
        return all(
            o is not None and np.array_equal(g.rows, o.rows[chosen := np.isin(o.channels, g.channels)])
            and np.array_equal(g.masses_kg, o.masses_kg[chosen])
            for g, o in pairs
        )  # fmt: skip

    def _of_filters(self, added: tuple[Hypothesis, ...], there: tuple[Group, ...]) -> ComplexArray:
        """Change (C, L) of the prediction by what effects do to channels, the structures being those it stands on."""
        null = self.fit
        plain = self.here.chain(null.u, null.e)
        filtered = replace(self.here, hypotheses=added, assembled=there, filtered=True).chain(null.u, null.e)
        return np.asarray(null.predicted * (filtered / plain - 1))

    def slope(self, hypothesis: Hypothesis, values: dict[str, float], p: Parameter) -> Array | None:
        """Derivative of the misfit vector in a size at its neutral value; None if impossible.

        The last ones are kept, and changes between runs that differ in their course alone have one for all.
        """
        key = (hypothesis.cls, repr(sorted(hypothesis.settings.items())), repr(sorted(values.items())), p.name)
        if key in self.known:
            return self.known[key]
        course = whole_and_shares(self.fit.problem, hypothesis, values, p, step_from_neutral(p))
        if course is None or course[0].settings == hypothesis.settings:
            found = self._slope(hypothesis, values, p)
        else:
            whole = self.slope(course[0], values, p)
            found = None if whole is None else self._by_run(course[1]) * whole
        if len(self.known) >= _KNOWN:
            del self.known[next(iter(self.known))]
        self.known[key] = found
        return found

    def _by_run(self, shares: Array) -> Array:
        """Factors (runs,) for the entries (2 N + scores,) of a change of the misfit vector."""
        problem = self.fit.problem
        runs = np.array([c.run for c in problem.measured.channels])[problem.split.train]
        data = np.repeat(shares[runs], problem.measured.frequency_hz.size)
        return np.concatenate([data, data, np.ones(self.fit.scores.size)])

    def _slope(self, hypothesis: Hypothesis, values: dict[str, float], p: Parameter) -> Array | None:
        """:meth:`slope`, computed.

        A joint more, however stiff, is one coordinate more to answer with: a small step that is there at any size. It
        is taken off, and steps are as long as it takes to be more than that.
        """
        step = step_from_neutral(p)

        def at(change: Change, size: float) -> tuple[Array, bool] | None:
            return change(hypothesis, {**values, p.name: float(p.neutral or 0.0) + size})

        found = None if self.motions is None else at(self._linear_change, step)
        if found is not None and not found[1]:
            return found[0] / step
        if found is not None:
            slope = _beyond_a_joint(lambda size: at(self._linear_change, size), step)
            if slope is not None:
                return slope
        near = at(self._changed, step)
        if near is None:
            return None
        if near[1]:
            return _beyond_a_joint(lambda size: at(self._changed, size), step)
        # Curvature is taken off by a second step.
        twice = at(self._changed, 2 * step)
        return near[0] / step if twice is None else (4 * near[0] - twice[0]) / (2 * step)

    def squared(self, hypothesis: Hypothesis, values: dict[str, float], p: Parameter) -> tuple[float, Array] | None:
        """A small size and its change of the misfit vector where that grows with the square of the size, else None.

        So does what a resonance far above the band does to a channel; whatever moves the structure grows as a slope.
        """
        neutral, step = float(p.neutral or 0.0), step_from_neutral(p)
        added = (*self.fit.hypotheses, _with_values(hypothesis, {**values, p.name: neutral + step}))
        near = beside(self.fit.problem, self.fit.u, self.groups, added, self.fit.e)
        if near is None or not self._unmoved(near):
            return None
        once, twice = (self.change(hypothesis, {**values, p.name: neutral + k * step}) for k in (1, 2))
        if once is None or twice is None or not np.linalg.norm(twice) > _SQUARED * np.linalg.norm(once):
            return None
        return step, once

    def _wider(self, there: tuple[Group, ...]) -> bool:
        """Whether structures have a joint that those it stands on have not, and that is there at no size at all."""
        own = {j for g in self.groups for j in g.structure.joints}
        return any(j not in own and not vanishes(j) for g in there for j in g.structure.joints)

    def _linear_change(self, hypothesis: Hypothesis, values: dict[str, float]) -> tuple[Array, bool] | None:
        """:meth:`_changed` to first order in what structure and measuring chain become; None where there is none."""
        null, problem = self.fit, self.fit.problem
        added = (*null.hypotheses, _with_values(hypothesis, values))
        there = groups_at(problem, null.u, added, null.e, self.groups)
        if there is None or self.motions is None:
            return None
        moved = self.motions.change(there)
        if moved is None:
            return None
        out = self.here.chain(null.u, null.e) * moved
        if any(g.filtered for g in there):
            try:
                out = out + self._of_filters(added, there)
            except NoStructureError:  # a filter of somebody else's fails there
                return None
        change = data_misfit(problem, problem.measured.values + out, null.sigma)
        return np.concatenate([change, np.zeros(null.scores.size)]), self._wider(there)

    def projected(self, vectors: Array) -> Array:
        """What of vectors (2 N + scores, …) no score can imitate."""
        return np.asarray(vectors - self.basis @ (self.basis.T @ vectors))

    def linearly_followed(self, hypothesis: Hypothesis, values: dict[str, float]) -> float | None:
        """Least square sum with an effect at some values, the unknowns following in one step; None if impossible."""
        moved = self.change(hypothesis, values)
        if moved is None:
            return None
        left = self.left + self.projected(moved)
        return float(left @ left)

    def followed(
        self, hypothesis: Hypothesis, values: dict[str, float], sizes: dict[str, float] | None = None
    ) -> tuple[float, Array] | None:
        """Least square sum with an effect at some values, the unknowns following, and their scores; None if impossible.

        ``sizes`` are the neutral values of what there can be a part of, by default of all that have one. Newton's
        steps with the tangent of this stand, the response itself being computed anew at each.
        """
        there = self._followed(Follower.towards_data(self.fit, self.inverse), hypothesis, values, sizes)
        return None if there is None else (there.cost, there.scores)

    def shown(self, hypothesis: Hypothesis, values: dict[str, float], sizes: dict[str, float]) -> Array | None:
        """What an effect at some values shows (2 N + scores,) that the unknowns, following, do not make up for.

        Free of noise and of curvature that they have in common with the effect, which :meth:`projected` takes for
        something to be seen. None if impossible.
        """
        there = self._followed(self.back, hypothesis, values, sizes)
        return None if there is None else np.concatenate([there.misfit, there.scores - self.fit.scores])

    def _followed(
        self, follower: Follower, hypothesis: Hypothesis, values: dict[str, float], sizes: dict[str, float] | None
    ) -> Reached | None:
        null = self.fit
        added = (*null.hypotheses, _with_values(hypothesis, values))
        try:
            here = anchor(null.problem, null.u, added, null.e, beside=self.groups, sides=self.sides)
        except NoStructureError:
            return None
        return follower.follow(here, lambda: self._along(hypothesis, values, sizes))

    def _along(self, hypothesis: Hypothesis, values: dict[str, float], sizes: dict[str, float] | None) -> Array | None:
        """What its sizes would do to the misfit (2 N,) if they did it linearly; None where no slope is known."""
        if sizes is None:
            mine = (p for p in hypothesis.parameters if p.name in values)
            sizes = {p.name: float(p.neutral) for p in mine if p.neutral is not None}
        out = None
        for p in (p for p in hypothesis.parameters if p.name in sizes):
            amount = values[p.name] - sizes[p.name]
            slope = self.slope(hypothesis, {**values, **sizes}, p) if amount else None
            if slope is not None:
                out = amount * slope if out is None else out + amount * slope
        return None if out is None else out[: self.fit.points]


def _beyond_a_joint(change: Callable[[float], tuple[Array, bool] | None], step: float) -> Array | None:
    """The slope between two sizes that do more than a joint does at no size, about a ``step``; None without any.

    Of the largest sizes where none does more: what hangs on the level, and not on the size, has no slope.
    """
    slope, size = None, _AT_FIRST * step
    before = change(size)
    for _ in range(_LONGER_STEPS):
        there = change(_LONGER * size)
        if before is None or there is None:
            break
        slope = (there[0] - before[0]) / ((_LONGER - 1) * size)
        if np.linalg.norm(size * slope) > _MORE_THAN_A_JOINT * np.linalg.norm(before[0] - size * slope):
            break
        size, before = _LONGER * size, there
    return slope


def step_from_neutral(p: Parameter) -> float:
    """A step from the neutral value in which the effect is nearly linear."""
    return _SMALL_SHARE * p.low if p.scale == "log" else _SMALL_SD * (p.high - p.low) / 4


def _with_values(hypothesis: Hypothesis, values: dict[str, float]) -> Hypothesis:
    """The variant with every value a setting: nothing left to fit."""
    return replace(hypothesis, settings={**hypothesis.settings, **values})
