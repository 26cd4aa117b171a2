"""Somebody else's effect that gives what it may not give: said at once, in its name, with what to write instead."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import pytest

from vgvt.data import InputError, PluginError
from vgvt.effects import Action, ChannelFilter, ChannelTransform, Family, available_effects, parameter, parameters_of
from vgvt.effects.acting import action_of
from vgvt.effects.elements import (
    BendTwist,
    Element,
    GroundSpring,
    JointLaw,
    MountCompliance,
    PointMass,
    Relaxation,
    RotationSpring,
)
from vgvt.effects.parameter import range_fault
from vgvt.effects.point_error import PointError
from vgvt.effects.registry import EffectPluginWarning, _made, _unusable
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.scenario import load_scenario

SCENARIO = load_scenario("quick")
LINES_HZ = np.array([0.0, 1.0, 2.0])


@dataclass(frozen=True)
class Mine:
    """Gives one action, whatever that is."""

    name: ClassVar[str] = "mine"
    family: ClassVar[Family] = Family.SENSORS
    linear: ClassVar[bool] = True
    size: float = parameter("", 0.1, 1.0, "size", neutral=0.0)
    gives: object = field(default=None, metadata={"doc": "the action"})

    def act(self, scenario: object, run: int) -> Any:
        return self.gives


def given(**contents: Any) -> Action:
    """What comes of an action of somebody else's effect, in the second run."""
    return action_of(Mine(gives=Action(**contents)), SCENARIO, 1)  # type: ignore[arg-type]


def filters(response: Callable[..., Any], channels: Any = "response", stage: Any = "sensor") -> dict[str, Any]:
    return {"channels": (ChannelFilter(channels, response, stage),)}


@pytest.mark.parametrize(
    ("contents", "said"),
    [
        ({"channels": ChannelFilter("all", np.ones_like)}, r"Action.channels is a ChannelFilter: give a tuple"),
        ({"elements": ("mass",)}, r"Action.elements holds a str: give Absorber or "),
        ({"points": [PointError(1)]}, r"Action.points is a list: give a tuple"),
        ({"scenario": {}}, r"Action.scenario is a dict: give scenario.model_copy\(update=…\), or None"),
        ({"command": 2.0}, r"Action.command is a float: give a function of \(command_v, time_s\)"),
        ({"warming_k": "2"}, r"Action.warming_k is '2': give a finite number"),
        ({"warming_k": float("nan")}, r"Action.warming_k is nan: give a finite number"),
        (filters(np.ones_like, "responses"), r"ChannelFilter on 'responses': write 'force', .*measured like '1\+Z'"),
        (filters(np.ones_like, "99+Z"), r"ChannelFilter on '99\+Z': write 'force', 'drive', 'response', 'all'"),
        (filters(np.ones_like, 3), r"ChannelFilter on 3: write"),
        (filters(np.ones_like, "1-Z"), r"ChannelFilter on '1-Z': write"),
        # As labels are compared: these would select nothing.
        (filters(np.ones_like, "1Z"), r"ChannelFilter on '1Z': write"),
        (filters(np.ones_like, "1+z"), r"ChannelFilter on '1\+z': write"),
        ({"points": (PointError([1, 2]),)}, r"TypeError: unhashable"),  # type: ignore[arg-type]
        ({"elements": (GroundSpring("body", (0.0, 0.0, 0.0), 1.0, node=99),)}, r"GroundSpring on node 99: "),
        ({"elements": (JointLaw("wing-left", "bend", 1.0),)}, r"JointLaw.kind is 'bend': did you mean 'bending'\?"),  # type: ignore[arg-type]
        (filters(np.ones_like, stage="sensors"), r"at stage 'sensors': did you mean 'sensor'\?"),
        (filters(1.2), r"ChannelFilter holds no function"),  # type: ignore[arg-type]
        (
            {"channels": (ChannelTransform("force", lambda x, rate, g: x, pace=0.0),)},
            r"ChannelTransform.pace is 0.0: give a positive number",
        ),
        ({"points": (PointError(99),)}, r"PointError on node 99: "),
        ({"points": (PointError(1, at_node=99),)}, r"PointError at node 99: "),
        ({"points": (PointError(1, shift_m=np.zeros(3)),)}, r"PointError.shift_m is array.*tuple of three"),  # type: ignore[arg-type]
        ({"elements": (PointMass("tail", (0.0, 0.0, 0.0), 0.1),)}, r"PointMass: there is no part 'tail'; choose"),
        ({"elements": (PointMass("body", (0.0, 0.0, 0.0), -0.1),)}, r"PointMass.mass_kg is -0.1: take mass from"),
        ({"elements": (PointMass("body", (0.0, 0.0, 0.0), float("nan")),)}, r"PointMass.mass_kg is nan: give a finite"),
        ({"elements": (PointMass("body", (0.0, 0.0), 0.1),)}, r"PointMass.position_m is .*: give a tuple of three"),  # type: ignore[arg-type]
        ({"elements": (BendTwist("wing", 0.1),)}, r"BendTwist: there is no beam 'wing'; .*wing-right"),
    ],
)
def test_contents_that_mean_nothing_are_refused_in_the_effects_name(contents: dict[str, Any], said: str) -> None:
    with pytest.raises(PluginError, match=rf"^effect 'mine' failed in act\(run 1\): .*{said}"):
        given(**contents)


def at(exciter: Any) -> RotationSpring:
    return RotationSpring("pitch", 2.0, exciter=exciter)


def mount(**changes: Any) -> MountCompliance:
    return MountCompliance(**({"stiffness_n_per_m": 2e4, "damping_n_s_per_m": 5.0} | changes))


def relaxing(branches: Any) -> Relaxation:
    return Relaxation(80.0, branches)


@pytest.mark.parametrize(
    ("element", "said"),
    [
        # An index of its own would be that of another shaker, counted from behind, or of none.
        (at(1), r"RotationSpring.exciter is 1: give 0, as the scenario has 1, counted from 0"),
        (at(-1), r"RotationSpring.exciter is -1: give 0"),
        (at(0.0), r"RotationSpring.exciter is 0.0: give 0"),
        (at(None), r"RotationSpring.exciter is None: give 0"),
        (mount(exciter=1), r"MountCompliance.exciter is 1: give 0"),
        (mount(stiffness_n_per_m=0.0), r"MountCompliance.stiffness_n_per_m is 0: give a positive number"),
        (mount(tension_ratio=0.0), r"MountCompliance.tension_ratio is 0: give a positive number"),
        (relaxing([(0.1, 8.0)]), r"Relaxation.branches is \[\(0.1, 8.0\)\]: give a tuple of pairs"),
        (relaxing((0.1, 8.0)), r"Relaxation.branches holds 0.1: give \(share, corner\)"),
        (relaxing(((0.1, 8.0), (0.1,))), r"Relaxation.branches holds \(0.1,\): give"),
        (relaxing(((0.1, 0.0),)), r"Relaxation.branches holds \(0.1, 0.0\): give"),
        (relaxing(((0.0, 8.0),)), r"Relaxation.branches holds \(0.0, 8.0\): give"),
        (relaxing(((0.1, -8.0),)), r"Relaxation.branches holds \(0.1, -8.0\): give"),
        (relaxing(((float("nan"), 8.0),)), r"Relaxation.branches holds \(nan, 8.0\): give"),
        (relaxing((("0.1", 8.0),)), r"Relaxation.branches holds \('0.1', 8.0\): give"),
    ],
)
def test_exciters_and_branches_that_are_none_are_refused(element: Element, said: str) -> None:
    with pytest.raises(PluginError, match=rf"^effect 'mine' failed in act\(run 1\): {said}"):
        given(elements=(element,))


def test_exciters_and_branches_that_there_are_pass() -> None:
    elements = (at(np.int64(0)), mount(exciter=0), relaxing(()), relaxing(((np.float64(0.1), 8),)))
    assert given(elements=elements).elements == elements
    two = load_scenario("hati-two-shakers")
    second = Mine(gives=Action(elements=(at(1), mount(exciter=1))))
    assert len(action_of(second, two, 0).elements) == 2  # type: ignore[arg-type]
    with pytest.raises(PluginError, match=r"exciter is 2: give 0 to 1, as the scenario has 2, counted from 0"):
        action_of(Mine(gives=Action(elements=(at(2),))), two, 0)  # type: ignore[arg-type]


def test_what_an_action_may_hold_passes_and_does_the_same() -> None:
    elements = (
        PointMass("wing", (0.6, 0.7, 0.0), 0.01),
        PointMass("body", (np.float64(0.6), 0.0, np.int64(0)), np.float32(0.01)),  # type: ignore[arg-type]
        GroundSpring("wing-left", (0.6, -0.7, 0.0), -3.0, node=11),
        BendTwist("wing-right", 0.1),
    )
    points = (PointError(SCENARIO.shaker.node, lean=(0.1, 0.0, 0.0)), PointError(1, at_node=2))
    action = given(
        scenario=SCENARIO, elements=elements, points=points, warming_k=1,
        channels=(ChannelFilter("1+Z", lambda f: 1 + 1j * f), ChannelTransform("all", lambda x, rate, _: x * rate)),
        command=lambda command, time: command + time,
    )  # fmt: skip
    assert action.same_rig(Action(scenario=SCENARIO, elements=elements, points=points))
    one, other = action.channels
    assert isinstance(one, ChannelFilter) and isinstance(other, ChannelTransform) and action.command is not None
    assert np.array_equal(one.response(LINES_HZ), 1 + 1j * LINES_HZ)
    assert np.array_equal(other.change(LINES_HZ, 2.0, np.random.default_rng(1)), 2 * LINES_HZ)
    assert np.array_equal(action.command(LINES_HZ, LINES_HZ), 2 * LINES_HZ)


@pytest.mark.parametrize(
    ("response", "said"),
    [
        (lambda f: {}["k"], "KeyError: 'k'"),
        (lambda f: f[1:], r"it gave an array of shape \(2,\) for 3 numbers: give one number for each"),
        (lambda f: 1.2, r"it gave an array of shape \(\) for 3 numbers"),
        (lambda f: np.ones(1), r"it gave an array of shape \(1,\) for 3 numbers"),
        (lambda f: None, "it gave object for 3 numbers"),
        (lambda f: np.full(3, np.nan), "3 of 3 values are not finite, the first at 0 Hz"),
        (lambda f: 1 / np.where(f > 0, f, np.nan), "1 of 3 values are not finite, the first at 0 Hz"),
    ],
)
def test_a_function_of_an_action_that_fails_says_whose_it_is(response: Callable[..., Any], said: str) -> None:
    (change,) = given(**filters(response)).channels
    assert isinstance(change, ChannelFilter)
    with pytest.raises(
        PluginError, match=rf"^effect 'mine' failed in the ChannelFilter on 'response' \(run 1\): .*{said}"
    ):
        change.response(LINES_HZ)


def test_samples_and_commands_are_real_finite_and_as_many() -> None:
    (change,) = given(channels=(ChannelTransform("force", lambda x, rate, g: 1j * x),)).channels
    assert isinstance(change, ChannelTransform)
    with pytest.raises(PluginError, match=r"the ChannelTransform on 'force' \(run 1\): TypeError: it gave complex"):
        change.change(LINES_HZ, 1.0, np.random.default_rng(1))
    command = given(command=lambda v, t: np.array([0.0, 1.0, np.inf])).command
    assert command is not None
    with pytest.raises(PluginError, match=r"in the command \(run 1\): .*1 of 3 values .* the first at sample 2"):
        command(LINES_HZ, LINES_HZ)


def test_bundled_effects_are_not_held(monkeypatch: pytest.MonkeyPatch) -> None:
    """They have tests of their own, and are asked thousands of times."""
    monkeypatch.setattr("vgvt.data.plugin._BUNDLED", frozenset({Mine.__module__.partition(".")[0]}))
    action = Action(warming_k=float("nan"))
    assert action_of(Mine(gives=action), SCENARIO, 0) is action  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("about", "said"),
    [
        ({"low": "0.1"}, "low = '0.1' is no finite number"),
        ({"high": float("inf")}, "high = inf is no finite number"),
        ({"neutral": float("nan")}, "neutral = nan is no finite number"),
        ({"low": 1.0, "high": 0.1}, "1 to 0.1 is no range: low comes first"),
        ({"scale": "logarithmic"}, "scale = 'logarithmic': write 'linear' or 'log'"),
        ({"scale": "log", "low": 0.0}, "a logarithmic scale cannot begin at 0: write a positive low"),
        ({"scale": "log", "neutral": -1.0}, "neutral = -1 is below least = 0"),
        ({"unit": None}, "the unit is None: write a text, '' for a fraction"),
    ],
)
def test_a_range_that_means_nothing_leaves_an_effect_out(about: dict[str, Any], said: str) -> None:
    about = {"unit": "", "low": 0.1, "high": 1.0, "doc": "size", "neutral": 0.0} | about

    @dataclass(frozen=True)
    class Ranged:
        size: float = parameter(**about)

    assert said in _unusable(Ranged)
    assert said in range_fault(parameters_of(Ranged)[0])


def test_fields_that_no_table_could_give_leave_an_effect_out() -> None:
    @dataclass(frozen=True)
    class Listed:
        nodes: tuple[int, ...] = (1, 2)

    @dataclass(frozen=True)
    class Made:
        width: float = field(default=0.0, metadata={"unit": "m"})

    @dataclass(frozen=True)
    class Filled:
        side: str = field(default_factory=str)

    @dataclass(frozen=True)
    class Turned:
        turn: ClassVar[Any] = "last"
        side: Literal["left", "right"] = "left"

    @dataclass(frozen=True)
    class Computed:
        side: str = "left"
        squares: tuple[float, ...] = field(init=False, default=())

    assert _unusable(Computed) == ""
    assert "its field 'nodes' is none of bool, int, float, str and Literal[…]" in _unusable(Listed)
    assert "its field 'width' has a unit, but no range: make it with parameter(" in _unusable(Made)
    assert "its field 'side' has a default_factory: write a default" in _unusable(Filled)
    assert "its class attribute 'turn' is 'last'" in _unusable(Turned)
    with pytest.raises(ValueError, match=r"the parameter 'width' needs neutral=… .* or default=…"):
        parameter("m", 0.1, 1.0, "width")


def test_no_bundled_effect_is_left_out_by_that() -> None:
    assert [_unusable(cls) for cls in available_effects().values()] == [""] * len(available_effects())


def test_a_constructor_that_fails_says_whose_it_is() -> None:
    """ValueError refuses values, in a file and in a search; anything else is a fault."""

    @dataclass(frozen=True)
    class Built(Mine):
        kind: Literal["refuses", "fails"] = "refuses"

        def __post_init__(self) -> None:
            raise (ValueError if self.kind == "refuses" else RuntimeError)("no licence server")

    told = r"^effect 'mine' failed in its constructor: RuntimeError: no licence server$"
    with pytest.raises(InputError, match=r"effect 'mine': no licence server"):
        _made({"mine": Built}, "mine", "here", {"kind": "refuses"})
    with pytest.raises(PluginError, match=told):
        _made({"mine": Built}, "mine", "here", {"kind": "fails"})
    assert Hypothesis(Built, {"kind": "refuses", "gives": None}).effect({"size": 0.5}) is None
    with pytest.raises(PluginError, match=told):
        Hypothesis(Built, {"kind": "fails", "gives": None}).made({"size": 0.5})
    with pytest.warns(EffectPluginWarning, match=told.rstrip("$") + "; the search goes on without it there"):
        assert Hypothesis(Built, {"kind": "fails", "gives": None}).effect({"size": 0.5}) is None


def test_the_how_to_names_the_fields_of_an_action() -> None:
    text = (Path(__file__).parents[2] / "docs" / "how-to" / "add-an-effect.md").read_text("utf-8")
    table = text[text.index("| field of `Action` |") :].split("\n\n")[0]
    named = [line.split("|")[1].split("`")[1] for line in table.splitlines()[2:]]
    assert sorted(set(named)) == sorted(f.name for f in fields(Action))
