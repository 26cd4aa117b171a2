"""The charts and colours of the scoreboard page: names whole, axes that can be read, no praise for a poor ratio."""

from __future__ import annotations

import re

import numpy as np
import pytest

from vgvt.bench.table import table_of
from vgvt.view.scoreboard_figures import front_figure
from vgvt.view.scoreboard_sections import matrix_section


def row(entry: str, wall_s: float, error_over_bound: float, **more):
    return {
        "scenario": "plate", "seed_number": 0, "seed": 0, "entry": entry, "identifier": entry, "outcome": "found",
        "mode": 0, "status": "found", "label": "mode 0", "true_hz": 10.0, "claimed_hz": 10.0 + 1e-3 * error_over_bound,
        "frequency_bound_hz": 1e-3, "mac": 0.999, "wall_s": wall_s,
    } | more  # fmt: skip


@pytest.mark.parametrize(
    ("fast", "slow"), [((1.3, 5.7), (2.4, 1.2)), ((0.22, 0.5), (0.22, 0.5)), ((1e-3, 1e4), (50.0, 1.0))]
)
def test_speed_and_accuracy_has_axes_between_numbers_and_names_that_grow_inwards(fast, slow) -> None:
    figure = front_figure(table_of([row("era:arrangement=simo", *fast), row("auto", *slow)]))
    for axis, values in ((figure.layout.xaxis, (fast[0], slow[0])), (figure.layout.yaxis, (fast[1], slow[1]))):
        ticks = axis.tickvals
        assert len(ticks) >= 2
        assert ticks[0] < min(values) and max(values) < ticks[-1]
        assert 10 ** axis.range[0] == pytest.approx(ticks[0]) and 10 ** axis.range[1] == pytest.approx(ticks[-1])
        assert len(ticks) <= 12
    low, high = figure.layout.xaxis.range
    for trace in figure.data:
        share = (np.log10(trace.x[0]) - low) / (high - low)
        assert trace.textposition == ("top right" if share < 0.34 else "top left" if share > 0.66 else "top center")
        assert trace.text == (trace.name,)


def test_a_very_long_name_is_short_in_the_chart_and_whole_when_pointed_at() -> None:
    name = "maximum-likelihood:order=40,cut=3,refine=true"
    (trace,) = front_figure(table_of([row(name, 1.0, 2.0)])).data
    assert len(trace.text[0]) <= 28
    assert trace.customdata[0] == name


def test_the_colour_of_a_cell_is_of_its_modes_and_not_of_its_ratio() -> None:
    page = matrix_section(table_of([row("era", 1.0, 177.0)]))
    (cell,) = re.findall(r"<td[^>]*>.*?</td>", page)
    assert "÷ 177" in cell
    assert cell.startswith('<td><a class="found"')
    assert "colour tells of the modes alone" in page
