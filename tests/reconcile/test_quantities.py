"""A/F is what a campaign and a scenario are compared by: whatever is no acceleration or no force, in SI, is refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vgvt.data import Campaign, Channel, ChannelRole, Direction, Dof, Geometry, InputError, Quantity, Record
from vgvt.reconcile.question.data import measured_frfs
from vgvt.reconcile.question.suitable import check_quantities, check_suitable, remarks
from vgvt.scenario import load_scenario


def campaign(**changes: object) -> Campaign:
    """Noise of a force and of two accelerations, the last channel with ``changes``."""
    dofs = [Dof(n, Direction.PLUS_Z) for n in (100, 1, 2)]
    channels = [Channel("force", Quantity.EXCITATION_FORCE, ChannelRole.REFERENCE, dofs[0])]
    channels += [Channel(f"a{k}", Quantity.ACCELERATION, ChannelRole.RESPONSE, dofs[k]) for k in (1, 2)]
    channels[-1] = replace(channels[-1], **changes)
    samples = np.random.default_rng(8).normal(size=(3, 3000))
    return Campaign(
        "bench", Geometry((1, 2, 100), np.eye(3)), (Record(7, 100.0, tuple(channels), samples),), (2.0, 25.0)
    )


def test_what_is_in_si_is_taken() -> None:
    check_quantities(campaign(unit="m/s²"))
    drive = {"quantity": Quantity.GENERAL, "unit": "V", "role": ChannelRole.DRIVE}
    assert len(measured_frfs(campaign(**drive), lines=60).channels) == 1


@pytest.mark.parametrize("refuse", [check_quantities, lambda c: measured_frfs(c, lines=60)])
@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"quantity": Quantity.VELOCITY, "unit": "m/s"}, ("measures velocity", "acceleration alone", "m/s^2")),
        ({"quantity": Quantity.GENERAL, "unit": "V"}, ("measures general",)),
        ({"quantity": Quantity.ACCELERATION, "role": ChannelRole.REFERENCE}, ("measures acceleration", "force alone")),
        ({"unit": "g"}, ("is in g", "multiply its samples by 9.80665", "m/s^2")),
        ({"unit": "lbf"}, ("is in lbf", "bring its samples to m/s^2")),
    ],
)
def test_anything_else_is_told_with_its_run_and_channel(
    changes: dict[str, object], words: tuple[str, ...], refuse: Callable[[Campaign], object]
) -> None:
    """A velocity had been taken for an acceleration, and a g for a m/s²."""
    with pytest.raises(InputError) as told:
        refuse(campaign(**changes))
    for word in ("bench, run 7, channel a2", *words):
        assert word in str(told.value)


def test_too_few_lines_are_told_by_the_campaign_and_its_band() -> None:
    narrow = replace(campaign(), band_hz=(24.0, 24.5))
    with pytest.raises(InputError, match=r"^bench: only \d+ lines from 24 to 24\.5 Hz .* 32 are needed"):
        measured_frfs(narrow, lines=60)


def without(role: ChannelRole) -> Campaign:
    """The same with a second run that has no such channel."""
    whole = campaign()
    (first,) = whole.runs
    kept = [k for k, channel in enumerate(first.channels) if channel.role is not role]
    channels = tuple(first.channels[k] for k in kept)
    return replace(whole, runs=(first, replace(first, run=8, channels=channels, samples=first.samples[kept])))


def shortened(seconds: float) -> Campaign:
    """The same with a second run of some ``seconds``."""
    whole = campaign()
    (first,) = whole.runs
    return replace(whole, runs=(first, replace(first, run=8, samples=first.samples[:, : int(100 * seconds)])))


def undriven(force_n: float) -> Campaign:
    """The same with a second run whose force does not change."""
    whole = campaign()
    (first,) = whole.runs
    samples = first.samples.copy()
    samples[0] = force_n
    return replace(whole, runs=(first, replace(first, run=8, samples=samples)))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (undriven(0.0), ("bench, run 8, channel force: is 0 N throughout", "no A/F", "leave this run out")),
        (undriven(0.3), ("bench, run 8, channel force: is 0.3 N throughout", "no A/F", "leave this run out")),
        (without(ChannelRole.REFERENCE), ("bench, run 8: has no force channel", "leave this run out")),
        (replace(without(ChannelRole.RESPONSE), runs=without(ChannelRole.RESPONSE).runs[1:]), ("no response channel",)),
        (shortened(0.5), ("bench, run 8: is 0.5 s long", "11 lines from 2 to 25 Hz", "32 are needed", "whole record")),
    ],
    ids=["no drive", "an offset alone", "no force", "no response", "short"],
)
def test_a_run_that_can_tell_nothing_is_told_before_anything_is_computed(
    given: Campaign, words: tuple[str, ...]
) -> None:
    """Half a second of a sweep had been judged by: held-out data fitted to -632 %."""
    with pytest.raises(InputError) as told:
        check_suitable(given, load_scenario("teaching-beam"))
    for word in words:
        assert word in str(told.value)


def test_a_run_that_nothing_drove_gives_no_responses() -> None:
    """Nor is it left out in silence: what changes from run to run counts them."""
    with pytest.raises(InputError, match=r"(?s)bench, run 8, channel force .* leave run 8 out"):
        measured_frfs(undriven(0.0), lines=60)


def test_a_run_that_is_just_long_enough_is_no_matter() -> None:
    """What is refused then is the next thing: the places of this campaign are no beam's."""
    with pytest.raises(InputError, match="puts node 1 at"):
        check_suitable(shortened(1.5), load_scenario("teaching-beam"))


@pytest.mark.parametrize(
    ("records", "scenario", "odd"),
    [
        ("mAEWing1 Hati", "mAEWing1 Hati", False),
        ("mAEWing1 'Hati' (centre body 2 + wing set 3), hung on one spring", "mAEWing1 Hati", False),
        ("mAEWing1 Hati centre body 2", "mAEWing1 Sköll", True),
        ("Hati", "mAEWing1 Hati", False),
        ("", "mAEWing1 Sköll", False),
        ("mAEWing1 Hati", "", False),
    ],
)
def test_records_of_another_aircraft_are_remarked_on(records: str, scenario: str, odd: bool) -> None:
    notes = {"aircraft": records} if records else {}
    campaign: Any = SimpleNamespace(notes=notes, geometry=Geometry((), np.zeros((0, 3))), response_dofs=())
    quick = load_scenario("quick")
    airframe = quick.airframe.model_copy(update={"name": scenario})
    believed = quick.model_copy(update={"name": "mine", "airframe": airframe})
    said = remarks(campaign, believed)
    assert bool(said) == odd
    assert all(records in text and scenario in text for text in said)


@pytest.mark.parametrize(("off_m", "told"), [(0.009, False), (0.03, True)])
def test_a_point_that_the_two_have_elsewhere_is_remarked_on(off_m: float, told: bool) -> None:
    """Three centimetres on a plank had been an unknown sensor of one's own making, and nothing had been said of it."""
    believed = load_scenario("quick")
    grid = believed.accelerometers.grid
    place = {n: (x, y, 0.0) for n, x, y in zip(grid.node, grid.x_m, grid.y_m, strict=True)}
    x, y, _ = place[2]
    positions = np.array([place[1], (x, y + off_m, 0.0), (0.0, 0.0, 0.0)])
    said = remarks(replace(campaign(), geometry=Geometry((1, 2, 100), positions)), believed)
    assert bool(said) == told
    for remark in said:
        assert remark.startswith(f"bench has node 2 at ({x:.3f}, {y + off_m:.3f}), not ({x:.3f}, {y:.3f}) m, as scen")


@pytest.mark.parametrize(
    ("label", "up_m", "stated", "told", "refused"),
    [
        ("2+Y", 0.03, True, True, False),
        ("2-X", 0.03, True, True, False),
        ("2+Y", 0.12, True, True, True),
        ("2+Y", 0.009, True, False, False),
        ("2+Y", 0.12, False, False, False),
        ("2+Z", 0.12, True, False, False),
    ],
)
def test_heights_count_where_sensors_measure_across_them(
    label: str, up_m: float, stated: bool, told: bool, refused: bool
) -> None:
    """A sensor along a wing moves by its height times the roll; nothing had been said of one on another station."""
    believed = load_scenario("quick")
    grid = believed.accelerometers.grid
    directions = tuple(f"+{label[-1]}" if n == 2 else "+Z" for n in grid.node)
    high = 0.0 if stated else up_m
    grid = grid.model_copy(update={"direction": directions, "z_m": (high,) * len(grid.node)})
    instruments = believed.accelerometers.model_copy(update={"grid": grid})
    believed = believed.model_copy(update={"accelerometers": instruments})
    place = {n: (x, y, 0.0) for n, x, y in zip(grid.node, grid.x_m, grid.y_m, strict=True)}
    x, y, _ = place[2]
    positions = np.array([place[1], (x, y, up_m if stated else 0.0), believed.shaker.position_m])
    positions[2, 2] = 0.0
    records = replace(campaign(dof=Dof.from_label(label)), geometry=Geometry((1, 2, 100), positions))
    said = remarks(records, believed)
    assert bool(said) == told
    assert all(f"node 2 at ({x:.3f}, {y:.3f}, {up_m:.3f}), not ({x:.3f}, {y:.3f}, 0.000) m" in text for text in said)
    if refused:
        with pytest.raises(
            InputError, match=r"(?s)puts node 2 at x = .*, z = 0\.000 m, 0\.12 m from .*to the right and up"
        ):
            check_suitable(records, believed)
    else:
        check_suitable(records, believed)
