"""An effect of several sizes, of which one is not there: the screen leaves it out where its least value does harm."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from reconciled_case import campaign_of, drawn_scores, roving_scenario, without_instrument_noise

from vgvt.effects import available_effects
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import make_problem
from vgvt.reconcile.search.candidates import freed
from vgvt.reconcile.search.screen import _sized, screen

TORSION = 0.01
CREEP = available_effects()["root-creep"]
CHOSEN: dict[str, Any] = {"side": "left", "shape": "step", "from_run": 3}


@pytest.fixture(scope="module")
def quiet(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """Records without noise, whose left root gives way in torsion alone from the third run on; unknowns as drawn."""
    lab = without_instrument_noise(roving_scenario())
    records = campaign_of(lab, 3, CREEP(torsion=TORSION, **CHOSEN))
    case = make_problem(records, lab, floor=1e-3, lines=160, cache=tmp_path_factory.mktemp("cache"))
    return fit(case, (), drawn_scores(case, 3), np.zeros(0), ((0.0, 3),))


def test_what_is_not_there_does_not_hide_what_is(quiet: Fit) -> None:
    """Two thousandths of the beam's bending compliance are the least that is plausible: far too much for these data."""
    variant = Hypothesis(CREEP, CHOSEN, share=0.5)
    (found,) = screen(quiet, [variant])
    assert found.hypothesis.settings == CHOSEN | {"bending": 0.0}
    assert set(found.values) == {"torsion"}
    assert found.values["torsion"] == pytest.approx(TORSION, rel=0.3)
    # Which size goes was a choice.
    assert found.hypothesis.share == 0.25
    assert found.gain_nats > 9
    least = Hypothesis(CREEP, CHOSEN | {"bending": 0.002})
    (harmed,) = screen(quiet, [least])
    assert harmed.gain_nats < found.gain_nats - 9


def stand(torsion: float, bending: float, shows: float) -> Any:
    """Both sizes do something of their own, a unit of bending ``shows``, and the truth holds some of each."""
    slopes = {"torsion": np.array([1000.0, 0.0]), "bending": np.array([0.0, shows])}
    left = -torsion * slopes["torsion"] - bending * slopes["bending"]
    return SimpleNamespace(left=left, slope=lambda _, values, p: slopes[p.name], projected=lambda slope: slope)


@pytest.mark.parametrize(
    ("bending", "shows", "kept"),
    [(0.0, 5000.0, False), (-0.01, 5000.0, False), (0.0, 10.0, True), (0.01, 5000.0, True)],
    ids=["not there", "less than none", "its least does no harm", "there"],
)
def test_sizes_that_do_no_harm_stay_and_cost_nothing(bending: float, shows: float, kept: bool) -> None:
    variant = Hypothesis(CREEP, CHOSEN, share=0.5)
    found = _sized(stand(TORSION, bending, shows), variant, {}, "")
    assert (found.hypothesis is variant) == kept
    assert found.values["torsion"] == pytest.approx(TORSION)
    assert found.values.get("bending") == (pytest.approx(max(bending, 0.002)) if kept else None)
    assert found.hypothesis.share == (0.5 if kept else 0.25)
    assert found.gain_nats == pytest.approx(0.5 * ((1000 * TORSION) ** 2 + (kept and (shows * bending) ** 2)))


def test_a_size_that_shows_nothing_has_a_plausible_value() -> None:
    """Nothing is known of it, and no value that has no logarithm is a start."""
    blind = stand(TORSION, 0.0, 0.0)
    found = _sized(blind, Hypothesis(CREEP, CHOSEN), {}, "")
    assert found.visible and found.values["torsion"] == pytest.approx(TORSION)
    assert 0.002 < found.values["bending"] < 0.3
    dark = SimpleNamespace(left=blind.left, slope=lambda *_: None, projected=None)
    found = _sized(cast(Any, dark), Hypothesis(CREEP, CHOSEN), {}, "")
    assert not found.visible and min(found.values.values()) > 0.002


def test_a_size_that_was_left_out_stays_out_where_a_place_is_freed() -> None:
    tie = {"x_m": 0.9, "y_m": 1.1, "other_x_m": 0.426, "other_y_m": 0.0}
    lean = Hypothesis(available_effects()["cable-bundle"], tie).without("damping_n_s_per_m")
    free = freed(lean)
    assert free.settings == {"damping_n_s_per_m": 0.0}
    assert [p.name for p in free.parameters] == ["stiffness_n_per_m", "x_m", "y_m", "other_x_m", "other_y_m"]
    assert np.isfinite(free.scores({"stiffness_n_per_m": 5.0, **tie})).all()


def test_only_a_size_can_be_left_out() -> None:
    lean = Hypothesis(CREEP, CHOSEN, share=0.5).without("torsion")
    assert lean.settings == CHOSEN | {"torsion": 0.0} and math.isclose(lean.share, 0.25)
    with pytest.raises(ValueError, match=r"'time_constant_runs' is no size of root-creep .* name one of bending, tors"):
        Hypothesis(CREEP, CHOSEN).without("time_constant_runs")
