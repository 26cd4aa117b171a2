"""The table of the study: it reads back as written, keeps what was judged blind, and fills the page."""

from __future__ import annotations

from pathlib import Path

import closing_the_loop as study
import loop_results
import loop_rows
import pytest

from vgvt.data import InputError

ROW: loop_rows.Row = {
    "group": "effect", "truth": "added-mass", "draw": 3, "size": 2.0, "noise": 0.01, "source": "simulation",
    "engine": "linear", "catalogue": 64, "seed": 5, "core": "12345678", "ratio": float("inf"), "verdict": "explained",
    "named": "added-mass", "answer": "right", "evidence_nats": -2.5, "near": False, "known_place": True, "leads": "",
    "deviations": "mass_kg -0.7", "oracle_held_out": None, "cpu_s": 40.1, "settings": "{'added-mass': {}}",
}  # fmt: skip


def test_rows_read_back_as_they_were_written(tmp_path: Path) -> None:
    """Flags as flags: a place that is not near must not be taken for one that is, as any text would be."""
    placebo = ROW | {"group": "placebo", "truth": "", "named": "", "ratio": 0.0, "seed": None, "core": "00000012"}
    loop_rows.write_rows([ROW, placebo], tmp_path / "rows.csv")
    assert loop_rows.read_rows(tmp_path / "rows.csv") == [ROW, placebo]
    assert b"\r" not in (tmp_path / "rows.csv").read_bytes()
    text = (tmp_path / "rows.csv").read_text("utf-8").replace(",0.0,", ",much,")
    (tmp_path / "broken.csv").write_text(text, "utf-8")
    with pytest.raises(InputError, match=r"broken\.csv, line 3.*ratio is 'much'"):
        loop_rows.read_rows(tmp_path / "broken.csv")


def test_a_case_keeps_the_row_that_was_judged_blind() -> None:
    """Another seed's case is another case; a second verdict of the same one, or a short catalogue, adds nothing."""
    again, other, old = ROW | {"verdict": "unknown", "core": "x"}, ROW | {"seed": 6}, ROW | {"seed": None}
    assert loop_rows.merged([ROW, old], [again, other]) == [ROW, old, other]
    assert loop_rows.with_whole_catalogue([ROW, ROW | {"catalogue": 20}, ROW | {"catalogue": 63}]) == [
        ROW,
        ROW | {"catalogue": 63},
    ]


def test_a_report_adds_to_what_is_known_and_counts_the_version_of_most_campaigns_beside_all(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = {"held_before": 3.0, "held_after": 0.7, "nrmse_before": 97.0, "nrmse_after": 99.0}
    cases, page = tmp_path / "cases.csv", tmp_path / "closing-the-loop.md"
    loop_rows.write_rows([ROW | whole | {"core": "older", "answer": "wrong", "seed": None}], cases)
    page.write_text("<!-- results of the script: start -->\n<!-- results of the script: end -->\n", "utf-8")
    monkeypatch.setattr(study, "PAGES", tmp_path)
    monkeypatch.setattr(study, "BASELINES", tmp_path)
    monkeypatch.setattr(study, "picture", lambda counts: None)
    fresh = [
        ROW | whole,
        ROW | whole | {"seed": 8},
        ROW | whole | {"seed": 6, "catalogue": 20},
        ROW | {"seed": 7, "verdict": "not visible"},
    ]
    study.report(fresh, tmp_path, cases)
    assert [r["seed"] for r in loop_rows.read_rows(cases)] == [None, 5, 8]
    found = page.read_text("utf-8")
    assert "by one version, that of most campaigns (12345678)" in found
    assert "| wrong single name, above the limit | ≤ 2 % | 1 of 3, 33 % (6–79) | 0 of 2, 0 % (0–66) |" in found
    assert (tmp_path / "closing-the-loop-confusion.csv").read_text("utf-8").count("added-mass,added-mass") == 1


def test_the_last_version_has_a_column_of_its_own_unless_it_left_most_campaigns() -> None:
    first = ROW | {"core": "11111111"}
    last = ROW | {"core": "22222222", "answer": "wrong", "verdict": "explained", "named": "local-absorber"}
    said = loop_results.headline([first, first, last]).splitlines()
    assert "by one version, that of most campaigns (11111111) | by the last version (22222222)" in said[0]
    single = next(line for line in said if "wrong single name, above the limit" in line)
    assert [part.strip().split(",")[0] for part in single.split("|")[3:6]] == ["1 of 3", "0 of 2", "1 of 1"]
    assert "by the last version" not in loop_results.headline([last, first, first])
