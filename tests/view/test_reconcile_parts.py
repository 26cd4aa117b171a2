"""Parts of a reconciliation's page: places and their letters, the file simulated again, limits, calibrated bars."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from account_by_hand import account, nameless

from vgvt.view.reconcile_account import ElsewhereRow, PosteriorRow
from vgvt.view.reconcile_drawing import places_drawing, places_key
from vgvt.view.reconcile_figures import overlay_figure, posterior_figure, residual_map_figure
from vgvt.view.reconcile_page import render_reconcile_page
from vgvt.view.reconcile_sections import named_section, places_table
from vgvt.view.reconcile_wording import disproofs, next_steps, verdict_sentence


def static(page: str) -> str:
    """What is read of a page before its scripts."""
    return page.split("<script", 1)[0]


def test_a_place_is_named_only_where_it_explains_enough() -> None:
    told = account("unknown", named=False)
    assert "the residual points at force at 8+Z" in verdict_sentence(told)
    assert any("where to knock" in step for step in next_steps(told))
    nowhere = replace(
        told, places=tuple(replace(p, explained=e) for p, e in zip(told.places, (0.04, 0, -0.02), strict=True))
    )
    for denied in (nowhere, replace(told, places=())):
        assert "points at" not in verdict_sentence(denied)
        assert next_steps(denied) and not any("where to knock" in step for step in next_steps(denied))


def test_a_name_whose_place_is_open_is_told_with_its_places_and_advice_of_its_own() -> None:
    """Of one name "it is local-absorber" cannot be what the campaign cannot tell."""
    here, there = "at x = 0.90 m, y = -1.29 m", "at x = 0.90 m, y = 1.29 m"
    told = account()
    alone = replace(told.effects[0], equivalent=(), elsewhere=(ElsewhereRow(there, here, {}, {}),))
    open_place = replace(told, effects=(alone,))
    assert f"it is added-mass {here} or {there}; held-out data" in verdict_sentence(open_place)
    steps = next_steps(open_place)
    assert steps[0].startswith("Next test: ")
    assert steps[1] == f"added-mass may be {here} or {there}: look at each of these places first."
    assert any("--only added-mass, which is tried at every place." in step for step in steps)
    assert not any("for every name" in step for step in steps)
    assert f"the same {there}" in named_section(open_place)
    assert "nothing else that was tried" not in named_section(open_place)
    both = replace(told, effects=(replace(alone, equivalent=("local-absorber",)),))
    assert f"it is added-mass ({here} or {there}) or local-absorber; held-out" in verdict_sentence(both)
    assert any("--only for every name" in step for step in next_steps(both))
    assert f"local-absorber, the same {there}" in named_section(both)
    settled = next_steps(replace(told, effects=(replace(alone, elsewhere=()),)))
    assert any("--only for every name" in step for step in settled) and not any("may be" in step for step in settled)


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("structure", "where to knock"),
        ("drive", "look at the force cell"),
        ("sensor", "look at that sensor"),
        ("airframe", "changes all of it at once"),
    ],
)
def test_a_thing_without_a_name_is_shown_with_its_law_and_is_where_to_look(kind: str, words: str) -> None:
    thing = replace(nameless(), kind=kind)
    told = replace(account("unknown", named=False), nameless=thing, tests=())
    assert f"one thing without a name, a {thing.words}, fits it best" in verdict_sentence(told)
    assert "the residual points at" not in verdict_sentence(told)
    first, *others = next_steps(told)
    assert words in first and thing.words in first
    # It is the place that counts, and there is one.
    assert not any("points at" in step for step in others)
    assert words in next_steps(replace(account("partly_explained"), nameless=thing, tests=()))[0]
    page = render_reconcile_page(told)
    assert "One thing without a name" in page and "A force at 8+Z that &lt;is&gt; smooth." in page
    assert '"law-data"' in page and "as it reads" in page
    assert "One thing without a name" not in render_reconcile_page(account())


def test_what_the_file_does_when_simulated_stands_beside_the_fit() -> None:
    merit = {"chi2_per_dof": 1.57, "nrmse_percent": 88.0, "mean_abs_db": 0.4, "frac": 0.98, "nu_gap": 0.077}
    sets = {"train": merit, "held_out": None, "held_runs": None, "held_channels": None}
    told = replace(account(), resimulated=sets, resimulation_remark="It is 2 % from what was fitted")
    body = static(render_reconcile_page(told))
    assert body.count("fitted, simulated again") == 1
    assert body.index("fitted, after") < body.index("fitted, simulated again") < body.index("held out, all, before")
    assert "1.57" in body and "0.077" in body and "0.123" in body
    assert "<p>It is 2 % from what was fitted.</p>" in body
    assert "simulated again" not in static(render_reconcile_page(account())).lower()


def test_where_limits_come_from_is_folded_away() -> None:
    body = static(render_reconcile_page(account()))
    assert re.search(r"<details><summary>Where the limits come from</summary><p[^>]*>a study\.</p></details>", body)
    assert body.count("a study") == 1


def test_letters_go_by_rank_and_what_has_no_point_is_said_so() -> None:
    told = account()
    first = replace(told.places[2], label="force channel", explained=0.9)
    idle = replace(told.places[0], label="force at 3+Z", explained=-0.01)
    places = (first, told.places[0], told.places[1], idle)
    drawing, key = places_drawing(told.geometry, places), places_key(places)
    assert re.findall(r'<text class="place-label"[^>]*>(\w)</text>', drawing) == ["B", "C"]
    assert "<b>A</b> force channel: 90 % (no point on the map); <b>B</b> force at 8+Z: 81 %; <b>C</b> bending" in key
    assert "3+Z" not in key


def test_a_place_that_explains_less_than_chance_explains_nothing() -> None:
    """Of a model that is met far below noise places had shares like -1516 %: chance over next to nothing."""
    told = account()
    told = replace(
        told, places=tuple(replace(p, explained=e) for p, e in zip(told.places, (0.8, -15.16, 0.004), strict=True))
    )
    rows, drawing = places_table(told), places_drawing(told.geometry, told.places)
    assert re.findall(r"(80 %|nothing|-\d+ %)", rows) == ["80 %", "nothing", "nothing"]
    assert "-1516" not in drawing and "8+Z: 80 %</title>" in drawing


def test_names_of_what_was_calibrated_take_no_width() -> None:
    """On a telephone they left a fifth of it to the figure: each stands above its row, from the left edge on."""
    figure = posterior_figure(account())
    assert figure is not None
    assert figure.layout.yaxis.showticklabels is False
    (name,) = figure.layout.annotations
    assert (name.text, name.y, name.x, name.xref, name.xanchor) == (
        "EI of the wing", "EI of the wing", 0, "paper", "left",
    )  # fmt: skip
    assert name.yshift > 0


def test_what_makes_a_bar_longer_than_its_tolerance_is_said() -> None:
    page = render_reconcile_page(account())
    assert "The whole of it holds, too, by how much the result may have been led astray" in page
    wide = PosteriorRow("spring", "stiffness", -0.8, 1.18, "× 0.96 ± 0.056", fresh_std=0.7)
    figure = posterior_figure(replace(account(), posterior=(wide,)))
    assert figure is not None
    assert [trace.error_x.array for trace in figure.data] == [(0.7,), (1.18,)]
    assert figure.data[0].error_x.thickness > figure.data[1].error_x.thickness


def test_a_hold_out_that_was_chosen_afterwards_is_not_said_to_come_first() -> None:
    body, turned = (static(render_reconcile_page(replace(account(), turned=t))) for t in (False, True))
    assert "seed before the first one: whole runs" in body
    assert "before the first one" not in turned
    assert "another hold-out than the first one, chosen as data held out at first were missed: whole runs" in turned


def test_what_sigma_is_made_up_of_is_said_where_the_disproof_points() -> None:
    told = replace(account("unknown", named=False), noise_per_dof=0.55, model_form=0.01)
    body = static(render_reconcile_page(told))
    assert any("how sigma is made up, under the table" in line for line in disproofs(told))
    assert "How sigma is made up: its median is 2.00 % of the response" in body
    assert "1 % of the response and as much of its median" in body
    assert "Noise is 0.55 of each 1 on fitted data" in body
    assert body.index("how far all tolerances") < body.index("How sigma is made up") < body.index("Square error over")


@pytest.mark.parametrize("named", [True, False])
def test_nothing_is_called_before_where_nothing_comes_after(named: bool) -> None:
    told = account("explained" if named else "adequate", named)
    names = ["before", "after"] if named else ["calibrated"]
    assert [a.text for a in residual_map_figure(told).layout.annotations[: len(names)]] == names
    assert list(dict.fromkeys(t.name for t in overlay_figure(told, 0).data)) == ["measured", *names]
    body = static(render_reconcile_page(told))
    assert ("before an effect is added and after" in body) == named
    assert f"Measured, {' and '.join(names)}; the lowest panel" in body
    assert "1 is what noise and the model&#x27;s floor explain" in body
    assert "no line of the data falls" in body


def test_every_row_of_the_residual_says_of_which_data_it_is() -> None:
    body = static(render_reconcile_page(account()))
    rows = ("fitted data", "sums over neighbouring lines, fitted data", "held-out data", "lines beyond 3 sd, all data")
    found = [body.index(f"{words}</td>") for words in rows]
    assert found == sorted(found)
    # Of 120 lines: neither is 0 by chance, nor 0.27 %.
    assert "channels a correlation of 0.08" in body and "puts 0.0001 of lines beyond 3 sd" in body


@pytest.mark.parametrize(
    ("label", "kind", "words"),
    [
        ("force at 8+Z", "structure", "points at force at 8+Z: on the aircraft that is where to knock"),
        ("force channel", "drive", "points at the force channel: look at the force cell"),
        ("run 4, 12+Z", "sensor", "points at run 4, 12+Z: look at that sensor"),
        ("stiffness of the whole airframe", "airframe", "points at the stiffness of the whole airframe: look for what"),
    ],
)
def test_where_to_look_is_said_in_the_step_itself(label: str, kind: str, words: str) -> None:
    told = replace(account("unknown", named=False), tests=())
    (step, *_) = next_steps(replace(told, places=(replace(told.places[0], label=label, kind=kind),)))
    assert words in step and "below" not in step
