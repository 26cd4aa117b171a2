"""The chart of what was calibrated says no more than the sentence above it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

from vgvt.view.reconcile_account import Account, PosteriorRow
from vgvt.view.reconcile_figures import posterior_figure
from vgvt.view.reconcile_sections import posterior_table

CELLS = PosteriorRow("cells", "refinement of the beams' cells", -4.5, 0.2, "-0.98", tolerance=False)
WING = PosteriorRow("EI wing", "EI of the wing", -1.2, 0.3, "× 0.9 ± 0.02")


def calibrated(*rows: PosteriorRow) -> Account:
    return cast(Account, SimpleNamespace(posterior=rows))


def test_what_has_no_stated_tolerance_is_in_the_table_alone() -> None:
    figure: Any = posterior_figure(calibrated(CELLS, WING))
    for drawn in figure.data:
        assert list(drawn.y) == ["EI of the wing"]
        assert max(abs(x) for x in drawn.x) < 3
    text = posterior_table(calibrated(CELLS, WING))
    assert "No calibrated quantity is further than three" in text
    assert "no tolerance stated" in text and "-4.50" not in text
    assert posterior_figure(calibrated(CELLS)) is None
