"""The folder of ``vgvt reconcile``: one process at a time, nothing that is not ours, answers where they now lie."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from coarse_beam import BEAM, written

from vgvt.cli import folder_lock
from vgvt.cli.reconcile_folder import ReconcileFolder
from vgvt.data import InputError
from vgvt.scenario import load_scenario
from vgvt.scenario.points import sensor_points

HOLD = """
import sys
from pathlib import Path
from vgvt.cli.folder_lock import alone_in
folder = Path(sys.argv[1])
with alone_in(folder, folder / "cache" / "lock", "vgvt reconcile"):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def question(vgvt, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Any, ...]:
    """A command line whose answer is computed at once, by hand; the scenario that is found counts how often."""
    import vgvt.cli.reconcile
    import vgvt.reconcile.loop
    import vgvt.reconcile.outcome.account
    import vgvt.view.reconcile_page
    from vgvt.simulation import simulated_campaign

    beam = tmp_path / "beam.toml"
    beam.write_text(BEAM, encoding="utf-8")
    done: list[int] = []

    def close(campaign: Any, scenario: Any, *, folder: Path, **options: Any) -> SimpleNamespace:
        done.append(1)
        (folder / "reconciled.toml").write_text(f"# found {len(done)}\n", encoding="utf-8")
        about = SimpleNamespace(
            scenario=scenario,
            measured=SimpleNamespace(runs=scenario.acquisition.run_nodes, run_numbers=()),
            layouts=SimpleNamespace(first=SimpleNamespace(grid=sensor_points(scenario))),
        )
        found = SimpleNamespace(null=SimpleNamespace(problem=about))
        return SimpleNamespace(kind="unknown", attribution=found, document=lambda: {"verdict": "unknown"})

    def page(path: Path, account: object) -> Path:
        path.write_text("page", encoding="utf-8")
        return path

    monkeypatch.setattr(vgvt.reconcile.loop, "reconcile", close)
    monkeypatch.setattr(vgvt.reconcile.outcome.account, "account_of", lambda *_, **__: None)
    monkeypatch.setattr(vgvt.view.reconcile_page, "write_reconcile_page", page)
    monkeypatch.setattr("vgvt.view.reconcile_document.account_document", lambda account: {})
    for name in ("disproofs", "next_steps", "verdict_sentence", "warnings_of"):
        monkeypatch.setattr(f"vgvt.view.reconcile_wording.{name}", lambda account: ())
    campaign = written(tmp_path, simulated_campaign(load_scenario(str(beam)), engine="linear"))
    return ("reconcile", campaign, "--scenario", beam, "--json", "--out")


def test_another_process_in_the_folder_is_refused_and_a_dead_one_forgotten(vgvt, tmp_path: Path, question) -> None:
    """Two at once took each other's files away: one crashed, and the verdict of the other was gone."""
    first = vgvt(*question, "found").document
    other = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path / "found")],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert other.stdin is not None and other.stdout is not None
    with other:
        assert other.stdout.readline() == "held\n"
        (tmp_path / "found" / ".verdict.json.0123abcd.part").write_text("{", encoding="utf-8")
        refused = vgvt(*question, "found", "--force")
        assert refused.status == 2
        assert "another vgvt reconcile works in this folder" in refused.document["error"]["message"]
        assert "--out" in refused.document["error"]["advice"]
        assert json.loads((tmp_path / "found" / "verdict.json").read_text(encoding="utf-8")) == first
        assert (tmp_path / "found" / ".verdict.json.0123abcd.part").exists()
        other.kill()
    assert vgvt(*question, "found").document == first
    assert not (tmp_path / "found" / ".verdict.json.0123abcd.part").exists()


def test_a_verdict_stays_where_what_should_follow_it_has_gone(tmp_path: Path) -> None:
    folder = ReconcileFolder(tmp_path)
    folder.cache.mkdir()
    folder.verdict.write_text("{}", encoding="utf-8")
    with pytest.raises(InputError, match="has gone"):
        folder.publish({})
    assert folder.verdict.exists()


@pytest.mark.parametrize("name", ["precious.part", ".thesis.tex.0123abcd.part", ".verdict.json.part", "dir.part"])
def test_what_is_not_ours_is_left_alone_whatever_it_ends_in(vgvt, tmp_path: Path, question, name: str) -> None:
    mine = tmp_path / "found" / name
    mine.parent.mkdir()
    if name.startswith("dir"):
        mine.mkdir()
    else:
        mine.write_text("years of work", encoding="utf-8")
    result = vgvt(*question, "found")
    assert result.status == 2
    assert name in result.document["error"]["message"]
    assert [p.name for p in (tmp_path / "found").iterdir()] == [name]


def test_what_a_killed_call_left_half_written_goes(vgvt, tmp_path: Path, question) -> None:
    (tmp_path / "found").mkdir()
    for name in ("verdict.json", "power.html"):
        (tmp_path / "found" / f".{name}.0123abcd.part").write_text("{", encoding="utf-8")
    assert vgvt(*question, "found").status == 0
    assert not list((tmp_path / "found").glob(".*.part"))


def test_a_folder_that_was_moved_tells_where_it_is_now(vgvt, tmp_path: Path, question, monkeypatch) -> None:
    assert vgvt(*question, "found").document["report"] == "found/report.html"
    shutil.move(tmp_path / "found", tmp_path / "kept")
    moved = vgvt(*question, "kept").document
    assert [moved[k] for k in ("folder", "report", "reconciled")] == [
        "kept",
        "kept/report.html",
        "kept/reconciled.toml",
    ]
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert vgvt(*question, "../kept").document["report"] == "../kept/report.html"


def test_an_edited_scenario_is_told_and_never_lost(vgvt, tmp_path: Path, question) -> None:
    scenario = tmp_path / "found" / "reconciled.toml"
    first = vgvt(*question, "found")
    assert first.document["reconciled_edited"] is False
    assert "edited" not in vgvt(*question, "found").err
    for k, name in enumerate(("reconciled-edited.toml", "reconciled-edited-2.toml"), start=2):
        scenario.write_text(f"mass_kg = {k}\n", encoding="utf-8")
        again = vgvt(*question, "found")
        assert again.document["reconciled_edited"] is True
        assert "reconciled.toml was edited since" in again.err
        forced = vgvt(*question, "found", "--force")
        assert name in forced.err
        assert scenario.read_text(encoding="utf-8") == f"# found {k}\n"
        assert (scenario.parent / name).read_text(encoding="utf-8") == f"mass_kg = {k}\n"
    assert vgvt(*question, "found").document["reconciled_edited"] is False


@pytest.mark.parametrize("out", ["new/found", "mine"])
def test_a_command_that_is_refused_makes_nothing(vgvt, tmp_path: Path, question, monkeypatch, out: str) -> None:
    """Not even a lock; a folder that was there stays, and what an answer has beside it."""
    from vgvt.reconcile import loop

    assert vgvt(*question, "found").status == 0
    (tmp_path / "mine").mkdir()
    before = sorted(tmp_path.rglob("*"))

    def refused(*_: object, **__: object) -> None:
        raise InputError("campaign", "has too few lines", "widen --band")

    monkeypatch.setattr(loop, "reconcile", refused)
    assert vgvt(*question, out).status == 2
    assert vgvt(*question, "found", "--force").status == 2
    assert sorted(tmp_path.rglob("*")) == before


def test_a_lock_that_was_removed_meanwhile_is_made_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By a call that failed between this one's opening and locking it: a third would not have met this one's."""
    lock = tmp_path / "cache" / "lock"
    ask = folder_lock._taken
    removed: list[int] = []

    def late(descriptor: int) -> bool:
        if not removed:
            lock.unlink()
        removed.append(descriptor)
        return ask(descriptor)

    monkeypatch.setattr(folder_lock, "_taken", late)
    with folder_lock.alone_in(tmp_path, lock, "vgvt reconcile"):
        assert len(removed) == 2
        assert lock.exists()
    assert lock.exists()


@pytest.mark.parametrize("kept", ["nothing", "derivatives", "rounds and derivatives"])
def test_an_interrupt_says_all_that_is_kept(vgvt, tmp_path: Path, question, monkeypatch, kept: str) -> None:
    from vgvt.reconcile import loop

    def interrupted(*_: object, folder: Path, **__: object) -> None:
        for name in kept.split(" and ") if kept != "nothing" else ():
            (folder / f"{name}.json").write_text("{}", encoding="utf-8")
        raise KeyboardInterrupt

    monkeypatch.setattr(loop, "reconcile", interrupted)
    stopped = vgvt(*question, "found")
    assert stopped.status == 130
    wanted = "nothing new was kept in found" if kept == "nothing" else f"kept in found: the {kept} computed so far"
    assert wanted in stopped.err
    assert (tmp_path / "found").exists() == (kept != "nothing")
