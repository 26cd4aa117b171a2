"""Places at which something added is looked for: no stretch of any beam is far from one of them."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar, Literal

import numpy as np
import pytest
from reconciled_case import campaign_of, roving_scenario

from vgvt.effects import available_effects, parameter
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.run_schedule import Shape
from vgvt.reconcile.question.problem import make_problem
from vgvt.reconcile.search.candidates import _spread, candidates, freed, places, tied_places
from vgvt.scenario import load_scenario
from vgvt.scenario.axis import beam_axis
from vgvt.scenario.mirror import expanded_beams
from vgvt.scenario.planform import part_at
from vgvt.scenario.points import sensor_points


@pytest.mark.parametrize("name", ["hati-unsymmetric", "bff", "garteur-sm-ag19", "teaching-beam"])
def test_every_part_of_a_beam_is_near_a_place(name: str) -> None:
    """However unevenly a table's stations lie: a tenth of the beam's length away along it, half its chord across."""
    problem: Any = SimpleNamespace(scenario=load_scenario(name))
    known = np.array(places(problem))
    for beam in expanded_beams(problem.scenario.airframe):
        axis = beam_axis(beam)
        length = axis.arc_length_m[-1]
        where = np.linspace(0.05, 0.95, 50) * length
        along = np.array([np.interp(where, axis.arc_length_m, axis.position_m[:, k]) for k in (0, 1)]).T
        chord = max(beam.stations.aft_edge_m or (0.0,)) + max(beam.stations.forward_edge_m or (0.0,))
        apart = np.linalg.norm(along[:, None] - known, axis=2).min(axis=1)
        assert apart.max() < 0.1 * length + chord / 2


def test_places_reach_as_far_as_the_aircraft() -> None:
    """One four times as large as what the catalogue has in mind: a mass at its wing's end can be said to be there."""
    scenario = load_scenario("hati-unsymmetric")
    (wing,) = scenario.airframe.beam
    points = tuple(tuple(4 * v for v in p) for p in wing.stations.position_m)
    wing = wing.model_copy(update={"stations": wing.stations.model_copy(update={"position_m": points})})
    large = scenario.model_copy(update={"airframe": scenario.airframe.model_copy(update={"beam": (wing,)})})
    for aircraft, farthest in ((large, 5.0), (scenario, 1.3)):
        problem: Any = SimpleNamespace(scenario=aircraft, measured=SimpleNamespace(run_numbers=(1,)))
        variants = candidates(problem, {n: available_effects()[n] for n in ("added-mass", "cable-bundle")})
        masses = [h for h in variants if h.name == "added-mass"]
        tip = max((h.settings for h in masses), key=lambda s: float(s["y_m"]))
        assert tip["y_m"] > farthest
        mass = freed(masses[0])
        there = mass.scores({"mass_kg": 0.1, **{k: tip[k] for k in ("x_m", "y_m")}})
        assert np.abs(there).max() < 2.1
        assert mass.values(there)["y_m"] == pytest.approx(tip["y_m"])
        assert next(p for p in freed(variants[-1]).parameters if p.name == "other_y_m").high >= farthest


@pytest.mark.parametrize("name", ["hati-unsymmetric", "bff"])
def test_a_tie_begins_at_the_body_and_between_any_two_beams_and_two_places_of_one(name: str) -> None:
    """One that began at the body alone never left it: its end does not move there, and nothing says which way to go."""
    problem: Any = SimpleNamespace(scenario=load_scenario(name))
    airframe = problem.scenario.airframe
    beams = {b.name for b in expanded_beams(airframe)}
    held = [
        frozenset(part_at(airframe, end) for end in ((x, y), (other_x, other_y)))
        for x, y, other_x, other_y in tied_places(problem)
    ]
    parts = {part for pair in held for part in pair}
    assert len(parts - beams) == 1
    assert set(held) == {frozenset(pair) for pair in itertools.combinations(sorted(parts), 2)} | {
        frozenset({beam}) for beam in parts & beams
    }


def test_a_tie_has_two_ends_and_no_two_ties_are_one() -> None:
    problem: Any = SimpleNamespace(scenario=load_scenario("garteur-sm-ag19"))
    ties = tied_places(problem)
    assert len(set(ties)) == len(ties)
    assert all(tie[:2] != tie[2:] for tie in ties)


def test_a_tie_is_offered_with_both_its_ends_and_fitted_with_both_free() -> None:
    measured = SimpleNamespace(run_numbers=(1,))
    problem: Any = SimpleNamespace(scenario=load_scenario("hati-unsymmetric"), measured=measured)
    variants = candidates(problem, {"cable-bundle": available_effects()["cable-bundle"]})
    assert {tuple(h.settings) for h in variants} == {("x_m", "y_m", "other_x_m", "other_y_m")}
    assert [tuple(h.settings.values()) for h in variants] == list(tied_places(problem))
    assert not freed(variants[0]).settings
    assert sum(h.share for h in variants) == pytest.approx(1.0)


def test_a_place_that_is_fitted_is_paid_for_by_its_prior_alone(tmp_path: Path) -> None:
    """With its place free every variant of a mass is the same one; when a payload came is still a choice of a run.

    Paid for as one of all places as well, a mass was ten or twenty times less likely than a transducer's, which has no
    place to pay for.
    """
    scenario = roving_scenario()
    case = make_problem(campaign_of(scenario, 1), scenario, lines=60, cache=tmp_path)
    known = available_effects()
    runs = len(scenario.acquisition.runs) - 1
    choices = {"added-mass": 1, "local-absorber": 1, "cable-bundle": 1, "payload-change": runs, "transducer-mass": 1}
    for name, count in choices.items():
        variants = candidates(case, {name: known[name]})
        assert sum(h.share for h in variants) == pytest.approx(1.0)
        assert {round(1 / freed(h).share, 9) for h in variants} == {count}, name
        # What is free already is not freed once more.
        assert freed(freed(variants[0])).share == freed(variants[0]).share and freed(variants[0]).places == 1


def test_what_one_run_alone_shows_of_a_point_cannot_have_drifted(tmp_path: Path) -> None:
    """Every point is in one run only, but sensors go through all of them: a gain that was always wrong has one name."""
    scenario = roving_scenario()
    case = make_problem(campaign_of(scenario, 1), scenario, lines=60, cache=tmp_path)
    known = available_effects()
    labels = {str(p.dof) for p in case.layouts.first.grid}
    chosen = {
        name: {h.settings["channels"] for h in candidates(case, {name: known[name]})}
        for name in ("gain-drift", "channel-gain")
    }
    assert labels <= chosen["channel-gain"]
    assert not labels & chosen["gain-drift"]
    assert {"response", "force", "sensor-1", "sensor-2"} <= chosen["gain-drift"]


@pytest.mark.parametrize(("name", "runs"), [("garteur-sm-ag19", 1), ("bff", 1), ("bff", 12)])
def test_every_sensor_can_be_named(name: str, runs: int) -> None:
    """However many pairs of sensors, or sensors and runs, there are: none is left out for coming last."""
    scenario = load_scenario(name)
    nodes = tuple(scenario.accelerometers.grid.node)
    about: Any = SimpleNamespace(
        scenario=scenario,
        measured=SimpleNamespace(runs=(nodes,) * runs, run_numbers=()),
        layouts=SimpleNamespace(first=SimpleNamespace(grid=sensor_points(scenario))),
    )
    known = available_effects()
    swapped = {h.settings["other_node"] for h in candidates(about, {"swapped-sensors": known["swapped-sensors"]})}
    assert swapped >= set(nodes[1:])
    drifted = candidates(about, {"gain-drift": known["gain-drift"]})
    labels = {str(p.dof) for p in sensor_points(scenario)}
    assert runs == 1 or {str(h.settings["channels"]) for h in drifted} >= labels
    assert sum(h.share for h in drifted) == pytest.approx(1.0) or not drifted


def test_of_too_many_variants_as_many_are_taken_from_every_part() -> None:
    kept = [v["node"] for v in _spread([{"node": k} for k in range(3000)])]
    assert len(set(kept)) == len(kept) < 3000
    assert (kept[0], kept[-1]) == (0, 2999)
    assert max(np.diff(kept)) <= 3


@dataclass(frozen=True)
class Mixed:
    """Two sensors that are taken for one another, in one of two ways, at some place."""

    name: ClassVar[str] = "mixed"
    size: float = parameter("", 0.1, 1.0, "size", neutral=0.0, scale="log")
    x_m: float = parameter("m", 0.0, 1.2, "place", default=0.4)
    y_m: float = parameter("m", -1.5, 1.5, "place", default=0.0)
    node: int = field(default=0, metadata={"doc": "one"})
    other_node: int = field(default=0, metadata={"doc": "the other"})
    kind: Literal["a", "b"] = field(default="a", metadata={"doc": "how"})

    def act(self, *_: object) -> Action:
        return NOTHING


@dataclass(frozen=True)
class Growing:
    """A mass that grows from run to run, on one of two sides, at some place."""

    name: ClassVar[str] = "growing"
    mass_kg: float = parameter("kg", 0.005, 0.2, "mass", neutral=0.0, scale="log")
    x_m: float = parameter("m", 0.0, 1.2, "place", default=0.4)
    y_m: float = parameter("m", -1.5, 1.5, "place", default=0.0)
    shape: Shape = field(default="linear", metadata={"doc": "how"})
    from_run: int = field(default=2, metadata={"doc": "when"})
    side: Literal["left", "right"] = field(default="left", metadata={"doc": "where"})

    def act(self, *_: object) -> Action:
        return NOTHING


def _about(runs: int) -> Any:
    """A beam that all its sensors measured in every run."""
    scenario = load_scenario("teaching-beam")
    nodes = tuple(scenario.accelerometers.grid.node[:4])
    return SimpleNamespace(
        scenario=scenario,
        measured=SimpleNamespace(runs=(nodes,) * runs, run_numbers=()),
        layouts=SimpleNamespace(first=SimpleNamespace(grid=sensor_points(scenario))),
    )


def test_pairs_of_sensors_are_tried_with_every_other_choice_and_place() -> None:
    about = _about(1)
    found = {tuple(h.settings[k] for k in ("node", "other_node", "kind", "x_m", "y_m")) for h in candidates(
        about, {"mixed": Mixed}
    )}  # fmt: skip
    pairs = itertools.combinations(about.measured.runs[0], 2)
    assert found == {(*p, kind, *at) for p in pairs for kind in "ab" for at in places(about)}


def test_courses_between_runs_are_tried_at_every_place() -> None:
    about = _about(3)
    variants = candidates(about, {"growing": Growing})
    assert all(("from_run" in h.settings) == (h.settings["shape"] == "step") for h in variants)
    found = {tuple(h.settings.get(k) for k in ("side", "shape", "from_run", "x_m", "y_m")) for h in variants}
    courses = [("linear", None), ("exponential", None), ("step", 2), ("step", 3)]
    assert found == {(s, *c, *at) for s in ("left", "right") for c in courses for at in places(about)}
    assert len(variants) == len(found)
