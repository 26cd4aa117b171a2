"""A fit that a few steps leave far behind is not worth its end."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vgvt.reconcile.fitting import fit_unless_behind as module
from vgvt.reconcile.fitting.fit import NEAR
from vgvt.reconcile.fitting.fit_unless_behind import fit_unless_behind

FIRST = ((0.0, 6),)


@pytest.mark.parametrize(("behind", "converged", "fits"), [(3.0, False, 2), (5.0, False, 1), (1.0, True, 1)])
def test_only_what_comes_near_the_best_is_fitted_to_the_end(
    monkeypatch: pytest.MonkeyPatch, behind: float, converged: bool, fits: int
) -> None:
    stages: list[Any] = []

    def fitted(*args: Any) -> Any:
        stages.append(args[4])
        return SimpleNamespace(chi2=behind * 100.0, converged=converged, u=0, e=0)

    monkeypatch.setattr(module, "fit", fitted)
    problem: Any = None
    found = fit_unless_behind(problem, (), np.zeros(0), np.zeros(0), FIRST, 100.0)
    assert found.chi2 == behind * 100.0
    assert stages == [FIRST, NEAR][:fits]
