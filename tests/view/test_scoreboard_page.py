"""The scoreboard page: complete, self-contained, safe against what names and reasons may hold."""

from __future__ import annotations

import re

import pytest

from vgvt.bench.table import table_of
from vgvt.view.scoreboard_figures import bound_figure, calibration_figure, front_figure
from vgvt.view.scoreboard_page import render_scoreboard_page, write_scoreboard_page


def row(entry: str, number: int, mode: int, **more):
    stem = {
        "scenario": "plate",
        "seed_number": number,
        "seed": number,
        "entry": entry,
        "identifier": entry,
        "outcome": "found",
        "mode": mode,
        "status": "found",
        "label": f"mode {mode}",
        "true_hz": 10.0 * (mode + 1),
        "claimed_hz": 10.0 * (mode + 1) + 0.001 * (1 + number),
        "frequency_error_percent": 0.01 * (1 + number),
        "frequency_std_hz": 0.002,
        "frequency_bound_hz": 0.001,
        "frequency_covered": True,
        "damping_error_percent": 1.0,
        "damping_covered": True,
        "mac": 0.999,
        "wall_s": 0.5,
    }
    return stem | more


@pytest.fixture
def page() -> str:
    rows = [row(entry, n, m) for entry in ("era", "cfdd") for n in range(3) for m in range(2)]
    rows.append(row("cfdd", 0, 2, status="missed", claimed_hz=None, frequency_error_percent=None, mac=None))
    rows.append(row("era", 1, 2, status="false", true_hz=None, claimed_hz=17.5, mac=None, label="<b>x</b>"))
    rows.append(
        {"scenario": "plate", "seed_number": 0, "seed": 0, "entry": "hang", "identifier": "hang"}
        | {"outcome": "failed", "reason": "took more than 60 s </script>"}
    )
    return render_scoreboard_page(table_of(rows))


def test_it_asks_nothing_of_the_network(page) -> None:
    body = re.sub(r"<script>.*?</script>", "", page, flags=re.S)
    assert not re.search(r"""(src|href)\s*=\s*["']?(https?:)?//""", body)
    assert "default-src 'none'" in page


def test_every_cell_of_the_matrix_leads_to_its_modes(page) -> None:
    targets = set(re.findall(r'id="([^"]+)"', page))
    links = set(re.findall(r'href="#([^"]+)"', page))
    assert links <= targets
    assert {"plate--era", "plate--cfdd", "plate--hang"} <= links


def test_the_matrix_counts_as_one_would_by_hand(page) -> None:
    # cfdd: six found of seven true over three campaigns; era: six of six and one false.
    assert "2 of 2.33" in page
    assert "2 of 2</a> ✕ 0.33" in page
    # Errors of 1, 2 and 3 thousandths over a bound of one: sqrt(14 / 3).
    assert "÷ 2.16" in page


def test_a_failure_is_told_with_its_reason_and_cannot_become_markup(page) -> None:
    assert "took more than 60 s &lt;/script&gt;" in page
    assert "no claim" in page


def test_the_file_appears_whole(tmp_path) -> None:
    path = write_scoreboard_page(tmp_path / "s.html", table_of([row("era", 0, 0)]))
    assert path.read_text(encoding="utf-8").endswith("</html>\n")


def test_every_entry_looks_the_same_in_all_figures_and_like_no_other() -> None:
    names = [f"method-{k:02d}" for k in range(12)]
    table = table_of([row(name, number, mode) for name in names for number in range(3) for mode in range(2)])
    figures = [bound_figure(table), calibration_figure(table), front_figure(table)]
    looks = [
        {
            trace.name.split(" ")[0]: (trace.marker.color, trace.marker.symbol)
            for trace in figure.data
            if trace.name.startswith("method")
        }
        for figure in figures
        if figure is not None
    ]
    assert len(looks) == 3
    assert looks[0] == looks[1] == looks[2]
    assert len(set(looks[0].values())) == 12
