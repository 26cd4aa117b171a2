"""The committed baselines: what the methods can do today is no worse, and a method made worse is caught."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

import vgvt_identifiers
from vgvt.bench.guard import read_baseline
from vgvt.cli.boundary import run_command
from vgvt.identification import available_identifiers
from vgvt.scenario.library import bundled_scenarios

BASELINES = Path(__file__).parents[2] / "scoreboard" / "baselines"
NAMES = [path.stem for path in sorted(BASELINES.glob("*.csv")) if path.stem in bundled_scenarios()]

_WORSE = """

from dataclasses import replace as _replace

_as_it_was = Quadrature.identify


def _worse(self, campaign, band_hz):
    claim = _as_it_was(self, campaign, band_hz)
    return _replace(claim, natural_frequency_hz=claim.natural_frequency_hz * 1.0003)


Quadrature.identify = _worse
"""


def against(name: str, out: Path, *more: str) -> int:
    arguments = ["bench", name, "--against", str(BASELINES / f"{name}.csv"), "--out", str(out), "--no-page", "--json"]
    return run_command([*arguments, "--time-limit", "600", *more])


def test_there_are_some() -> None:
    assert "quick" in NAMES
    assert len(NAMES) >= 3


@pytest.mark.parametrize("name", NAMES)
def test_a_baseline_knows_every_bundled_method_on_five_campaigns_at_least(name: str) -> None:
    baseline = read_baseline(BASELINES / f"{name}.csv")
    modules = {name: cls.__module__ for name, cls in available_identifiers().items()}
    bundled = {k for k, m in modules.items() if m.startswith("vgvt_identifiers.") and ".peers." not in m}
    assert set(baseline["scenario"]) == {name}
    assert bundled <= set(baseline["entry"])
    assert (baseline.groupby("entry")["seed"].nunique() >= 5).all()


def test_today_is_no_worse_than_the_baseline(tmp_path, capsys) -> None:
    assert against("quick", tmp_path, "--identifier", "quadrature", "--seeds", "5", "--workers", "0") == 0
    compared = json.loads(capsys.readouterr().out)["against"]
    assert {row["pairs"] for row in compared} == {5}
    assert {row["verdict"] for row in compared} == {"same"}


@pytest.mark.slow
def test_every_method_is_no_worse_than_the_baseline(tmp_path, capsys) -> None:
    assert against("quick", tmp_path, "--seeds", "10") == 0
    compared = json.loads(capsys.readouterr().out)["against"]
    assert len({row["entry"] for row in compared}) >= 12


@pytest.mark.slow
def test_a_method_made_worse_is_caught_against_the_committed_baseline(tmp_path, capsys, monkeypatch) -> None:
    """A bias of 0.03 % in the frequency, far less than anybody would see by eye."""
    site = tmp_path / "site"
    shutil.copytree(Path(vgvt_identifiers.__file__).parent, site / "vgvt_identifiers")
    with (site / "vgvt_identifiers" / "quadrature.py").open("a", encoding="utf-8") as file:
        file.write(_WORSE)
    monkeypatch.syspath_prepend(str(site))  # contestants find this one first
    code = against("quick", tmp_path / "out", "--identifier", "quadrature", "--seeds", "5", "--workers", "0")
    worse = [row for row in json.loads(capsys.readouterr().out)["against"] if row["verdict"] == "worse"]
    assert code == 1
    assert [row["measure"] for row in worse] == ["frequency_error_percent"]
    assert worse[0]["entry"] == "quadrature"
