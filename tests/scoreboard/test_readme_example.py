"""The worked example of scoreboard/README.md, recomputed from the numbers in its text."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from vgvt.data import Direction, Dof, ModeScore
from vgvt_scoreboard import PairingRule, fit_percent, pair_modes, pointwise_nu_gap, score

README = Path(__file__).parents[2] / "scoreboard" / "README.md"


@pytest.fixture(scope="module")
def text() -> str:
    return README.read_text(encoding="utf-8")


def table(text: str, first_header: str) -> list[list[str]]:
    """Rows of the table whose header line starts with these cells."""
    lines = text.splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith(f"| {first_header}"))
    rows = []
    for line in lines[start + 2 :]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip() for cell in line.strip().strip("|").split("|")])
    return rows


def agrees(printed: str, value: float | None) -> bool:
    """Whether the printed number is the value rounded to the printed digits; an empty cell is None."""
    if not printed or value is None:
        return not printed and value is None
    digits = len(printed.partition(".")[2])
    return abs(float(printed) - value) <= 0.5 * 10.0**-digits + 1e-12


def residues(cells: list[str]) -> dict[str, object]:
    """Residues at the three sensors for a force at the first one."""
    values = np.array([[float(v) for v in cell.split(",")] for cell in cells], dtype=complex)
    return {"residues": values[:, :, None], "references": (Dof(1, Direction.PLUS_Z),)}


@pytest.fixture
def models(text: str, model):
    true_rows = table(text, "mode | frequency, Hz | bound")
    claim_rows = table(text, "mode | frequency, Hz | ± Hz")
    truth = model(
        [float(r[1]) for r in true_rows],
        [float(r[3]) / 100 for r in true_rows],
        [[float(v) for v in r[4].split(",")] for r in true_rows],
        labels=tuple(r[0] for r in true_rows),
        natural_frequency_std_hz=np.array([float(r[2]) for r in true_rows]),
        **residues([r[5] for r in true_rows]),
    )
    claim = model(
        [float(r[1]) for r in claim_rows],
        [float(r[3]) / 100 for r in claim_rows],
        [[float(v) for v in r[4].split(",")] for r in claim_rows],
        labels=tuple(r[0] for r in claim_rows),
        natural_frequency_std_hz=np.array([float(r[2]) if r[2] else np.nan for r in claim_rows]),
        **residues([r[5] for r in claim_rows]),
    )
    return truth, claim


def test_pair_costs(text: str, models) -> None:
    truth, claim = models
    rule = PairingRule()
    result = pair_modes(truth, claim, rule)
    rows = table(text, "pair | pole distance")
    printed = {tuple(int(name[1]) - 1 for name in row[0].split()): row[1:] for row in rows}
    assert set(printed) == set(zip(*(k.tolist() for k in np.nonzero(result.admissible)), strict=True))
    for pair, (distance, mac, cost) in printed.items():
        assert agrees(distance, result.pole_distance[pair])
        assert agrees(mac, result.mac[pair])
        total = result.pole_distance[pair] / rule.max_pole_distance + rule.mac_weight * (1 - result.mac[pair])
        assert agrees(cost, total)


def test_result(text: str, models, sealed) -> None:
    truth, claim = models
    card = score(sealed(truth), claim, (1.0, 40.0))
    rows = table(text, "true, Hz | claimed, Hz")
    assert len(rows) == len(card.modes)
    for printed, row in zip(rows, card.modes, strict=True):
        check_row(printed, row)


def check_row(printed: list[str], row: ModeScore) -> None:
    values = (
        row.true_hz,
        row.claimed_hz,
        row.frequency_error_percent,
        row.damping_error_percent,
        row.mac,
        row.scaling_error_percent,
        row.frequency_efficiency,
    )
    for cell, value in zip(printed[:7], values, strict=True):
        assert agrees(cell, value), (cell, value, row)
    assert printed[7] == {True: "yes", False: "no", None: ""}[row.frequency_covered]
    assert printed[8] == row.status.value


def test_rule_in_words_is_the_rule_in_use(text: str) -> None:
    rule = PairingRule()
    assert f"at most {rule.max_pole_distance:.2f}" in text
    assert f"at least {rule.min_mac}" in text
    assert f"+ {rule.mac_weight} (1 − MAC)" in text


def test_split_of_the_example_says_so(models, sealed) -> None:
    truth, claim = models
    card = score(sealed(truth), claim, (1.0, 40.0))
    assert [r.remark.partition(":")[0] for r in card.modes if r.remark] == ["split"]
    silent = score(sealed(truth), replace(claim, natural_frequency_std_hz=None), (1.0, 40.0))
    assert all(r.frequency_covered is None for r in silent.modes)


def test_fit_and_gap(text: str) -> None:
    y, y_hat, fit = re.search(r"For y = ([\d, ]+) and ŷ = ([\d, ]+):\s.*?the fit ([\d.]+) %", text, re.S).groups()
    assert agrees(fit, float(fit_percent(np.array(eval_row(y)), np.array(eval_row(y_hat)))))
    p1, p2, gap = re.search(r"P₁ = (\d), P₂ = (\d) it is\s+1 / √\(5 · 2\) = ([\d.]+)", text).groups()
    assert agrees(gap, pointwise_nu_gap(np.full((1, 1, 1), float(p1)), np.full((1, 1, 1), float(p2)))[0])
    first, second, gap = re.search(
        r"columns \(([\d, ]+)\) and \(([\d, ]+)\) it is √\(1.5 / 2\) = ([\d.]+)", text
    ).groups()
    columns = [np.array(eval_row(c)).reshape(-1, 1, 1) for c in (first, second)]
    assert agrees(gap.rstrip("."), pointwise_nu_gap(*columns)[0])


def eval_row(cells: str) -> list[float]:
    return [float(c) for c in cells.split(",")]
