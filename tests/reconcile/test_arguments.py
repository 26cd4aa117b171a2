"""Arguments from Python are refused as a command's are: at once, and with what to write."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, problem, small_scenario

from vgvt.data import Campaign, InputError
from vgvt.effects import available_effects
from vgvt.reconcile import Kind, reconcile
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import NEAR
from vgvt.reconcile.question.data import measured_frfs
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.reconcile.question.suitable import FEWEST_LINES
from vgvt.reconcile.search.candidates import candidates, cannot_have
from vgvt.scenario import load_scenario

MASS = available_effects()["added-mass"]


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    return campaign_of(small_scenario(), 1)


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return problem(tmp_path_factory.mktemp("cache"), 1)


@pytest.mark.parametrize("lines", [0, -5, 16, FEWEST_LINES - 1, 60.0, np.nan, True, "60", None])
def test_lines_are_a_whole_number_that_is_enough(campaign: Campaign, lines: Any) -> None:
    said = rf"^lines: is {lines!r}, and a whole number of at least {FEWEST_LINES} is needed"
    with pytest.raises(InputError, match=said):
        measured_frfs(campaign, lines=lines)
    with pytest.raises(InputError, match=said):
        make_problem(campaign, small_scenario(), lines=lines)


def test_what_the_command_does_not_take_python_does_not_take(campaign: Campaign) -> None:
    """Nothing is computed: the drive point of another aircraft had been taken for one that is badly known."""
    scenario = small_scenario()
    elsewhere = scenario.model_copy(
        update={"shaker": scenario.shaker.model_copy(update={"position_m": (0.2, 0.3, 0.0)})}
    )
    for refused in (
        lambda: make_problem(campaign, elsewhere),
        lambda: reconcile(campaign, elsewhere),
        lambda: make_problem(campaign, load_scenario("hati-two-shakers")),
    ):
        with pytest.raises(InputError, match=r"shaker\.position_m: is 0\.\d+ m from|reconcile takes one shaker"):
            refused()


def test_as_few_lines_as_are_allowed_do(campaign: Campaign) -> None:
    assert measured_frfs(campaign, lines=np.int64(FEWEST_LINES)).frequency_hz.size > FEWEST_LINES / 2  # type: ignore[arg-type]


@pytest.mark.parametrize("floor", [-0.004, 1.5, np.nan, np.inf, "0.004", True])
def test_a_floor_is_a_fraction(campaign: Campaign, floor: Any) -> None:
    with pytest.raises(InputError, match=r"(?s)^floor: is .* from 0 to 1 .*0\.004 for 0\.4 %"):
        measured_frfs(campaign, lines=60, floor=floor)
    with pytest.raises(InputError, match=r"^floor: "):
        make_problem(campaign, small_scenario(), lines=60, floor=floor)


def test_tolerances_of_more_than_all_are_told_by_their_key(campaign: Campaign) -> None:
    scenario = small_scenario()
    wide = scenario.model_copy(update={"tolerances": scenario.tolerances.model_copy(update={"model_form": 4.0})})
    with pytest.raises(InputError, match=r"^scenario quick: tolerances\.model_form: is 4\.0, and a relative"):
        make_problem(campaign, wide, lines=60)


@pytest.mark.parametrize("floor", [0.0, 0, 1.0, np.float32(0.01)])
def test_any_fraction_is_one(campaign: Campaign, floor: Any) -> None:
    assert np.isfinite(measured_frfs(campaign, lines=60, floor=floor).sigma).all()


@pytest.mark.parametrize(
    ("effects", "words"),
    [
        (["added-mass"], ("effects: is a list", "mapping of names to effect classes")),
        ({"added-mass"}, ("effects: is a set",)),
        (MASS(), ("effects: is an AddedMass",)),
        (MASS, ("effects: is the class AddedMass",)),
        ("added-mass", ("effects: is 'added-mass'",)),
        ({"added-mass": MASS()}, ("effects['added-mass']: is an AddedMass and no class", "give the class")),
        ({"added-mass": "added-mass"}, ("effects['added-mass']: is 'added-mass' and no class",)),
        ({"foo": MASS}, ("effects['foo']: is the effect 'added-mass'", "write it as {'added-mass': AddedMass}")),
        ({"foo": int}, ("effects['foo']: is int, which is no effect",)),
    ],
)
def test_effects_are_classes_by_their_own_names(
    case: Problem, campaign: Campaign, effects: Any, words: tuple[str, ...]
) -> None:
    """Before a fit of minutes: nothing of the loop has been told by then."""
    told: list[float] = []
    calls = (
        lambda: candidates(case, effects),
        lambda: cannot_have(case, effects),
        lambda: reconcile(campaign, small_scenario(), effects=effects, progress=lambda f, *_: told.append(f)),
    )
    for call in calls:
        with pytest.raises(InputError) as said:
            call()
        for word in words:
            assert word in str(said.value)
    assert told == []


def test_arguments_in_another_order_are_told_so(campaign: Campaign) -> None:
    scenario: Any = small_scenario()
    stated: Any = campaign
    for call in (reconcile, make_problem):
        with pytest.raises(InputError, match=r"(?s)^campaign: is a Scenario .*the campaign first"):
            call(scenario, stated)
        with pytest.raises(InputError, match=r"(?s)^scenario: is 'quick' .*load_scenario\('quick'\)"):
            call(campaign, "quick")  # type: ignore[arg-type]
        with pytest.raises(InputError, match=r"(?s)^campaign: is 'records.toml' .*open_campaign"):
            call("records.toml", scenario)  # type: ignore[arg-type]
        with pytest.raises(InputError, match=r"(?s)^scenario: is a Campaign .*the campaign first"):
            call(campaign, stated)


@pytest.mark.parametrize("shape", [(0,), (3,), (1, 5)])
def test_a_start_has_all_scores_of_its_problem(case: Problem, shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=rf"this problem has {case.size} scores.*zeros"):
        calibrate(case, np.zeros(shape))
    with pytest.raises(ValueError, match=f"has {case.size} scores"):
        calibrate(case, np.zeros(case.size + 1))


def test_a_start_may_be_a_list(case: Problem) -> None:
    """As its numbers say, whatever holds them."""
    plain, listed = (calibrate(case, start, stages=NEAR) for start in (np.zeros(case.size), [0.0] * case.size))  # type: ignore[arg-type]
    np.testing.assert_array_equal(plain.u, listed.u)


def test_a_folder_may_be_a_text(campaign: Campaign, tmp_path: Path) -> None:
    folder = tmp_path / "named"
    found = reconcile(campaign, small_scenario(), effects={}, lines=60, folder=str(folder))
    assert found.kind is not Kind.EXPLAINED
    assert (folder / "reconciled.toml").is_file()
    assert any((folder / "cache").iterdir())
