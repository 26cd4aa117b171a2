"""Limits from a file: the stored ones are whole, and what is wrong with somebody's own is told by its key."""

from __future__ import annotations

from pathlib import Path

import pytest

from vgvt.data import InputError
from vgvt.reconcile.placebo import write_thresholds
from vgvt.reconcile.question.thresholds import LIMITS, Thresholds, stored_thresholds, thresholds_of


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "thresholds.toml"
    write_thresholds(path, stored_thresholds())
    return path


def test_what_is_written_is_read(file: Path) -> None:
    read = thresholds_of(file)
    for name in LIMITS:
        assert getattr(read, name) == pytest.approx(getattr(stored_thresholds(), name), rel=1e-3)
    assert read.provenance == stored_thresholds().provenance


def test_the_limits_are_all_numbers_but_what_they_refer_to_and_the_set() -> None:
    assert {*LIMITS, "set_nats", "model_form", "provenance"} == set(Thresholds.__dataclass_fields__)


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("evidence_nats = ", "evidence_nat = ", "evidence_nats: is missing"),
        ("provenance = ", "extra = 1\nprovenance = ", "extra: is no limit"),
        ("strain_sd = ", "strain_dd = ", r"strain_dd: is no limit\n .*strain_sd"),
        ("evidence_nats = ", "evidence_nats = -", r"evidence_nats: is -8\.\d+, and a limit is a number"),
        ("evidence_nats = ", "evidence_nats = nan #", "evidence_nats: is nan"),
        ("evidence_nats = ", "evidence_nats = inf #", "evidence_nats: is inf"),
        ("evidence_nats = ", "evidence_nats = true #", "evidence_nats: is True"),
        ("evidence_nats = ", 'evidence_nats = "9" #', "evidence_nats: is '9'"),
        ("provenance = ", "provenance = 3 #", "provenance: is 3"),
        ("model_form = ", "model_form = 0 #", "model_form: is 0"),
        ("evidence_nats = ", "evidence_nats ", "line 4, column 15: not TOML"),
    ],
)
def test_what_is_wrong_is_told_with_its_key(file: Path, before: str, after: str, words: str) -> None:
    text = file.read_text(encoding="utf-8")
    assert before in text
    file.write_text(text.replace(before, after), encoding="utf-8")
    with pytest.raises(InputError, match=words) as told:
        thresholds_of(file)
    assert str(file) in told.value.where
    assert told.value.advice


def test_a_file_that_is_not_there_or_is_cut_off_is_told(tmp_path: Path, file: Path) -> None:
    with pytest.raises(InputError, match="cannot be read: No such file"):
        thresholds_of(tmp_path / "nowhere.toml")
    with pytest.raises(InputError, match="cannot be read: Is a directory"):
        thresholds_of(tmp_path)
    whole = file.read_bytes()
    for length in range(0, len(whole), 7):
        file.write_bytes(whole[:length])
        with pytest.raises(InputError):
            thresholds_of(file)
