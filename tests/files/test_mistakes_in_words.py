"""A mistake in a sidecar: what was given, what may be, and the key that is wrong."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from vgvt.data import InputError
from vgvt.files import open_campaign

Edit = Callable[[str, str], Path]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('role = "reference"', 'role = "referenz"', ('"referenz"', "'response', 'reference' or 'drive'")),
        ('format = "mat"', 'format = "wav"', ('"wav"', "'mat', 'npz', 'csv', 'uff' or 'tdms'")),
        ('name = "bench-beam"', "name = 5", ("name: 5 was given", "text in quotes", 'name = "..."')),
        ("sample_rate_hz = 100.0", "sample_rate_hz = -100.0", ("-100.0 was given", "more than 0")),
        ("sample_rate_hz = 100.0", 'sample_rate_hz = "fast"', ('"fast" was given', "a number", "without quotes")),
        ("column = 1", "column = 0", ("0 was given", "at least 1", "counted from 1")),
        ('aft = "y"', 'aft = "q"', ('"q"', "like 'y' or '-x'")),
        ("band_hz = [2.0, 40.0]", "band_hz = [2.0]", ("band_hz: [2.0] was given", "more entries", "band_hz = [")),
        ("band_hz = [2.0, 40.0]", "band_hz = 2.0", ("2.0 was given", "a list", "in brackets")),
        (
            "acc1 = 1,",
            "acc1 = 1.5,",
            ("run[0].nodes.acc1: 1.5 was given", "acc1 = 2", "counted from 0, run[0] is the first"),
        ),
        ("[nodes]", "[[nodes]]", ("nodes: [", "must be a table")),
    ],
)
def test_the_value_given_and_what_to_write(edited: Edit, old: str, new: str, words: tuple[str, ...]) -> None:
    with pytest.raises(InputError) as caught:
        open_campaign(edited(old, new))
    said = str(caught.value)
    for part in words:
        assert part in said
    assert "Input should" not in said
    assert "also" not in said, "one mistake is told once"
    assert caught.value.advice


def test_a_column_beyond_the_file_is_called_a_column(edited: Edit) -> None:
    """Three channels are there and three are spoken of: it is the channel's own column that is wrong."""
    with pytest.raises(InputError, match=r"3 channels, but channel 'acc2' is said to be column 4(.|\n)*1 to 3"):
        open_campaign(edited('name = "acc2"\ncolumn = 3', 'name = "acc2"\ncolumn = 4'))


@pytest.mark.parametrize("text", ['name = "mine"\nextends = "quick"\n', 'name = "mine"\n[airframe]\nname = "x"\n'])
def test_a_scenario_given_as_records_is_called_one(tmp_path: Path, text: str) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match="this is a scenario") as caught:
        open_campaign(path)
    assert f"vgvt run {path}" in caught.value.advice


def test_a_sidecar_with_a_foreign_key_stays_a_sidecar(edited: Edit) -> None:
    with pytest.raises(InputError, match="shaker: unknown key"):
        open_campaign(edited("[nodes]", "[shaker]\nx = 1\n\n[nodes]"))


def test_a_sidecar_that_is_cut_off_is_told_with_the_line_where_it_ends(edited: Edit) -> None:
    path = edited('quantity = "force"', 'quantity = "force"')
    whole = path.read_text(encoding="utf-8")
    path.write_text(whole[: whole.index('orce"')], encoding="utf-8")
    line = whole[: whole.index('orce"')].count("\n") + 1
    with pytest.raises(InputError, match="not TOML: unterminated string") as caught:
        open_campaign(path)
    assert caught.value.where == f"{path}, line {line}, column 10"
    assert "quotation mark" in caught.value.advice
    assert caught.value.advice.endswith('The line reads: name = "f')


def test_what_is_not_utf_8_is_told_with_its_line(edited: Edit) -> None:
    path = edited('name = "acc1"', 'name = "acc1"')
    path.write_bytes(path.read_bytes().replace(b"acc1", b"\xf6", 1))
    line = path.read_bytes().partition(b"\xf6")[0].count(b"\n") + 1
    with pytest.raises(InputError, match="byte 0xf6 is not UTF-8 text") as caught:
        open_campaign(path)
    assert caught.value.where == f"{path}, line {line}"


def test_a_byte_order_mark_does_no_harm(edited: Edit) -> None:
    path = edited('name = "bench-beam"', 'name = "marked"')
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert open_campaign(path).name == "marked"


def test_a_scenario_with_a_byte_order_mark_is_called_one_too(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_bytes(b'\xef\xbb\xbfname = "mine"\nextends = "quick"\n')
    with pytest.raises(InputError, match="this is a scenario"):
        open_campaign(path)
