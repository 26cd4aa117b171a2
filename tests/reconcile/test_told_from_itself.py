"""Before the test it is said from which other places of its own an effect is not told: left and right, for one."""

from __future__ import annotations

import dataclasses

import pytest

from vgvt.cli.reconcile_power import _places
from vgvt.cli.reconcile_tables import power_table
from vgvt.effects import available_effects
from vgvt.reconcile.next_test.before_test import expected_fit
from vgvt.reconcile.next_test.power import Power, _one_in_the_ratio, _where, power
from vgvt.reconcile.next_test.power_rows import power_rows
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.scenario import load_scenario
from vgvt.view.reconcile_sections import power_section

CENTRE_LINE = """
extends = "quick"
name = "centre-line"
summary = "All on the centre line."
[suspension]
hook_m = [0.6005, 0.0, 0.03]
[shaker]
position_m = [0.635, 0.0, 0.0]
[accelerometers.grid]
node = [1, 2, 3, 4, 5, 6]
x_m = [0.15, 0.25, 0.35, 0.45, 0.55, 0.70]
y_m = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
[acquisition]
runs = [[1, 2, 3, 4, 5, 6]]
[tolerances]
segments = 0
"""
KNOWN = available_effects()


@pytest.fixture(scope="module")
def seen(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Power]:
    """Masses left, right and in the middle, and gains of two channels, by their places."""
    folder = tmp_path_factory.mktemp("centre-line")
    file = folder / "centre-line.toml"
    file.write_text(CENTRE_LINE, encoding="utf-8")
    null = expected_fit(load_scenario(file), lines=60, cache=folder)
    tried = {n: Hypothesis(KNOWN["added-mass"], {"x_m": 0.9, "y_m": y}) for n, y in (("right", 1.3), ("left", -1.3))}
    tried["middle"] = Hypothesis(KNOWN["added-mass"], {"x_m": 0.15, "y_m": 0.0})
    tried |= {f"gain {k}": Hypothesis(KNOWN["channel-gain"], {"channels": f"{k}+Z"}) for k in (2, 3)}
    found = power(null, list(tried.values()))
    return {name: next(p for p in found if p.label == h.label) for name, h in tried.items()}


def test_left_is_not_told_from_right_by_what_lies_between_them(seen: dict[str, Power]) -> None:
    for name, other in (("left", "right"), ("right", "left")):
        (label, cosine), *more = seen[name].elsewhere
        assert (label, cosine > 0.9) == (seen[other].label, True)
        assert all(cosine >= less > 0.6 for _, less in more)
    assert seen["middle"].elsewhere == ()
    # Another effect is no other place of it.
    assert not any("added-mass" in label for k in (2, 3) for label, _ in seen[f"gain {k}"].elsewhere)
    assert seen["left"].document()["elsewhere"] == seen["left"].elsewhere


def test_a_row_says_where_it_shows_best_and_where_else_it_could_be(seen: dict[str, Power]) -> None:
    sides = [seen["left"], seen["right"]]
    (row,) = power_rows(sides)
    best, other = sorted(sides, key=lambda p: p.smallest)
    assert (row.variant, row.elsewhere) == (best.label, best.elsewhere)
    place, elsewhere = (p.label.removeprefix("added-mass (").removesuffix(")") for p in (best, other))
    assert (row.place, row.other_places[0][0]) == (place, elsewhere)
    page = power_section([row])
    assert f"best with {place}" in page and f"place not told from {elsewhere} (" in page
    assert f"itself at {elsewhere}" in str(power_table([row]).rows)
    told = _places(row)["not_told_from"]
    assert told == [{"variant": label, "cosine": cosine} for label, cosine in best.elsewhere]
    alone = dataclasses.replace(row, variants=1, elsewhere=())
    assert alone.place == "" and "not told from " not in power_section([alone]).split("<table>")[1]


def test_a_change_from_another_run_on_is_no_other_place() -> None:
    """It would crowd out the places: three are told."""
    drift = KNOWN["gain-drift"]
    early, late = (Hypothesis(drift, {"channels": "6+Z", "from_run": k}) for k in (2, 3))
    assert _where(early) == _where(late) != _where(Hypothesis(drift, {"channels": "7+Z", "from_run": 2}))


def test_the_force_and_all_responses_are_one_place() -> None:
    """No test tells one from the other by A/F: it is a quotient."""
    delay = available_effects()["channel-delay"]

    def on(channels: str) -> Hypothesis:
        return Hypothesis(delay, {"channels": channels})

    assert _one_in_the_ratio(on("force"), on("response")) and _one_in_the_ratio(on("response"), on("force"))
    assert not _one_in_the_ratio(on("force"), on("sensor-1"))
    assert not _one_in_the_ratio(on("force"), on("force"))
