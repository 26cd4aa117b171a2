"""``vgvt reconcile --power`` before the test refuses what it refuses with a campaign, in the same words."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from vgvt.cli.reconcile_power import tell_of_cut
from vgvt.data import InputError
from vgvt.reconcile.next_test.before_test import expected_fit
from vgvt.reconcile.question.suitable import check_suitable
from vgvt.scenario import load_scenario


@pytest.mark.parametrize(
    ("band", "words"),
    [
        ((200, 300), "--band: 200 to 300 Hz lies outside the 3 to 35 Hz that quick excites"),
        ((20, 3), "--band: 20 3 is not a band"),
    ],
)
def test_a_band_that_is_not_excited_is_refused(vgvt, band: tuple[int, int], words: str) -> None:
    result = vgvt("reconcile", "--power", "--scenario", "quick", "--band", *band)
    assert result.status == 2
    assert words in result.err
    assert "Warning" not in result.err
    with pytest.raises(InputError, match="--band"):
        expected_fit(load_scenario("quick"), band_hz=band)


@pytest.mark.parametrize("name", ["teaching-beam-hammer", "hati-two-shakers"])
def test_a_hammer_and_several_shakers_are_refused_as_with_a_campaign(vgvt, name: str, plate_campaign: Any) -> None:
    with pytest.raises(InputError, match="one shaker") as with_a_campaign:
        check_suitable(plate_campaign, load_scenario(name))
    result = vgvt("reconcile", "--power", "--scenario", name)
    assert result.status == 2
    assert with_a_campaign.value.problem in result.err
    with pytest.raises(InputError, match="one shaker"):
        expected_fit(load_scenario(name))


def test_a_band_that_is_cut_is_told_in_one_line(
    vgvt, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import vgvt.reconcile.next_test.before_test as before

    def stopped(*_: object, **__: object) -> None:
        raise InputError("stopped", "here")

    monkeypatch.setattr(before, "expected_fit", stopped)
    told = "--band 20 50 is cut to 20 to 35 Hz: quick excites no more"
    assert vgvt("reconcile", "--power", "--scenario", "quick", "--band", 20, 50).err.splitlines()[0] == told
    assert "is cut" not in vgvt("reconcile", "--power", "--scenario", "quick", "--band", 5, 20).err
    tell_of_cut(None, (3.0, 35.0), "quick")
    assert capsys.readouterr().err == ""


@pytest.fixture
def looked(monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """Ends every study where it would begin to compute; the list grows by one each time."""
    import vgvt.reconcile.next_test.before_test as before

    begun: list[bool] = []

    def stopped(*_: object, **__: object) -> None:
        begun.append(True)
        raise KeyboardInterrupt

    monkeypatch.setattr(before, "expected_fit", stopped)
    return begun


@pytest.mark.parametrize(
    ("out", "words"), [("a-file", "this is a file"), ("a-file/in", "cannot be made"), ("mine", "holds other files")]
)
def test_a_place_that_cannot_hold_the_answer_is_told_before_the_work(
    vgvt, looked: list[bool], out: str, words: str
) -> None:
    """A study of ten minutes had ended with nothing but that."""
    Path("a-file").write_text("a file")
    Path("mine").mkdir()
    Path("mine/thesis.tex").write_text("years of work")
    result = vgvt("reconcile", "--power", "--scenario", "quick", "--out", out)
    assert (result.status, looked) == (2, [])
    assert words in result.err
    assert {path.name for path in Path().iterdir()} == {"a-file", "mine"}


@pytest.mark.parametrize("option", [("--workers", 2), ("--leave-out-faulty",), ("--force",)], ids=lambda o: o[0])
def test_an_option_that_needs_a_campaign_is_refused(vgvt, looked: list[bool], option: tuple[Any, ...]) -> None:
    """It had changed nothing, and nobody was told."""
    result = vgvt("reconcile", "--power", "--scenario", "quick", "--out", "seen", *option)
    assert (result.status, looked) == (2, [])
    assert result.err.startswith(f"vgvt: {option[0]}: ")
    assert "leave it out, or name what was measured: vgvt reconcile CAMPAIGN" in result.err
    assert not Path("seen").exists()


def test_an_interrupted_study_leaves_no_empty_folder(vgvt, looked: list[bool]) -> None:
    assert vgvt("reconcile", "--power", "--scenario", "quick", "--out", "new/seen").status == 130
    assert looked == [True]
    assert not Path("new").exists()
