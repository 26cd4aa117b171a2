"""Errors that are told know of what the model has no unknown for: stiffness between stations, and cells."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, small_scenario

from vgvt.effects import available_effects
from vgvt.effects.acting import acted
from vgvt.effects.beams import with_beams
from vgvt.reconcile.evidence import unseen
from vgvt.reconcile.evidence.posterior import honest
from vgvt.reconcile.evidence.unseen import with_unseen
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import TO_THE_END, Fit, fit
from vgvt.reconcile.prediction.grouping import NoStructureError, assembled
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS, Problem, make_problem, with_more_cells
from vgvt.reconcile.question.uncertain import between_stations, prepared
from vgvt.scenario import Scenario
from vgvt.simulation.assembly import plan
from vgvt.simulation.reduced import Structure, structure


def stretched() -> Scenario:
    """The small scenario with two wings of four stretches a side."""
    small = small_scenario()
    return small.model_copy(update={"tolerances": small.tolerances.model_copy(update={"segments": 4})})


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    scenario = stretched()
    return make_problem(campaign_of(scenario, 1), scenario, lines=200, cache=tmp_path_factory.mktemp("cache"))


@pytest.fixture(scope="module")
def calibrated(case: Problem) -> Fit:
    return calibrate(case)


def test_a_change_moves_scores_as_a_fit_that_takes_it_for_data_does(
    calibrated: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a change that an unknown makes by itself that unknown's score is most of what moves."""
    k = calibrated.problem.names.index("spring")
    change = calibrated.tangent[:, k]
    monkeypatch.setattr(unseen, "_between", lambda found: [change])
    monkeypatch.setattr(unseen, "_by_cells", lambda found: [])
    moved = with_unseen(calibrated)
    assert moved.unseen is not None and moved.unseen.shape == (1, calibrated.scores.size)
    told, before = honest(moved), honest(calibrated)
    # By as much as data know of it, which is all but what its prior holds.
    expected = 1 - calibrated.covariance[k, k]
    assert moved.unseen[0, k] == pytest.approx(expected, rel=1e-6)
    assert told.covariance[k, k] == pytest.approx(before.covariance[k, k] + expected**2, rel=1e-6)
    # Nothing else is told otherwise, and an aircraft without anything unseen is told as it was.
    assert np.array_equal(told.u, calibrated.u) and told.evidence_nats == calibrated.evidence_nats
    monkeypatch.setattr(unseen, "_between", lambda found: [])
    assert with_unseen(calibrated) is calibrated


def test_between_stations_is_what_no_unknown_says(case: Problem) -> None:
    scenario = case.scenario
    base, aside = between_stations(scenario)
    t = scenario.tolerances
    wings = sum(k.name.startswith("EI wing-") for k in case.unknowns)
    assert wings == 2 * t.segments
    assert len(aside) == 3 * 2 * (t.segments - 1)
    stated = prepared(scenario)
    for changed in aside:
        beams = zip(base.airframe.beam, changed.airframe.beam, stated.airframe.beam, strict=True)
        (moved,) = [(b, c, s) for b, c, s in beams if b != c]
        ratios = [
            np.array(getattr(moved[1].stations, column)) / np.array(getattr(moved[0].stations, column))
            for column in ("bending_stiffness_n_m2", "torsional_stiffness_n_m2", "mass_kg_per_m")
        ]
        (ratio,) = [r for r in ratios if not np.allclose(r, 1.0)]
        assert ratio.max() == pytest.approx(1 + max(t.stiffness_segment, t.mass_segment), abs=0.05)
        # Tents that end at the stations of the unknowns' own.
        arc = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(moved[0].stations.position_m, axis=0), axis=1))])
        own = np.linspace(0, arc[-1], t.segments)
        assert np.allclose(np.interp(own, arc, ratio), 1.0)
    single = scenario.model_copy(update={"tolerances": t.model_copy(update={"segments": 1})})
    assert between_stations(single)[1] == ()


def test_a_wing_that_is_softer_between_stations_moves_scores_as_foretold(calibrated: Fit, case: Problem) -> None:
    """The same noise with and without it: by how far scores move, of what unknowns are known well enough to say."""
    aside = between_stations(case.scenario)[1][0]
    # The data of a wing that is a deviation stiffer there than what the fit foretells of it.
    change = unseen._misfit(calibrated, replace(case, scenario=aside), calibrated.u)
    base = unseen._misfit(calibrated, replace(case, scenario=between_stations(case.scenario)[0]), calibrated.u)
    assert change is not None and base is not None
    n = change.size // 2
    sigma = case.measured.sigma[case.split.train]
    added = ((change - base)[:n] + 1j * (change - base)[n:]).reshape(sigma.shape) * sigma / np.sqrt(2)
    values = case.measured.values.copy()
    values[case.split.train] += added
    other = replace(calibrated.problem, measured=replace(case.measured, values=values))
    again = fit(other, (), calibrated.u, np.zeros(0), TO_THE_END)
    foretold = with_unseen(calibrated).unseen
    assert foretold is not None
    # In units of what data and priors say of them; a fit stops a little before its bottom.
    root = np.linalg.cholesky(np.linalg.inv(calibrated.covariance)).T
    moved, expected = root @ (again.u - calibrated.u), root @ foretold[0]
    assert np.linalg.norm(expected) > 2.0, "it must be worth something in this test"
    assert np.linalg.norm(moved - expected) < 0.3 * np.linalg.norm(expected)


def test_more_cells_are_nearer_to_none_where_a_root_gives_way(case: Problem) -> None:
    """What makes up for cells was found with rigid roots."""
    finer = with_more_cells(case)
    assert finer is not None and finer.names == case.names
    root = Hypothesis(available_effects()["root-compliance"], {"side": "both", "torsion": 0.0})
    e, u = root.scores({"bending": 0.02}), np.zeros(case.size)

    def frequencies(s: Structure) -> np.ndarray:
        """Of the elastic modes."""
        squares = np.linalg.eigvals(np.linalg.solve(s.mass, s.stiffness)).real
        return np.asarray(np.sqrt(np.sort(squares)[6:11]))

    def foretold(which: Problem) -> np.ndarray:
        groups = assembled(which, u, (root,), e)
        assert groups is not None
        return frequencies(groups[0].structure)

    def chain(cells: int) -> np.ndarray:
        """Of so many cells as they are, with nothing that makes up for them."""
        names = [b.name for b in case.stated.airframe.beam]
        stated = with_beams(stretched(), names, lambda b: b.model_copy(update={"cells": cells}))
        effect = root.effect(root.values(e))
        assert effect is not None
        scenario, actions = acted((effect,), stated, 0)
        layout = plan(scenario)
        return frequencies(structure(replace(layout, actions=actions), layout.grid))

    # What chains err by falls with the square of the number of cells.
    none = (4 * chain(60) - chain(30)) / 3
    coarse, fine = (np.abs(foretold(p) / none - 1).max() for p in (case, finer))
    assert fine < 0.5 * coarse
    again = with_more_cells(finer)
    assert again is not None and with_more_cells(again) is None


def test_of_a_chain_as_coarse_as_stated_cells_leave_nothing(case: Problem) -> None:
    """Records that were simulated with the very scenario: its chain is there as it is."""
    scores = np.zeros(case.size)
    size = []
    for cells in (0.0, -1.0, -20.0):
        scores[case.names.index(CELLS.name)] = cells / CELLS.sd
        (change,) = unseen._by_cells(fit(case, (), scores, np.zeros(0), ()))
        size.append(np.linalg.norm(change))
    assert size[0] > 3.0, "it must be worth something in this test"
    assert size[1] == pytest.approx((1 + np.tanh(-1.0)) * size[0], rel=1e-6)
    assert size[2] < 1e-6 * size[0]


def test_an_aircraft_that_cannot_be_predicted_with_says_nothing(
    calibrated: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise NoStructureError("no such aircraft")

    monkeypatch.setattr(unseen, "anchor", refuse)
    assert with_unseen(calibrated) is calibrated
