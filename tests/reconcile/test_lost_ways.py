"""Where the unknowns lose their way beside an effect they are not followed: no aircraft lies there."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from reconciled_case import problem

import vgvt.reconcile.search.in_parts as in_parts
from vgvt.effects import available_effects
from vgvt.reconcile.next_test.before_test import expected_fit
from vgvt.reconcile.prediction.grouping import assembled
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.stand import Stand
from vgvt.scenario import load_scenario

SPOILED = Path(__file__).resolve().parents[2] / "scenarios" / "spoiled" / "base.toml"
ROOT = Hypothesis(available_effects()["root-compliance"], {"side": "both", "torsion": 0.0})
LITTLE = ROOT.scores({"bending": 0.01})


def test_a_wing_that_rounds_to_nothing_is_no_aircraft(tmp_path: Path) -> None:
    """A factor of exp(-40) left a stiffness of zero, and the effect divided by it: a warning, and no refusal."""
    case = problem(tmp_path, 1)
    names = [k.name for k in case.unknowns]
    for name, power in itertools.product(("EI wing", "GJ wing", "inertia wing"), (-40.0, -800.0, 800.0)):
        scores = np.zeros(case.size)
        k = names.index(name)
        scores[k] = power / case.unknowns[k].sd
        assert assembled(case, scores, (ROOT,), LITTLE) is None, (name, power)
    assert assembled(case, np.zeros(case.size), (ROOT,), LITTLE) is not None


def test_a_way_that_is_lost_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each part of a lost way leads the next one farther off: what a part costs more than may be left ends it.

    Of a root that gives a little, without noise, by which half of what the whole way leaves is too much on the way.
    """
    stand = Stand.of(expected_fit(load_scenario(str(SPOILED)), lines=500))
    asked: list[float] = []
    anchor = in_parts.anchor

    def counted(case: object, u: np.ndarray, *given: object, **more: object) -> object:
        asked.append(float(np.abs(u).max()))
        return anchor(case, u, *given, **more)

    monkeypatch.setattr(in_parts, "anchor", counted)
    bending = next(p for p in ROOT.parameters if p.name == "bending")
    values = {"bending": 2.4e-4}
    shown = stand.shown(ROOT, values, {"bending": 0.0})
    assert shown is not None
    followed = in_parts.shown_in_parts(stand, ROOT, values, bending, np.inf)
    assert followed is not None
    # Followed in parts it finds what a tangent does, and a little less.
    left = float(followed @ followed)
    assert 0.9 * float(shown @ shown) < left < float(shown @ shown)
    to_the_end, farthest = len(asked), max(asked)
    assert in_parts.shown_in_parts(stand, ROOT, values, bending, 0.5 * left) is None
    assert len(asked) - to_the_end < to_the_end
    assert max(asked[to_the_end:]) < farthest
