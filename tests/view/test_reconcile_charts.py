"""The charts of a reconciliation on a telephone, and what is drawn over bars of any colour."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from account_by_hand import account, nameless

from vgvt.view.reconcile_account import CandidateRow
from vgvt.view.reconcile_figures import evidence_figure, residual_map_figure
from vgvt.view.reconcile_law import law_figure
from vgvt.view.theme import MEASURED_COLOUR

LONG = "hum-filter (mains_hz = 50, channels = odd)"
ROWS = (
    CandidateRow(1, LONG, 179363.0, 239405.0, 13849.0, 53.9, 0.57, "named"),
    CandidateRow(1, "hum-filter (mains_hz = 60, channels = odd)", 178813.4, 238405.0, 13783.0, 53.9, 0.75, "beaten"),
    CandidateRow(1, "added-mass <x>", 4.0, 20.0, 5.0, 12.0, 13.0, "too little evidence"),
)
NEEDED = 6.0


def map_of(changed: bool):
    return residual_map_figure(account(named=changed))


def test_words_over_the_maps_fit_over_a_hundred_pixels_and_the_axis_is_named_once() -> None:
    """At 13 pixels a letter is about 7 wide; two maps beside each other on a telephone have 90 each."""
    for changed in (True, False):
        figure = map_of(changed)
        texts = [note.text for note in figure.layout.annotations]
        assert texts == [*(["before", "after"] if changed else ["calibrated"]), "frequency, Hz"]
        assert not any(figure.layout[axis].title.text for axis in ("xaxis", "xaxis2") if axis in figure.layout)


def test_the_mark_and_the_limit_have_no_bars_colour() -> None:
    figure = evidence_figure(ROWS, NEEDED)
    assert figure is not None
    *bars, marks = figure.data
    colours = {bar.marker.color for bar in bars}
    assert MEASURED_COLOUR in colours
    assert marks.marker.color not in colours and marks.marker.line.color not in colours
    under, over = figure.layout.shapes
    assert {under.line.color, over.line.color}.isdisjoint(colours)
    assert under.line.width > over.line.width and over.line.dash == "dash"
    assert under.x0 == over.x0 == np.log10(1 + NEEDED)


def test_names_are_of_short_lines_and_ticks_of_few_letters() -> None:
    figure = evidence_figure(ROWS, NEEDED)
    assert figure is not None
    shown = dict(zip(figure.layout.yaxis.tickvals, figure.layout.yaxis.ticktext, strict=True))
    assert shown[LONG].replace("<br>", " ") == LONG
    lines = [line for text in shown.values() for line in text.replace("&lt;", "<").replace("&gt;", ">").split("<br>")]
    assert max(map(len, lines)) <= 24
    assert "added-mass &lt;x&gt;" in shown.values(), "text is no markup"
    assert set(shown) == {name for bar in figure.data[:-1] for name in bar.y}
    inside = [t for v, t in zip(figure.layout.xaxis.tickvals, figure.layout.xaxis.ticktext, strict=True) if v >= 0]
    assert inside == ["0", "10", "1k", "100k"]
    assert len(figure.layout.xaxis.title.text) < 26


def test_the_number_of_a_bar_stands_clear_of_its_mark_and_of_the_limit() -> None:
    figure = evidence_figure(ROWS, NEEDED)
    assert figure is not None
    numbers = {note.y: (note.text, note.x) for note in figure.layout.annotations}
    assert numbers[LONG] == ("179363", np.log10(1 + 179363.0))
    assert numbers["added-mass &lt;x&gt;"] == ("4.0", np.log10(1 + NEEDED))


def test_a_fit_that_had_not_ended_has_no_mark_where_errors_last() -> None:
    broken_off = CandidateRow(1, "root-freeplay", 2.0, 3.0, -7756.0, 12.0, 13.0, "its fit had not ended", "", False)
    figure = evidence_figure((*ROWS, broken_off), NEEDED)
    assert figure is not None
    (marks,) = (trace for trace in figure.data if trace.name == "where errors of the model last")
    assert len(marks.y) == len(ROWS) and "root-freeplay" not in marks.y
    assert any(trace.name == "its fit had not ended" for trace in figure.data)
    assert figure.layout.xaxis.range[0] > -1


def test_a_law_is_drawn_with_its_bands_and_with_what_it_reads_as() -> None:
    thing = nameless()
    figure = law_figure(thing)
    lines = {(t.name, t.yaxis): np.asarray(t.y) for t in figure.data}
    assert lines["fitted", "y"] == pytest.approx(thing.law.real, rel=1e-5)
    assert lines["fitted", "y2"] == pytest.approx(thing.law.imag, rel=1e-5)
    assert thing.read is not None
    assert lines["as it reads", "y2"] == pytest.approx(thing.read.imag, rel=1e-5)
    band = lines["one standard deviation", "y2"].reshape(2, -1)
    assert band[0] - band[1][::-1] == pytest.approx(2 * thing.std.imag, rel=1e-3)
    assert figure.layout.yaxis.title.text == "real, N/m" and figure.layout.yaxis2.title.text == "imaginary, N/m"
    # Where nothing tells the law its band does not leave it flat.
    (wide,) = (t for t in law_figure(replace(thing, std=1e9 * thing.std)).data if t.fill and t.yaxis == "y2")
    assert np.ptp(wide.y) < 8 * np.abs(thing.law).max()
    # Each name once in the legend; without a reading there is no line of one.
    assert [t.name for t in figure.data if t.showlegend] == ["one standard deviation", "fitted", "as it reads"]
    plain = law_figure(replace(thing, read=None, unit=""))
    assert "as it reads" not in {t.name for t in plain.data}
    assert plain.layout.yaxis.title.text == "real"
