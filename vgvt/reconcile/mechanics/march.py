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

from vgvt.reconcile.mechanics.compiled_steps import stepped
from vgvt.reconcile.mechanics.law import Law

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_SMALL = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Memory:
    """How joints answer to what acts on them: x(ω) = Σ out · into / (iω - poles) + ``at_once``, real parts.

    ``poles`` (M,), rad/s, one of each pair; ``out`` (J, M), the pair's factor of two in it; ``into`` (M, J);
    ``at_once`` (J, J) is the flexibility of all faster modes, ``late`` (J, J) by how much, per rate of the force, these
    are behind.
    """

    poles: ComplexArray
    out: ComplexArray
    into: ComplexArray
    at_once: Array
    late: Array | float = 0.0


def marched(linear: Array, memory: Memory, laws: Sequence[Sequence[Law]], step_s: float) -> Array:
    """Extra reactions (R, J, N) of the joints, over what their stiffness in the linear structure does.

    ``linear`` (R, J, N) are the motions of the linear structure under the measured force, every ``step_s``;
    ``laws`` those of every run and joint. The law is met at every step's end. Forces are straight between steps;
    with friction constant in each, so that a force that stops the joint's motion does not ring. Where a trial step of
    a fit makes of a joint what runs away, the rest of its run is not a number.
    """
    rubbing = any(law.friction > 0 for row in laws for law in row)
    grown, new, pushed = _step(memory, step_s, held=rubbing)
    out, yields = memory.out, (memory.out @ new).real + memory.at_once
    if rubbing:
        # What is constant in every step lags half of one behind its end, and what answers at once must not: it goes on
        # from the last two. One more state a joint remembers the last.
        ahead = memory.at_once / 2 - memory.late / step_s
        count = yields.shape[0]
        grown, yields = np.append(grown, np.zeros(count)), yields + ahead
        out, pushed = np.hstack([out, -ahead]), np.hstack([pushed, np.eye(count)])
    table = law_table(laws, np.diag(yields))
    reaction: Array = stepped(np.ascontiguousarray(linear), grown, pushed, np.ascontiguousarray(out), yields, table)
    if rubbing:
        # A force that is constant in every step is, at its ends, the mean of two.
        reaction[..., :-1] = (reaction[..., :-1] + reaction[..., 1:]) / 2
    return reaction


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


def law_table(laws: Sequence[Sequence[Law]], own: Array) -> Array:
    """Laws of all runs and joints as an array (8, R, J), with what solves them in closed form.

    Its rows are rest, offset, soft, band, friction, firm, cubic and reach. ``own`` (J,) is what a unit force moves its
    joint by within the step: with y from the unloaded state, the law and x = free - own g are soft y + own T(y) = q,
    q = free + offset: a straight line within the band, of slope firm and with a cubic beyond.
    """

    def column(name: str) -> Array:
        return np.array([[float(getattr(law, name)) for law in row] for row in laws])

    cubic, soft, rest = column("cubic"), 1 - own * column("modelled"), column("rest")
    firm, bent = soft + own * column("stiffness"), own * cubic
    # Of a negative one no number comes, as the step is divided by it.
    reach = 2 * np.sqrt(np.maximum(firm, 0.0) / (3 * np.where(bent > 0, bent, 1.0)))
    offset = own * column("load") + soft * rest
    return np.array([rest, offset, soft, soft * column("play"), column("friction"), firm, cubic, reach])
