"""The time loop of a march: a step of one joint is a handful of operations, too few for array calls.

It is plain Python in what :mod:`vgvt.reconcile.mechanics.compiled_steps` makes machine code of, and does without that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# How often joints are gone through within a step at most, and what is left of their forces' change then.
_SWEEPS, _SETTLED = 30, 1e-9


def stepped(
    moved: Array, grown: ComplexArray, pushed: ComplexArray, out: ComplexArray, yields: Array, laws: Array
) -> Array:
    """Forces (R, J, N) of the joints at every step's end; not a number from where a march has run away.

    ``moved`` (R, J, N) are motions without these forces; ``grown`` (M,), ``pushed`` (J, M) and ``out`` (J, M) carry
    the modes over a step, ``yields`` (J, J) are the joints' flexibilities within one. ``laws`` (8, R, J) are
    those of :func:`vgvt.reconcile.mechanics.march.law_table`.
    """
    runs, joints, count = moved.shape
    modes = grown.size
    reaction = np.zeros((runs, joints, count))
    rubbing = laws[4].any()
    for r in range(runs):
        state = np.zeros(modes, dtype=np.complex128)
        x, g, spring, free = np.zeros(joints), np.zeros(joints), np.zeros(joints), np.zeros(joints)
        alone, needed, rubbed = np.zeros(joints), np.zeros(joints), np.zeros(joints)
        for n in range(1, count):
            for m in range(modes):
                push = 0j
                for j in range(joints):
                    push += g[j] * pushed[j, m]
                state[m] = state[m] * grown[m] + push
            for j in range(joints):
                there = moved[r, j, n]
                for m in range(modes):
                    there -= state[m].real * out[j, m].real - state[m].imag * out[j, m].imag
                alone[j] = there
            # Joints that yield to each other within the step: in turn, until none moves another (Gauss and Seidel).
            for _ in range(_SWEEPS if joints > 1 else 1):
                change, size = 0.0, 0.0
                for j in range(joints):
                    law, free[j] = laws[:, r, j], alone[j]
                    for i in range(joints):
                        if i != j:
                            free[j] -= yields[j, i] * g[i]
                    before = g[j]
                    if rubbing:
                        # Sticking first: what would it take to hold the joint where it was?
                        needed[j] = (free[j] - x[j]) / yields[j, j] - spring[j]
                        rubbed[j] = min(max(needed[j], -law[4]), law[4])
                        spring[j] = spring_force(free[j] - yields[j, j] * rubbed[j], law, yields[j, j])
                        g[j] = rubbed[j] + spring[j]
                    else:
                        g[j] = spring_force(free[j], law, yields[j, j])
                    change, size = max(change, abs(g[j] - before)), max(size, abs(g[j]))
                if change <= _SETTLED * size:
                    break
            whole = True
            for j in range(joints):
                if rubbing and rubbed[j] != needed[j]:
                    x[j] = free[j] - yields[j, j] * g[j]
                whole = whole and np.isfinite(g[j])
                reaction[r, j, n] = g[j]
            if not whole:
                reaction[r, :, n:] = np.nan
                break
    return reaction


def spring_force(free: float, law: Array, own: float) -> float:
    """The spring's extra force where it moves its joint to free - own g about rest."""
    rest, offset, soft, band, firm, cubic, reach = law[0], law[1], law[2], law[3], law[5], law[6], law[7]
    q = free + offset
    inner = min(max(q, -band), band)
    beyond = (q - inner) / firm
    if cubic > 0:
        # The one real root of a growing cubic (Cardano's, with hyperbolic sines).
        beyond = reach * np.sinh(np.arcsinh(3 * beyond / reach) / 3)
    return float((free - (inner / soft + beyond - rest)) / own)
