"""A claim without the force stands beside the modes that it could find, and those as tested beside these."""

from __future__ import annotations

import io
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from vgvt.bench.entry import Entry
from vgvt.bench.rows import score_rows
from vgvt.bench.table import table_of
from vgvt.data import ModeStatus, Scorecard, TrueModes, Truth
from vgvt.view import render_report, scorecard_table
from vgvt.view.scoreboard_page import render_scoreboard_page

REMARK = "the force is not used: judged by the modes with the shaker attached"


@pytest.fixture(scope="module")
def truth(example) -> Truth:
    """The shaker stiffens everything by a twentieth and adds damping."""
    (tested,) = example.truth.as_tested
    shaken = replace(
        tested,
        natural_frequency_hz=tested.natural_frequency_hz * 1.05,
        damping_ratio=tested.damping_ratio * 3,
        labels=(),
    )
    return replace(example.truth, coupled=(shaken,))


@pytest.fixture(scope="module")
def card(example) -> Scorecard:
    """The card of a method without the force that was right about the modes with the shaker, but for one."""
    rows = [
        replace(
            row,
            true_hz=1.05 * row.true_hz,
            claimed_hz=1.05 * row.true_hz,
            true_damping_ratio=3 * row.true_damping_ratio,
            as_tested_hz=row.true_hz,
            as_tested_damping_ratio=row.true_damping_ratio,
        )
        for row in example.scorecards["plscf"].modes
    ]
    rows[0] = replace(rows[0], status=ModeStatus.MISSED, claimed_hz=None, claimed_index=None, mac=None)
    found = example.scorecards["plscf"]
    return replace(found, identifier="ssi-cov", modes=tuple(rows), true_modes=TrueModes.COUPLED, remarks=(REMARK,))


@pytest.fixture(scope="module")
def page(example, truth: Truth, card: Scorecard) -> str:
    claims = {"quadrature": example.claims["quadrature"], "ssi-cov": example.claims["plscf"]}
    cards = {"quadrature": example.scorecards["quadrature"], "ssi-cov": card}
    return render_report("two methods", example.campaign, example.frf, claims, truth, cards, {})


def test_each_table_says_what_its_claims_are_judged_by(page: str) -> None:
    captions = re.findall(r"<caption>(.*?)</caption>", page)
    assert captions == [
        "Claims against the truth as tested, 3 to 35 Hz.",
        "Claims against the truth with the shaker attached, 3 to 35 Hz.",
    ]
    with_force, without = (part for part in page.split("<table>")[1:3])
    assert "as tested, Hz" not in with_force
    assert "as tested, Hz" in without
    assert '<td class="">7.930</td>' in without
    assert page.count(REMARK) == 1


def test_the_sigma_plot_has_the_modes_as_tested_only(page: str, example) -> None:
    """The measured force takes the shaker out of it."""
    assert (
        "Claims that were made without the force are judged by those with the shaker attached, not drawn here" in page
    )
    data = json.loads(re.search(r'id="sigma-data">(.*?)</script>', page, re.S).group(1))
    drawn = sorted(shape["x0"] for shape in data["layout"]["shapes"])
    np.testing.assert_allclose(drawn, example.truth.as_tested[0].natural_frequency_hz)


def test_shapes_and_mac_are_those_with_the_shaker(page: str) -> None:
    names = [
        scene["name"]
        for scene in json.loads(re.search(r'id="shape-data">(.*?)</script>', page, re.S).group(1))["models"]
    ]
    assert names == ["quadrature", "ssi-cov", "truth", "truth with the shaker attached"]
    assert "quadrature against the truth<" in page
    assert "ssi-cov against the truth with the shaker attached<" in page
    assert "<b>8.33 Hz</b> · truth" in page  # the lost mode, 1.05 times 7.93 Hz


def test_the_terminal_says_so_too(example, card: Scorecard) -> None:
    def words(shown: Scorecard) -> str:
        console = Console(width=160, file=io.StringIO())
        console.print(scorecard_table(shown))
        return str(console.file.getvalue())

    assert "the truth with the shaker attached" in words(card)
    assert "as tested Hz" in words(card)
    plain = words(example.scorecards["plscf"])
    assert "shaker" not in plain and "as tested" not in plain


def test_the_bench_keeps_it_in_its_table_and_on_its_page(card: Scorecard) -> None:
    common = {"scenario": "plate", "seed_number": 0, "seed": 1}
    table = table_of(score_rows(common, Entry("ssi-cov"), card, None))
    assert set(table["true_modes"]) == {"coupled"}
    np.testing.assert_allclose(table["as_tested_hz"].astype(float) * 1.05, table["true_hz"].astype(float))
    page = render_scoreboard_page(table)
    assert "up to 5 % away in frequency and a factor of 3 in damping, whatever the method" in page
    as_tested = table_of(score_rows(common, Entry("plscf"), replace(card, true_modes=TrueModes.AS_TESTED), None))
    assert "Without the force" not in render_scoreboard_page(as_tested)
