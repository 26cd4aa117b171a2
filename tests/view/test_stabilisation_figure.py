"""The stabilisation diagram and the table of candidates say what became of every pole."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import FrequencyResponseSet, ModalModel, PoleCandidate, grouped_candidates
from vgvt.view import candidates_table, mode_table_figure, render_report, stabilisation_figure

CANDIDATES = (
    *(PoleCandidate(7.93 + 0.001 * n, 0.014, n, True, "7.93 Hz: at all orders") for n in range(2, 12)),
    PoleCandidate(21.0, 0.02, 7, False, "comes up at <one> order only"),
    *(PoleCandidate(12.0 + n, -0.01, n, False, "unstable: negative damping") for n in range(3, 6)),
)


@pytest.fixture
def claim(example) -> ModalModel:
    return replace(example.claims["plscf"], candidates=CANDIDATES)


def test_every_candidate_is_a_marker_with_its_reason(example, claim: ModalModel) -> None:
    figure = stabilisation_figure(claim, example.frf, (3.0, 35.0))
    markers = [trace for trace in figure.data if trace.mode == "markers"]
    assert sum(len(trace.x) for trace in markers) == len(CANDIDATES)
    kept = next(trace for trace in markers if trace.name == "of a claimed mode")
    assert list(kept.y) == list(range(2, 12))
    texts = [text for trace in markers for text in trace.hovertext]
    assert sum("&lt;one&gt;" in text for text in texts) == 1
    assert next(t for t in markers if t.name == "unstable").visible == "legendonly"


def test_the_sigma_plot_lies_behind_the_poles(example, claim: ModalModel) -> None:
    figure = stabilisation_figure(claim, example.frf)
    assert figure.data[0].name == "sigma plot"
    assert figure.layout.yaxis2.overlaying == "y"
    assert all(trace.yaxis == "y2" for trace in figure.data[1:])


def test_without_frfs_or_candidates(claim: ModalModel, example) -> None:
    assert all(trace.name != "sigma plot" for trace in stabilisation_figure(claim).data)
    with pytest.raises(ValueError, match="no candidates"):
        stabilisation_figure(example.claims["plscf"])


def test_the_page_has_a_diagram_for_claims_with_candidates_only(example, claim: ModalModel) -> None:
    def page(frf: FrequencyResponseSet | None, **claims: ModalModel) -> str:
        return render_report("t", example.campaign, frf, claims, None, {}, {})

    assert 'id="stabilisation"' not in page(example.frf, quadrature=example.claims["quadrature"])
    both = page(None, quadrature=example.claims["quadrature"], plscf=claim)
    assert both.count('data-figure="stabilisation-data-') == 1
    data = both.split('id="stabilisation-data-1">')[1].split("</script>")[0]
    assert len(json.loads(data)["data"]) == 3


def test_groups_count_every_candidate_once() -> None:
    groups = grouped_candidates(CANDIDATES)
    assert sum(g.poles for g in groups) == len(CANDIDATES)
    assert [g.kept for g in groups] == [True, False, False]
    assert groups[0].order == (2, 11)
    assert groups[0].frequency_hz == pytest.approx((7.932, 7.941))


def test_the_table_for_the_terminal_has_a_row_for_each_fate(claim: ModalModel) -> None:
    table = candidates_table(claim)
    assert [str(row[-2]) for row in table.rows] == ["kept", "dropped", "dropped"]
    assert table.caption == "10 of 14 poles stand behind the modes"


def test_the_mode_table_has_a_row_for_each_mode(claim: ModalModel) -> None:
    cells = mode_table_figure(claim).data[0].cells["values"]
    assert len(cells[0]) == len(claim)
    np.testing.assert_allclose([float(x) for x in cells[1]], claim.natural_frequency_hz, atol=6e-4)
    assert len(mode_table_figure(claim.select([])).data[0].cells["values"][0]) == 0
