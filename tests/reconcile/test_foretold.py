"""What a fit foretells of channels that it never saw: their own gains within tolerance, and nothing else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from reconciled_case import problem

from vgvt.reconcile.fitting.fit import fit


def test_a_held_out_channels_own_gain_is_open_within_its_tolerance(tmp_path: Path) -> None:
    """A gain error of one sd is taken up, another shape of error is not, and fitted channels stay as they are."""
    case = problem(tmp_path, 1)
    made = fit(case, (), np.zeros(case.size), np.zeros(0), ())
    k = int(np.flatnonzero(case.split.held)[0])
    sd = next(n.sd for n in case.nuisances if n.kind == "gain" and n.rows.sum() == 1 and n.rows[k])
    values = made.predicted.copy()
    values[k] *= 1 + sd
    turned, far = np.flatnonzero(case.split.held)[1:3]
    values[far] *= 1 + 10 * sd
    values[turned] *= np.exp(0.01j)
    measured = replace(case.measured, values=values, sigma=np.full(values.shape, 1e-3) * np.abs(values))
    told = replace(made, problem=replace(case, measured=measured)).foretold
    np.testing.assert_allclose(told[k], values[k], rtol=0.05 * sd)
    assert np.abs(told[turned] / values[turned] - 1).min() > 0.009
    # Ten deviations are no gain within tolerance: seven of them stay missing.
    assert np.abs(told[far] / values[far] - 1).min() > 6 * sd
    np.testing.assert_array_equal(told[case.split.train], made.predicted[case.split.train])
