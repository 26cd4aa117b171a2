"""Ends of records in fits: left out on the way where data drown them, and looked at again where it ends."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.reconcile.fitting import fit as fits
from vgvt.reconcile.fitting.fit import NEAR, fit
from vgvt.reconcile.prediction.surrogate import Anchor, anchor
from vgvt.reconcile.prediction.unheard import unheard
from vgvt.reconcile.question.problem import Problem, at_rest

# The package's lazy name of the same spelling is the function.


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return problem(tmp_path_factory.mktemp("cache"), 1)


def judged_by(case: Problem, factor: float) -> Problem:
    """The case with data that may be wrong by a factor more."""
    return replace(case, measured=replace(case.measured, sigma=factor * case.measured.sigma))


def heard_by(case: Problem) -> float:
    """Root mean square of what ends leave out at the stated values, in standard deviations."""
    here, u, e = anchor(case, np.zeros(case.size), slopes=False), np.zeros(case.size), np.zeros(0)
    added = (here.predict(u, e) - here.predict(u, e, ended=False))[case.split.train]
    return float(np.sqrt(np.mean(np.abs(added / case.measured.sigma[case.split.train]) ** 2)))


@pytest.mark.parametrize(("share", "silent"), [(0.5, True), (2.0, False)])
def test_what_data_drown(case: Problem, share: float, silent: bool) -> None:
    there = judged_by(case, heard_by(case) / (share * 0.02))
    assert heard_by(there) == pytest.approx(share * 0.02)
    u, e = np.zeros(case.size), np.zeros(0)
    here = anchor(there, u, slopes=False)
    assert unheard(here, u, e, here.predict(u, e)) == silent
    # Of records that end at rest there is nothing to leave out.
    quiet = at_rest(there)
    assert quiet is at_rest(there) and not quiet.measured.endings
    here = anchor(quiet, u, slopes=False)
    assert not unheard(here, u, e, here.predict(u, e))


@pytest.mark.parametrize(("rings_there", "exact"), [(True, False), (True, True), (False, False), (False, True)])
def test_a_fit_walks_without_them_and_ends_with_them(
    case: Problem, monkeypatch: pytest.MonkeyPatch, rings_there: bool, exact: bool
) -> None:
    """Where it arrives what rings may show: then it goes on with it."""
    case = judged_by(case, heard_by(case) / (0.5 * 0.02))
    right, walked, asked = fits.taken, list[bool](), list[bool]()

    def taken(here: Anchor, *given: Any) -> Any:
        walked.append(bool(here.problem.measured.endings))
        return right(here, *given)

    def shows(*given: Any) -> bool:
        asked.append(True)
        return len(asked) == 1 or not rings_there

    monkeypatch.setattr(fits, "taken", taken)
    monkeypatch.setattr(fits, "unheard", shows)
    found = fit(case, (), np.zeros(case.size), np.zeros(0), NEAR, exact=exact)
    assert found.problem is case
    assert not walked[0]
    assert any(walked) == rings_there
    here = anchor(case, found.u, slopes=False)
    np.testing.assert_allclose(found.predicted, here.predict(found.u, found.e), rtol=1e-9)
