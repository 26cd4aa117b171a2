"""What no catalogue has, from finite elements that share no code with the analysis: found at its place, as its law."""

from __future__ import annotations

from pathlib import Path

import never_catalogued as never
import numpy as np
import pytest
import second_laboratory as lab
from second_laboratory import Coupling, Rig
from test_second_laboratory import scenario

from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.nameless_told import nameless_told
from vgvt.reconcile.evidence.nameless import with_nameless
from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.evidence.still_explained import still_explained
from vgvt.reconcile.fitting.fit import NEAR, fit
from vgvt.reconcile.question.problem import make_problem
from vgvt.reconcile.question.thresholds import noise_share, stored_thresholds
from vgvt.scenario import Scenario

PULL, EDDY, LAG_S = 300.0, 5.0, 0.01
SPRING, DASHPOT = 400.0, 4.0


def roving(cells: int) -> Scenario:
    """Four accelerometers that rove over the twenty points in five runs."""
    whole = scenario(cells)
    runs = tuple(tuple(range(k, 21, 5)) for k in range(1, 6))
    return whole.model_copy(update={"acquisition": whole.acquisition.model_copy(update={"runs": runs})})


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Derivatives of the stated aircraft are worked out once."""
    return tmp_path_factory.mktemp("cache")


@pytest.mark.slow
def test_a_stay_reads_as_the_spring_and_the_dashpot_that_it_is(folder: Path) -> None:
    """Told as a user is told of it, where no effect has a name."""

    def stay(rig: Rig, run: int) -> Rig:
        row = never.vertical(rig, 8)
        return rig.coupled(Coupling(row, row, lambda omega: SPRING + 1j * omega * DASHPOT))

    problem = make_problem(lab.campaign_of(roving(8), (stay,)), roving(20), lines=160, cache=folder)
    null = fit(problem, (), np.zeros(problem.size), np.zeros(0), NEAR)
    limits = stored_thresholds().at(noise_share(problem.measured, problem.split.train))
    left = residual(null, limits)
    found = nameless_told(Attribution(null, left, (), null, left, (), ()), limits).nameless
    assert found is not None and found.where.label == "force at 8+Z"
    told = {p.name: p for p in found.law.reading.parts}
    assert told["stiffness"].value == pytest.approx(SPRING, rel=0.15)
    assert told["damping"].value == pytest.approx(DASHPOT, rel=0.15)
    assert abs(told["mass"].value) < 0.01
    assert found.law.reading.left < 0.05


@pytest.mark.parametrize("node", [5, pytest.param(18, marks=pytest.mark.slow)])
def test_a_magnet_is_found_where_it_is_and_is_what_it_is(folder: Path, node: int) -> None:
    """A negative stiffness with eddy currents that lag, at one point of finite elements."""
    campaign = lab.campaign_of(roving(8), (never.magnet(PULL, EDDY, node),))
    problem = make_problem(campaign, roving(20), lines=160, cache=folder)
    null = fit(problem, (), np.zeros(problem.size), np.zeros(0), NEAR)
    where = still_explained(null)
    assert where is not None
    assert where.label == f"force at {node}+Z" and where.when == ""
    found = with_nameless(problem, (), null.u, null.e, where)
    assert found is not None
    assert found.chi2_per_dof < 0.02 * null.chi2_per_dof
    # What had imitated it lets go.
    assert found.u @ found.u < 0.15 * null.u @ null.u
    # Its law read as a magnet's, beside a point mass that the aircraft's own masses trade with.
    omega = 2 * np.pi * problem.measured.frequency_hz
    parts = np.stack([-np.ones_like(omega), 1j * omega / (1 + 1j * omega * LAG_S), -(omega**2)], axis=1)
    both = [np.concatenate([v.real, v.imag]) for v in (parts, found.law.values)]
    pull, eddy, mass = np.linalg.lstsq(*both, rcond=None)[0]
    assert pull == pytest.approx(PULL, rel=0.15)
    assert eddy == pytest.approx(EDDY, rel=0.15)
    assert abs(mass) < 0.01
