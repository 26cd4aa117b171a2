"""What a study keeps is whole; what was cut off is told by its path before any work, or done again."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NoReturn

import closing_the_loop
import cramer_rao
import hati_identified
import hati_reconciled
import loop_rows
import next_test
import one_level_or_two
import pytest
import virtual_lab
from kept_documents import keep, read_kept

from vgvt.data import InputError

WHOLE = json.dumps({"made_by": "x", "rows": [{"verdict": "adequate"}]})


def never(*_: Any, **__: Any) -> NoReturn:
    pytest.fail("work was begun")


def cut(file: Path, text: str = WHOLE) -> Path:
    """A file of which the second half is lost."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text[: len(text) // 2], encoding="utf-8")
    return file


@pytest.mark.parametrize("text", ['{"rows": [1,', "", "\0\0\0"])
def test_a_cut_file_is_told_by_its_path(tmp_path: Path, text: str) -> None:
    (tmp_path / "case.json").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"case\.json: is cut off, or not what .*\n  remove it$"):
        read_kept(tmp_path / "case.json", "remove it")


def test_what_cannot_be_kept_leaves_what_was(tmp_path: Path) -> None:
    keep(tmp_path / "case.json", {"a": 1})
    with pytest.raises(TypeError):
        keep(tmp_path / "case.json", {"a": 2, "b": object()})
    assert read_kept(tmp_path / "case.json", "") == {"a": 1}
    assert [p.name for p in tmp_path.iterdir()] == ["case.json"]


@pytest.mark.parametrize("text", [WHOLE[:20], "[]", '{"rows": 3}', "{}"])
def test_rows_of_a_case_that_is_no_case(tmp_path: Path, text: str) -> None:
    (tmp_path / "cells").mkdir()
    (tmp_path / "cells" / "a.json").write_text(WHOLE, encoding="utf-8")
    (tmp_path / "cells" / "b.json").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"b\.json: is cut off.*\n  remove it: the case is done again"):
        loop_rows.kept(tmp_path)
    assert loop_rows.kept(tmp_path, {"b"}) == [{"verdict": "adequate"}]


def test_a_study_tells_a_cut_case_of_another_plan_before_it_works_and_does_its_own_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    own = closing_the_loop.small_plan()[0]
    cut(tmp_path / "cells" / f"{own.key}.json")
    asked: list[Any] = []
    monkeypatch.setattr(closing_the_loop, "run", lambda every, *_: asked.extend(every))
    assert closing_the_loop.main([str(tmp_path), "--small"]) == 0
    assert own in asked
    other = cut(tmp_path / "cells" / "other.json")
    monkeypatch.setattr(closing_the_loop, "run", never)
    assert closing_the_loop.main([str(tmp_path), "--small"]) == 2
    assert f"{other}: is cut off" in capsys.readouterr().err


def test_a_cut_case_of_levels_is_done_again_and_not_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    row = {"truth": "run-drift", "levels": 2, "verdict": "explained", "named": "run-drift"}
    half = cut(tmp_path / "run-drift-2.json", json.dumps(row))
    assert one_level_or_two.main([str(tmp_path), "--report"]) == 2
    assert f"{half}: is cut off" in capsys.readouterr().err
    asked = []
    monkeypatch.setattr(one_level_or_two, "row_of", lambda truth, levels: asked.append(levels) or row)
    for _ in range(2):
        assert one_level_or_two.main([str(tmp_path), "--only", "run-drift"]) == 0
    assert asked == [2, 1]
    assert json.loads(half.read_text("utf-8")) == row


@pytest.mark.parametrize(
    ("script", "file", "words"),
    [
        (hati_reconciled, "shuffled.json", ["null", "shuffled"]),
        (hati_identified, "auto-run-7.json", ["auto"]),
        (hati_identified, "auto-all.json", []),
    ],
    ids=["stage", "one run", "all runs"],
)
def test_the_measured_campaigns_studies_tell_a_cut_file_before_they_work(
    script: Any,
    file: str,
    words: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(script, "FOLDER", tmp_path)
    monkeypatch.setattr(script, "open_campaign", never)
    half = cut(tmp_path / file)
    assert script.main(words) == 2
    said = capsys.readouterr().err
    assert f"{half}: is cut off" in said and "remove it" in said


def test_records_that_are_not_there_are_told_before_anything_is_done_away_with(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(name: str) -> NoReturn:
        raise InputError(name, "is not on this machine")

    monkeypatch.setattr(hati_identified, "FOLDER", tmp_path)
    monkeypatch.setattr(hati_identified, "open_campaign", missing)
    (tmp_path / "auto-all.json").touch()
    assert hati_identified.main(["auto", "--again"]) == 2
    assert (tmp_path / "auto-all.json").exists()


def test_a_table_that_was_cut_anywhere_goes_on_to_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whole seeds are not asked again; what half a line says is never believed."""
    asked: list[int] = []

    def identified(method: str, seed: int) -> list[tuple[str, ...]]:
        asked.append(seed)
        return [(method, str(seed), str(k), *(f"{seed + k / 7}" for _ in range(4)), "12") for k in range(4)]

    monkeypatch.setattr(cramer_rao, "identified", identified)
    kept = tmp_path / "kept.csv"
    whole = cramer_rao.collected(["auto"], range(3), kept)["auto"]
    data, first = kept.read_bytes(), len(kept.read_bytes()) // 3
    for length in (*range(0, len(data), 11), *range(len(data) - 9, len(data) + 1)):
        kept.write_bytes(data[:length])
        asked.clear()
        found = cramer_rao.collected(["auto"], range(3), kept)["auto"]
        for name in ("frequency_hz", "damping_ratio_std", "false"):
            assert (getattr(found, name) == getattr(whole, name)).all(), length
        assert len(asked) <= 2 or length < first + len(",".join(cramer_rao.HEAD))
        again = cramer_rao.collected(["auto"], range(0), kept)["auto"]
        assert (again.false == whole.false).all(), length
    kept.write_text("a,b\n1,2\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"kept\.csv: is cut off, or not what the study keeps"):
        cramer_rao.collected(["auto"], range(0), kept)


def test_a_report_of_nothing_leaves_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for script in (next_test, closing_the_loop):
        monkeypatch.setattr(script, "write_results", never)
    assert next_test.main([str(tmp_path), "--report"]) == 2
    assert closing_the_loop.main([str(tmp_path), "--report", "--alone"]) == 2
    monkeypatch.setattr(cramer_rao, "write_results", never)
    monkeypatch.setattr(cramer_rao, "KEPT", tmp_path / "none.csv")
    assert cramer_rao.main(["--page"]) == 2
    assert capsys.readouterr().err.count("run") >= 3


def test_a_page_is_replaced_whole_or_stays(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(f"before\n{virtual_lab.START}\nold\n{virtual_lab.END}\nafter\n", encoding="utf-8")
    page.with_name("link.md").hardlink_to(page)
    virtual_lab.write_results(page, "new")
    assert page.read_text("utf-8") == f"before\n{virtual_lab.START}\n\nnew\n\n{virtual_lab.END}\nafter\n"
    # What stood there was not written into: a reader, or a power cut, has the old page or the new one.
    assert "old" in page.with_name("link.md").read_text("utf-8")
    page.write_text(f"{virtual_lab.START} only", encoding="utf-8")
    with pytest.raises(InputError, match=r"page\.md: has no one place for the results"):
        virtual_lab.write_results(page, "new")
    assert page.read_text("utf-8") == f"{virtual_lab.START} only"
