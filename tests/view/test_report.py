"""The report: what is in it, what is escaped, and that it appears whole or not at all."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path

import pytest

from vgvt.data import Geometry, InputError, ModalModel, Outcome, Scorecard
from vgvt.view import render_report, write_report
from vgvt.view.sections import facts_section

SECTIONS = {"summary", "modes", "sigma", "shapes", "animation", "mac", "frf", "setup"}


class Outline(HTMLParser):
    """Collects ids, headings, outside addresses and whether every element is closed."""

    VOID = frozenset({"meta", "link", "input", "br"})

    def __init__(self) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.headings: list[int] = []
        self.addresses: list[str] = []
        self.scripts: dict[str, str] = {}
        self.open: list[str] = []
        self.element = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        if tag not in self.VOID:
            self.open.append(tag)
        if values.get("id"):
            self.ids.append(str(values["id"]))
        if re.fullmatch(r"h[1-6]", tag):
            self.headings.append(int(tag[1]))
        self.addresses += [str(values[k]) for k in ("src", "href") if values.get(k)]
        self.element = str(values.get("id", "")) if tag == "script" else ""

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag
        self.element = ""

    def handle_data(self, data: str) -> None:
        if self.element:
            self.scripts[self.element] = self.scripts.get(self.element, "") + data


def parse(page: str) -> Outline:
    outline = Outline()
    outline.feed(page)
    assert outline.open == []
    return outline


@pytest.fixture(scope="module")
def page(example) -> str:
    return render_report(
        "hati-like", example.campaign, example.frf, example.claims, example.truth, example.scorecards, {"Seed": "7"}
    )


def test_every_section_is_there_and_linked(page: str) -> None:
    outline = parse(page)
    assert set(outline.ids) >= SECTIONS
    assert len(set(outline.ids)) == len(outline.ids)
    assert {a for a in outline.addresses if a.startswith("#")} == {f"#{s}" for s in SECTIONS}


def test_nothing_is_fetched_and_the_page_is_small(page: str) -> None:
    assert all(a.startswith(("#", "data:")) for a in parse(page).addresses)
    assert "default-src 'none'" in page
    assert len(page.encode()) < 6_000_000


def test_headings_go_down_one_step_at_a_time(page: str) -> None:
    levels = parse(page).headings
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(b - a <= 1 for a, b in pairwise(levels))


def test_every_figure_has_its_data(page: str) -> None:
    outline = parse(page)
    wanted = set(re.findall(r'data-figure="([^"]+)"', page)) | {"frf-data", "shape-data"}
    for name in wanted:
        json.loads(outline.scripts[name])
    assert len(json.loads(outline.scripts["frf-data"])) == 20


def test_scores_are_in_the_text(page: str) -> None:
    for word in ("4 found", "1 missed", "1 false", "7.930", "13.850", "✕ false", "1st symmetric bending"):
        assert word in page


def test_two_pages_of_the_same_input_are_equal(example, page: str) -> None:
    again = render_report(
        "hati-like", example.campaign, example.frf, example.claims, example.truth, example.scorecards, {"Seed": "7"}
    )
    assert again == page


def test_a_measured_campaign_has_no_truth(example, tmp_path: Path) -> None:
    path = write_report(
        tmp_path / "new" / "report.html", title="measured", campaign=example.campaign, frf=example.frf,
        claims={"plscf": example.claims["plscf"]},
    )  # fmt: skip
    text = path.read_text(encoding="utf-8")
    assert set(parse(text).ids) >= SECTIONS
    assert "13.889" in text
    assert "against the truth" not in text
    assert sorted(p.name for p in path.parent.iterdir()) == ["report.html"]


def test_without_frfs_claims_or_lines_the_page_still_stands(example) -> None:
    geometry = example.campaign.geometry
    campaign = replace(example.campaign, geometry=Geometry(geometry.nodes, geometry.positions_m))
    empty = {"ssi": ModalModel.empty(Outcome.DECLINED, ("it needs a force reference",))}
    outline = parse(render_report("bare", campaign, None, empty, None, {}, {}))
    assert "frf" not in outline.ids
    assert "animation" not in outline.ids
    assert "it needs a force reference" in render_report("bare", campaign, None, empty, None, {}, {})
    assert parse(render_report("bare", campaign, None, {}, None, {}, {})).ids


def test_a_scorecard_of_nothing_found_is_shown(example) -> None:
    card = example.scorecards["quadrature"]
    missed = Scorecard("none", "hati-like", (3.0, 35.0), card.rows(card.modes[1].status))
    empty = {"none": ModalModel.empty(Outcome.NOTHING_FOUND, ())}
    page = render_report("x", example.campaign, example.frf, empty, example.truth, {"none": missed}, {})
    assert "0 found" in page
    assert "– missed" in page


EVIL = "</script><script>alert('&')</script><img src=x onerror=alert(1)>"


def test_text_from_outside_is_escaped_everywhere(example) -> None:
    claim = replace(example.claims["plscf"], labels=(EVIL,) * 5, flags=((EVIL,),) * 5, advice=(EVIL,))
    card = example.scorecards["plscf"]
    marked = replace(card, modes=tuple(replace(r, label=EVIL, remark=EVIL) for r in card.modes))
    campaign = replace(example.campaign, name=EVIL, notes={EVIL: EVIL})
    page = render_report(
        EVIL, campaign, example.frf, {EVIL: claim, "plain": claim}, example.truth, {EVIL: marked}, {EVIL: EVIL}
    )
    outline = parse(page)
    assert EVIL not in page
    assert "<img" not in page.partition("<script>")[0]
    names = {trace.get("name") for trace in json.loads(outline.scripts["sigma-data"])["data"]}
    assert not any("<img" in str(name) for name in names)


def test_a_place_that_cannot_be_written_is_bad_input(example, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(InputError, match="cannot be written"):
        write_report(
            tmp_path / "file" / "report.html", title="x", campaign=example.campaign, frf=None, claims={}
        )  # fmt: skip
    assert [p.name for p in tmp_path.iterdir()] == ["file"]


def test_importing_the_view_loads_no_plotting_library() -> None:
    heavy = ("plotly", "rich", "matplotlib", "scipy", "pandas", "xarray", "h5py", "mujoco")
    code = f"import sys, vgvt.view; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize(
    ("notes", "words"), [((), "force"), (("force: reached a & b",), "force: reached a &amp; b")], ids=["bare", "noted"]
)
def test_an_overload_is_told_with_the_instrument_where_that_is_noted(
    example, notes: tuple[str, ...], words: str
) -> None:
    first, *others = example.campaign.runs
    marked = replace(first, overloaded=("force",), notes=notes)
    section = facts_section(replace(example.campaign, runs=(marked, *others)), {})
    assert f"<dt>Overloaded</dt><dd>run {first.run}: {words}</dd>" in section
