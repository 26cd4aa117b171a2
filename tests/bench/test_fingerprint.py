"""Results are kept for the code that made them: an edited method is benched again."""

from __future__ import annotations

import importlib
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
from vgvt.identification import Needs, Requirement

@dataclass(frozen=True)
class Fixed:
    name: ClassVar[str] = "fixed"
    summary: ClassVar[str] = "always says the same"
    citation: ClassVar[str] = "@misc{none, title = {None}}"
    needs: ClassVar[Needs] = Needs.FRFS
    requires: ClassVar[tuple[Requirement, ...]] = REQUIRES

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

    # Of two versions of one length, written within a second, the compiled first would be taken for the second.
    monkeypatch.setattr(sys, "dont_write_bytecode", True)

    def write(frequency_hz: float, requires: str = "()") -> None:
        text = METHOD.replace("FREQUENCY", str(frequency_hz)).replace("REQUIRES", requires)
        (site / "fixed_method.py").write_text(text)
        fresh_process()

    yield write
    sources_hash.cache_clear()


def fresh_process() -> None:
    """Forget what this process has read of what is installed: a new bench is a new process."""
    sources_hash.cache_clear()
    sys.modules.pop("fixed_method", None)
    importlib.invalidate_caches()


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
    # Of another length: of a text as long, written within the same second, Python takes the old bytecode for its own.
    written(12.25)
    second = bench(plan, folder)
    assert cell.stat().st_mtime_ns != kept
    assert [t["claimed_hz"].dropna().tolist() for t in (first, second)] == [[6.0], [12.25]]


def test_the_fingerprint_knows_the_entries_sources_and_the_libraries(written, monkeypatch) -> None:
    written(6.0)
    fixed = fingerprint((Entry("fixed"),))
    assert fingerprint((Entry("quadrature"),)) != fixed
    monkeypatch.setattr(module, "_version", lambda name: f"another {name}")
    assert fingerprint((Entry("fixed"),)) != fixed


def test_a_package_that_is_not_there_has_no_sources() -> None:
    assert sources_hash("no_such_package_anywhere") == ""
    assert sources_hash("vgvt") != sources_hash("vgvt_scoreboard") != ""


REQUIRED = '(Requirement("beside.part", "somewhere[else]"),)'


@pytest.fixture
def beside(tmp_path):
    """Installs a library of a version, with a line of source."""

    def install(version: str, source: str) -> None:
        site = tmp_path / "site"
        info = site / "beside_library-1.dist-info"
        for folder in (site / "beside", info):
            folder.mkdir(exist_ok=True)
        (site / "beside" / "__init__.py").touch()
        (site / "beside" / "part.py").write_text(source)
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: beside-library\nVersion: {version}\n")
        (info / "top_level.txt").write_text("beside\n")
        fresh_process()

    yield install
    sys.modules.pop("beside", None)


def test_the_fingerprint_knows_what_an_entry_requires(written, beside) -> None:
    written(6.0, REQUIRED)
    seen = [fingerprint((Entry("fixed"),))]
    other = fingerprint((Entry("quadrature"),))
    for version, source in (("1", "a = 1"), ("2", "a = 1"), ("2", "a = 2")):
        beside(version, source)
        seen.append(fingerprint((Entry("fixed"),)))
    assert len(set(seen)) == 4
    assert fingerprint((Entry("fixed"),)) == seen[-1]
    assert fingerprint((Entry("quadrature"),)) == other


def test_what_lacked_a_library_is_benched_again_when_it_is_there(written, beside, light_scenario, tmp_path) -> None:
    plan = BenchPlan((light_scenario,), 1, (Entry("fixed"),), Limits())
    written(6.0, REQUIRED)
    first = bench(plan, tmp_path / "bench")
    assert "beside.part, which is not installed" in first["reason"].iloc[0]
    beside("1", "")
    assert bench(plan, tmp_path / "bench")["claimed_hz"].dropna().tolist() == [6.0]


def test_a_plugin_that_cannot_be_loaded_has_another_fingerprint_than_one_that_can(written, beside) -> None:
    """It imports a library before it could say that it requires one."""
    written(6.0, '__import__("beside") and ()')
    broken = fingerprint((Entry("fixed"),))
    beside("1", "")
    assert fingerprint((Entry("fixed"),)) != broken
