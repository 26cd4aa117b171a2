"""Mode by mode on the page: what was measured first, and each model's distance from it beside its own figure."""

from __future__ import annotations

import re
from dataclasses import replace

from account_by_hand import account

from vgvt.view.reconcile_modes import modes_section


def cells(section: str) -> list[list[str]]:
    """Rows of the table as a reader has them."""
    rows = re.findall(r"<tr>(.*?)</tr>", section, re.S)
    return [[re.sub("<[^>]+>", "", c) for c in re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row, re.S)] for row in rows]


def test_both_models_stand_beside_what_was_measured() -> None:
    heads, first, second = cells(modes_section(account()))
    assert heads[:4] == ["measured, Hz", "measured ζ, %", "before, Hz", "after, Hz"]
    assert first == [
        "15.020 ± 0.004", "2.10 ± 0.03", "16.500 (+9.85)", "15.000 (-0.13)", "2.00 (-4.8)", "2.00",
        "0.912 → 0.998", "40.0 → 0.5", "41.0 → 0.6",
    ]  # fmt: skip
    # A mode that the records do not show, and only one model has.
    assert second == ["", "", "22.250", "", "1.00", "", "", "3.0 → 3.1", ""]


def test_one_model_has_one_column_of_each() -> None:
    told = account("adequate", named=False)
    heads, first, _ = cells(modes_section(told))
    assert len(heads) == len(first) == 7
    assert first == ["15.020 ± 0.004", "2.10 ± 0.03", "16.500 (+9.85)", "2.00 (-4.8)", "0.912", "40.0", "41.0"]


def test_an_error_that_rounds_to_nothing_has_no_sign() -> None:
    told = account()
    seen = told.modes[0].seen
    assert seen is not None
    mode = replace(told.modes[0], seen=replace(seen, frequency_error_percent=(-0.004, 0.004)))
    _, row = cells(modes_section(replace(told, modes=(mode,))))
    assert row[2:4] == ["16.500 (0.00)", "15.000 (0.00)"]


def test_without_modes_there_is_no_section() -> None:
    assert modes_section(replace(account(), modes=())) == ""
