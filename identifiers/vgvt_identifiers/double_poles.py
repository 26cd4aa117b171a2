"""Two poles where one would do: a mode that moves between runs can be held by two, each right for some of the runs.

What a pole explains with all others where they are says nothing then: either is missed wherever it stands for the
mode. So what is close together is fitted again with the weaker one left out and the others free.
"""

from __future__ import annotations

import numpy as np

from vgvt_identifiers.drifting_poles import RunStates, refined_runs
from vgvt_identifiers.pole_fit import PoleProblem

_STEPS = 12


def without_doubles(
    problems: tuple[PoleProblem, ...], states: RunStates, needed: float
) -> tuple[RunStates, tuple[tuple[complex, str], ...]]:
    """The fit without poles that a neighbour's move makes up for, and each of these with its reason.

    Neighbours are nearer than the wider one's half width; ``needed`` is the rise of the cost that noise alone reaches.
    """
    dropped: list[tuple[complex, str]] = []
    asked: set[tuple[complex, complex]] = set()
    while (pair := _next_pair(states, asked)) is not None:
        weaker, other = pair
        gone, stays = complex(states.poles[weaker]), complex(states.poles[other])
        trial = refined_runs(
            problems,
            np.delete(states.poles, weaker),
            np.array([np.delete(s.poles, weaker) for s in states.states]),
            _STEPS,
        )
        rise = trial.cost - states.cost
        if rise > needed:
            asked.add((gone, stays))
            continue
        why = (
            f"evidence {max(rise, 0.0) / 2:.3g} nats beside the pole at {abs(stays) / (2 * np.pi):.4g} Hz, where that "
            f"may move, noise alone reaches {needed / 2:.0f}: one mode"
        )
        dropped.append((gone, why))
        states = trial
    return states, tuple(dropped)


def _next_pair(states: RunStates, asked: set[tuple[complex, complex]]) -> tuple[int, int] | None:
    """The weaker and the other of the nearest two poles that share a resonance and were not asked yet."""
    poles, gain = states.poles, states.gain
    width = np.abs(poles.real)
    distance = np.abs(poles[:, None] - poles) / np.maximum(width[:, None], width)
    for i, j in sorted(zip(*np.nonzero(np.triu(distance < 1, 1)), strict=True), key=lambda pair: distance[pair]):
        weaker, other = (int(i), int(j)) if gain[i] < gain[j] else (int(j), int(i))
        if (complex(poles[weaker]), complex(poles[other])) not in asked:
            return weaker, other
    return None
