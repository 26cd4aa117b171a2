"""Results are kept for the code that made them: an edited method is benched again."""

from __future__ import annotations

import sys

import pytest

from vgvt.bench import fingerprint as module
from vgvt.bench.bench import BenchPlan, bench
from vgvt.bench.entry import Entry
from vgvt.bench.fingerprint import fingerprint, sources_hash
from vgvt.bench.umpire import Limits

METHOD = """
from dataclasses import dataclass
from typing import ClassVar
import numpy as np
from vgvt.data import ModalModel
from vgvt.identification import Needs

@dataclass(frozen=True)
class Fixed:
    name: ClassVar[str] = "fixed"
    summary: ClassVar[str] = "always says the same"
    citation: ClassVar[str] = "@misc{none, title = {None}}"
    needs: ClassVar[Needs] = Needs.FRFS

    def identify(self, campaign, band_hz):
        dofs = (campaign.runs[0].channels[-1].dof,)
        return ModalModel(np.array([FREQUENCY]), np.array([0.01]), np.ones((1, 1), complex), dofs)
"""


@pytest.fixture
def written(tmp_path, monkeypatch):
    """Writes the method as a distribution of its own, with a frequency; nothing of it stays in memory."""
    site = tmp_path / "site"
    info = site / "fixed-1.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: fixed\nVersion: 1\n")
    (info / "entry_points.txt").write_text("[vgvt.identifiers]\nfixed = fixed_method:Fixed\n")
    monkeypatch.syspath_prepend(str(site))

    def write(frequency_hz: float) -> None:
        (site / "fixed_method.py").write_text(METHOD.replace("FREQUENCY", str(frequency_hz)))
        sources_hash.cache_clear()  # a new bench is a new process
        sys.modules.pop("fixed_method", None)

    yield write
    sources_hash.cache_clear()


def test_an_edited_method_is_benched_again_and_an_untouched_one_is_not(written, light_scenario, tmp_path) -> None:
    plan = BenchPlan((light_scenario,), 1, (Entry("fixed"),), Limits())
    folder = tmp_path / "bench"
    written(6.0)
    first = bench(plan, folder)
    (cell,) = (folder / "cells").iterdir()
    kept = cell.stat().st_mtime_ns
    written(6.0)
    bench(plan, folder)
    assert cell.stat().st_mtime_ns == kept
    written(7.0)
    second = bench(plan, folder)
    assert cell.stat().st_mtime_ns != kept
    assert [t["claimed_hz"].dropna().tolist() for t in (first, second)] == [[6.0], [7.0]]


def test_the_fingerprint_knows_the_entries_sources_and_the_libraries(written, monkeypatch) -> None:
    written(6.0)
    fixed = fingerprint((Entry("fixed"),))
    assert fingerprint((Entry("quadrature"),)) != fixed
    monkeypatch.setattr(module, "_version", lambda name: f"another {name}")
    assert fingerprint((Entry("fixed"),)) != fixed


def test_a_package_that_is_not_there_has_no_sources() -> None:
    assert sources_hash("no_such_package_anywhere") == ""
    assert sources_hash("vgvt") != sources_hash("vgvt_scoreboard") != ""
