"""Rounds of naming without an aircraft, by what they leave."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.question.thresholds import Limits


def fitted(chi2: float, bent: float = 0.0, hypotheses: tuple[Any, ...] = ()) -> Any:
    """A fit of 1000 values, with scores of that square sum beyond their number."""
    scores = np.zeros(4)
    scores[0] = np.sqrt(4 + bent) if bent else 0.0
    return SimpleNamespace(
        chi2=chi2, chi2_per_dof=chi2 / 1000, cost=chi2 + scores @ scores, points=1000, scores=scores,
        covariance=np.eye(4), converged=True,
        hypotheses=hypotheses, problem=SimpleNamespace(names=("a", "b", "c", "d")),
    )  # fmt: skip


def left(held_out: float | None, adequate: bool = False, strain: float = 0.0, met: bool = True) -> Any:
    """What a fit leaves, of which noise leaves 0.7 and a campaign without an effect at most 1, leaning by at most 4."""
    return SimpleNamespace(
        held_out_chi2_per_dof=held_out, held_out_noise_per_dof=0.7, noise_per_dof=0.7, adequate=adequate, met=met,
        strain_sd=strain, limits=Limits(1.0, 1.0, 1.0, 4.0),
    )  # fmt: skip


def found(
    before: tuple[float, float | None], after: tuple[float, float | None], adequate: bool = False, names: int = 1
) -> Attribution:
    """Rounds, by χ² per degree of freedom of the fitted and of the held-out data without and with them."""
    met = after[0] <= 1.0 and (after[1] or 0.0) <= 1.0
    null, final = fitted(1000 * before[0], bent=50.0), fitted(1000 * after[0])
    winner = SimpleNamespace(name="added-mass", fit=fitted(1000 * after[0]), hypothesis=SimpleNamespace(linear=True))
    addition: Any = SimpleNamespace(winner=winner, alike=(), rivals=("tried at first",), held_out_before=None)
    return Attribution(
        null, left(before[1]), (addition,) * names, final, left(after[1], adequate, met=met), last_rivals=(), vetoed=()
    )  # fmt: skip
