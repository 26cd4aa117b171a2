"""Reactions of nonlinear joints over a whole record: the linear structure by its poles, the laws step by step.

A sweep of a real test is far too fast for a lightly damped mode to settle, so that the amplitude at a joint is
not that of a steady state at the sweep's frequency. What a joint does to the rest of a *linear* structure is a
convolution; only that is marched, and only the part of the joint's force that the linear model lacks. Everything
else stays exact in the frequency domain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.describing import Law

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_SMALL = 1e-3
# Steps after which it is asked whether a march has run away.
_LOOKED_AFTER = 500


@dataclass(frozen=True, slots=True, eq=False)
class Memory:
    """How joints answer to what acts on them: x(ω) = Σ out · into / (iω - poles) + ``at_once``, real parts.

    ``poles`` (M,), rad/s, one of each pair; ``out`` (J, M), the pair's factor of two in it; ``into`` (M, J);
    ``at_once`` (J, J) is the flexibility of all faster modes.
    """

    poles: ComplexArray
    out: ComplexArray
    into: ComplexArray
    at_once: Array


def marched(linear: Array, memory: Memory, laws: Sequence[Sequence[Law]], step_s: float) -> Array:
    """Extra reactions (R, J, N) of the joints, over what their stiffness in the linear structure does.

    ``linear`` (R, J, N) are the motions of the linear structure under the measured force, every ``step_s``;
    ``laws`` those of every run and joint. The law is met at every step's end. Forces are straight between steps;
    with friction constant in each, so that a force that stops the joint's motion does not ring.
    """
    rubbing = any(law.friction > 0 for row in laws for law in row)
    grown, new, pushed = _step(memory, step_s, held=rubbing)
    yields = (memory.out @ new).real + memory.at_once
    own = np.diag(yields).copy()
    across = np.ascontiguousarray((yields - np.diag(own)).T)
    law = _Laws.of(laws, own)
    out = np.ascontiguousarray(memory.out.T)
    runs, joints, count = linear.shape
    moved = np.ascontiguousarray(linear.transpose(2, 0, 1))
    reaction = np.zeros((count, runs, joints))
    state = np.zeros((runs, memory.poles.size), dtype=complex)
    x, g, spring = np.zeros((runs, joints)), np.zeros((runs, joints)), np.zeros((runs, joints))
    # What a trial step of a fit makes of a joint may run away: that is said by values, not by a warning.
    with np.errstate(over="ignore", invalid="ignore"):
        for n in range(1, count):
            if n % _LOOKED_AFTER == 0 and not np.isfinite(g).all():
                reaction[n:] = np.nan
                break
            state = state * grown + g @ pushed
            free = moved[n] - (state @ out).real - g @ across
            if rubbing:
                # Sticking first: what would it take to hold the joint where it was?
                needed = (free - x) / own - spring
                rubbed = np.minimum(np.maximum(needed, -law.friction), law.friction)
                spring = law.spring(free - own * rubbed)
                g = rubbed + spring
                x = np.where(rubbed == needed, x, free - own * g)
            else:
                g = law.spring(free)
            reaction[n] = g
    if rubbing:
        # A force that is constant in every step is, at its ends, the mean of two.
        reaction[:-1] = (reaction[:-1] + reaction[1:]) / 2
    return np.ascontiguousarray(reaction.transpose(1, 2, 0))


def _step(memory: Memory, step_s: float, *, held: bool) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """A step's growth (M,), what the force at its end does (M, J), and what that has become one step on (J, M).

    The state goes without what the last force did to it: one product a step.
    """
    a = memory.poles * step_s
    grown = np.exp(a)
    small = np.abs(a) < _SMALL
    safe = np.where(small, 1.0, a)
    # Integrals of exp(a (1 - s)) and of s exp(a (1 - s)) over a step.
    whole = np.where(small, 1 + a / 2, (grown - 1) / safe)
    rising = whole if held else np.where(small, 0.5 + a / 6, (grown - 1 - a) / safe**2)
    new = step_s * rising[:, None] * memory.into
    pushed = grown[:, None] * new + step_s * (whole - rising)[:, None] * memory.into
    return grown, new, np.ascontiguousarray(pushed.T)


@dataclass(frozen=True, slots=True, eq=False)
class _Laws:
    """Laws of all runs and joints as arrays (R, J), with what solves them in closed form.

    ``own`` (J,) is what a unit force moves its joint by within the step. With y from the unloaded state, the law
    and x = free - own g are ``soft`` y + own T(y) = q: a straight line within the band, a cubic beyond.
    """

    own: Array
    rest: Array
    offset: Array
    soft: Array
    friction: Array
    band: Array
    firm: Array
    cubic: Array
    reach: Array
    bent: bool

    @classmethod
    def of(cls, laws: Sequence[Sequence[Law]], own: Array) -> _Laws:
        def column(name: str) -> Array:
            return np.array([[float(getattr(law, name)) for law in row] for row in laws])

        cubic, friction, soft = column("cubic"), column("friction"), 1 - own * column("modelled")
        firm, bent = soft + own * column("stiffness"), own * cubic
        reach = 2 * np.sqrt(firm / (3 * np.where(bent > 0, bent, 1.0)))
        return cls(
            own, column("rest"), own * column("load") + soft * column("rest"), soft, friction, soft * column("play"),
            firm, bent, reach, bool(cubic.any()),
        )  # fmt: skip

    def spring(self, free: Array) -> Array:
        """The spring's extra force g (R, J) where it moves the joint to free - own g about rest."""
        q = free + self.offset
        inner = np.minimum(np.maximum(q, -self.band), self.band)
        outer = q - inner
        beyond = outer / self.firm
        if self.bent:
            # The one real root of a growing cubic (Cardano's, with hyperbolic sines).
            root = self.reach * np.sinh(np.arcsinh(3 * beyond / self.reach) / 3)
            beyond = np.where(self.cubic > 0, root, beyond)
        return np.asarray((free - (inner / self.soft + beyond - self.rest)) / self.own)
