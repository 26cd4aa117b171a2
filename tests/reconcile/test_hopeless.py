"""Two names that took less than two thirds are not followed by a third: it would have to take more than either."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vgvt.reconcile.decision.hopeless import hopeless
from vgvt.reconcile.question.thresholds import Limits

LIMITS = Limits(1.1, 1.2, 1.1, 4.0)


def leaves(chi2_per_dof: float, held_out: float | None) -> tuple[Any, Any]:
    """A fit with unknowns where they belong that leaves so much of fitted and of held-out data, noise being half."""
    fit = SimpleNamespace(chi2_per_dof=chi2_per_dof, points=1000, scores=np.zeros(3))
    left = SimpleNamespace(held_out_chi2_per_dof=held_out, held_out_noise_per_dof=0.5, noise_per_dof=0.5, limits=LIMITS)
    return fit, left


@pytest.mark.parametrize(
    ("names", "fitted", "held_out", "vain"),
    [
        (2, 10.5, 10.5, True),
        # Of either kind of data two thirds: three of one size.
        (2, 6.9, 10.5, False),
        (2, 10.5, 6.9, False),
        (2, 7.3, 7.3, True),
        # Of one name nothing follows.
        (1, 19.0, 19.0, False),
        # What is not far off may be met by little.
        (2, 4.3, 4.3, False),
        (2, 10.5, None, False),
    ],
)
def test_where_two_names_took_too_little(names: int, fitted: float, held_out: float | None, vain: bool) -> None:
    without, before = leaves(20.5, 20.5)
    found, after = leaves(fitted, held_out)
    assert hopeless(names, 3, found, without, after, before) is vain


def test_where_four_names_may_come_two_need_take_half() -> None:
    without, before = leaves(20.5, 20.5)
    found, after = leaves(9.5, 9.5)
    assert hopeless(2, 3, found, without, after, before)
    assert not hopeless(2, 4, found, without, after, before)
