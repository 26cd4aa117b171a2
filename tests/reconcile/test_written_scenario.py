"""The comments above a reconciled scenario stay comments, whatever words they hold, and claim no more than is known."""

from __future__ import annotations

import tomllib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from vgvt.reconcile.outcome import augment
from vgvt.scenario import load_scenario


def test_a_name_with_a_line_s_end_stays_a_comment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A sidecar may call its campaign anything."""
    monkeypatch.setattr(augment, "posterior_of", lambda fit: [])
    monkeypatch.setattr(augment, "gain_tables", lambda scenario, fit: ())
    monkeypatch.setattr(augment, "at_whole_cells", lambda fit: fit)
    monkeypatch.setattr(augment, "unwritten", lambda fit: ())
    verdict: Any = SimpleNamespace(
        kind=SimpleNamespace(value="unknown"), reasons=("what\nis left",), effects=(), leads=(),
        scenario=load_scenario("quick"), attribution=SimpleNamespace(final=None),
        resimulated=SimpleNamespace(remark=""),
    )  # fmt: skip
    file = tmp_path / "reconciled.toml"
    augment.write_reconciled(file, verdict, {"campaign": "odd\nname", "thresholds": "of\tthese\r\nplacebos"})
    text = file.read_text("utf-8")
    assert tomllib.loads(text)["name"] == "quick"
    assert text.splitlines()[:4] == [
        "# campaign: odd name", "# thresholds: of these placebos", "# verdict: unknown", "# what is left",
    ]  # fmt: skip


def test_what_stands_at_the_end_of_what_is_tried_is_not_written_as_exact() -> None:
    effect: Any = SimpleNamespace(
        settings={"side": "left"},
        parameters={"mass_kg": (3.0, 0.0, "kg"), "share": (0.5, 0.01, "")},
        ranges={},
        run_numbers={},
    )
    assert augment._values(effect) == [
        "#   side = left", "#   mass_kg = 3 kg (the end of what is tried)", "#   share = 0.5 +- 0.01",
    ]  # fmt: skip


def test_what_was_calibrated_is_written_as_values_beside_the_scores(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = [
        {"name": "EI wing", "factor": 1.000179, "factor_std": 0.0046},
        {"name": "spring", "stated": 120.0, "calibrated": 119.25, "calibrated_std": 0.5, "unit": "N/m", "factor": 1.0},
        {"name": "lean", "shift": -0.0005, "shift_std": 0.0045, "unit": "m"},
    ]
    scores = {"score": 0.039, "std_score": 1.0}
    monkeypatch.setattr(augment, "posterior_of", lambda fit: [row | scores for row in rows])
    monkeypatch.setattr(augment, "gain_tables", lambda scenario, fit: ())
    monkeypatch.setattr(augment, "at_whole_cells", lambda fit: fit)
    monkeypatch.setattr(augment, "unwritten", lambda fit: ())
    verdict: Any = SimpleNamespace(
        kind=SimpleNamespace(value="adequate"), reasons=(), effects=(), leads=(), scenario=load_scenario("quick"),
        attribution=SimpleNamespace(final=None), resimulated=SimpleNamespace(remark=""),
    )  # fmt: skip
    augment.write_reconciled(tmp_path / "reconciled.toml", verdict, {})
    lines = (tmp_path / "reconciled.toml").read_text("utf-8").splitlines()
    assert [line for line in lines if line.startswith("#   ")] == [
        "#   EI wing: +0.04 +- 1.00; x 1.00018 +- 0.0046",
        "#   spring: +0.04 +- 1.00; 120 to 119.25 +- 0.5 N/m",
        "#   lean: +0.04 +- 1.00; -0.0005 +- 0.0045 m",
    ]
