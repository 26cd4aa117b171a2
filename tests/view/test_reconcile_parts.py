"""Parts of a reconciliation's page: places and their letters, the file simulated again, limits, calibrated bars."""

from __future__ import annotations

import re
from dataclasses import replace

from account_by_hand import account

from vgvt.view.reconcile_account import PosteriorRow
from vgvt.view.reconcile_drawing import places_drawing, places_key
from vgvt.view.reconcile_figures import posterior_figure
from vgvt.view.reconcile_page import render_reconcile_page
from vgvt.view.reconcile_wording import next_steps, verdict_sentence


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
