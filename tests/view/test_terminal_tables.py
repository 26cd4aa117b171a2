"""Tables for the terminal say what the scorecard says."""

from __future__ import annotations

from dataclasses import replace

import pytest
from rich.console import Console

from vgvt.data import ModalModel, Outcome
from vgvt.data.mode_numbers import number_text
from vgvt.view import modal_table, scorecard_table
from vgvt.view.wording import remark_in_words


def text_of(table: object) -> str:
    console = Console(width=140, no_color=True, record=True, file=None, quiet=False, force_terminal=False)
    with console.capture() as capture:
        console.print(table)
    return capture.get()


def test_scorecard_rows_and_counts(example) -> None:
    text = text_of(scorecard_table(example.scorecards["quadrature"]))
    assert "4 found, 1 missed, 1 false" in text
    missed = next(line for line in text.splitlines() if "missed" in line and "13.850" in line)
    assert "antisymmetric torsion" in missed
    assert "±" not in text


def test_columns_appear_when_something_is_stated(example) -> None:
    assert "0.030" in text_of(scorecard_table(example.scorecards["plscf"]))


def test_a_table_fits_a_terminal_of_100_columns(example) -> None:
    console = Console(width=100, no_color=True)
    with console.capture() as capture:
        console.print(scorecard_table(example.scorecards["plscf"]))
    lines = capture.get().splitlines()
    assert max(map(len, lines)) <= 100
    assert any("13.889" in line and "found" in line for line in lines)


def test_modes_of_a_model(example) -> None:
    text = text_of(modal_table(example.claims["plscf"], "plscf"))
    for hertz in example.claims["plscf"].natural_frequency_hz:
        assert f"{hertz:.3f}" in text


def test_an_empty_model_says_why() -> None:
    text = text_of(modal_table(ModalModel.empty(Outcome.NOT_CONVERGED, ("try a narrower band",), method="ssi")))
    assert "not converged" in text
    # The command says the advice, once, on stderr; a table without rows would be empty rules.
    assert "try a narrower band" not in text
    assert "frequency" not in text


@pytest.mark.parametrize("evil", ["[red]x[/red]", "[/]"])
def test_markup_in_names_is_shown_as_it_is(example, evil: str) -> None:
    card = replace(example.scorecards["plscf"], identifier=evil)
    assert evil in text_of(scorecard_table(card))


@pytest.mark.parametrize("width", [60, 80])
def test_a_narrow_terminal_cuts_no_name_status_mac_or_error(example, width: int) -> None:
    card = example.scorecards["plscf"]
    console = Console(width=width, no_color=True)
    with console.capture() as capture:
        console.print(scorecard_table(card))
    text = capture.get()
    assert max(map(len, text.splitlines())) <= width
    assert "…" not in text
    assert "true ζ" not in text
    for row in card.modes:
        assert row.status.value in text
        assert all(word in text for word in row.label.split())
        if row.mac is not None and row.frequency_error_percent is not None:
            assert f"{row.mac:.3f}" in text
            assert f"{row.frequency_error_percent:+.2f}".lstrip("+-") in text


def test_zero_has_no_sign_and_flags_are_words() -> None:
    assert number_text(-0.001, "{:+.2f}") == "0.00"
    assert number_text(-0.01, "{:+.2f}") == "-0.01"
    assert number_text(float("nan"), "{:.2f}") == ""
    flags = "sigma_peak_hz=7.800; prominence_db=28.4; runs_disagree; seen at 7.8 Hz, twice"
    assert remark_in_words(flags) == "sigma peak 7.800 Hz; prominence 28.4 dB; runs disagree; seen at 7.8 Hz, twice"
