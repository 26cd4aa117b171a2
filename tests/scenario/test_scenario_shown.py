"""What a scenario shows at a prompt: one line, and nothing but that line changes."""

from __future__ import annotations

import copy
import pickle
from io import StringIO

from rich.console import Console

from vgvt.scenario import load_scenario
from vgvt.scenario.sweeps import sweep
from vgvt.scenario.swept_axis import Axis


def test_a_scenario_is_one_line() -> None:
    quick, spoiled = load_scenario("quick"), load_scenario("spoiled-added-mass")
    for scenario in (quick, spoiled):
        assert "\n" not in repr(scenario) and len(repr(scenario)) < 300
    assert repr(quick).startswith("Scenario(name='quick', airframe='mAEWing1 Hati ")
    assert repr(quick).endswith("points=20, runs=1, excitation='linear-chirp', band_hz=(3.0, 35.0), effects=[])")
    assert "effects=['added-mass']" in repr(spoiled)
    assert len(str(quick)) < 300
    shown = StringIO()
    Console(file=shown, width=120).print(quick)
    assert len(shown.getvalue()) < 500


def test_what_is_not_shown_still_counts() -> None:
    quick = load_scenario("quick")
    other = quick.model_copy(update={"shaker": quick.shaker.model_copy(update={"armature_mass_kg": 0.0123})})
    assert repr(other) == repr(quick)
    assert other != quick and hash(other) != hash(quick)
    for same in (copy.deepcopy(quick), pickle.loads(pickle.dumps(quick))):  # noqa: S301  made in this line
        assert same == quick and hash(same) == hash(quick)


def test_a_variant_says_what_makes_it() -> None:
    first, _ = sweep(load_scenario("quick"), [Axis.parse("excitation.duration_s=10,20")])
    assert repr(first) == "<Variant quick-001: excitation.duration_s = 10>"
