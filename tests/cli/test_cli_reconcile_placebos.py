"""``vgvt reconcile --placebos`` and ``--thresholds``: what is kept, taken up again, refused and told."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from coarse_beam import BEAM, written

from vgvt.cli import reconcile_folder, reconcile_placebos
from vgvt.effects import available_effects
from vgvt.reconcile import Kind, Placebo, Rehearsal, Thresholds, loop, rehearsal, stored_thresholds, thresholds_of
from vgvt.reconcile.placebo import write_thresholds
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import simulated_campaign


@pytest.fixture
def beam(tmp_path: Path) -> Path:
    path = tmp_path / "beam.toml"
    path.write_text(BEAM, encoding="utf-8")
    return path


@pytest.fixture
def tried(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """Let figures by hand stand in for the loop; the list grows by the number and the options of every campaign."""
    done: list[dict[str, Any]] = []

    def rehearsed(scenario: Scenario, number: int, **options: Any) -> Rehearsal:
        done.append({"number": number, "scenario": scenario.name, **options})
        named = ("added-mass",) if number == 3 else ()
        kind = Kind.EXPLAINED if named else Kind.ADEQUATE
        return Rehearsal(
            number, kind, named, Placebo(0.5, 0.5, 0.5, 12.5 if named else 0.1 * number, 0.45, 0.45, strain_sd=2.0)
        )

    monkeypatch.setattr(rehearsal, "rehearsed", rehearsed)
    return done


def placebos(vgvt: Callable[..., Any], beam: Path, out: Path, *more: object) -> Any:
    return vgvt("reconcile", "--scenario", beam, "--placebos", 10, "--workers", 1, "--out", out, *more)


def test_it_says_how_often_something_was_named_and_writes_limits(vgvt, tmp_path: Path, beam: Path, tried) -> None:
    out = tmp_path / "out"
    found = placebos(vgvt, beam, out, "--json")
    assert found.status == 0
    document = json.loads(found.out)
    assert document["campaigns"] == 10
    assert document["named"] == 1
    assert document["names"] == {"added-mass": 1}
    assert document["verdicts"] == {"adequate": 9, "explained": 1}
    low, high = document["named_interval"]
    assert low < 0.1 < high
    assert document["best_nats"][0] == 12.5
    limits = thresholds_of(Path(document["thresholds_file"]))
    assert limits.evidence_nats >= 12.5
    assert limits.strain_sd == pytest.approx(stored_thresholds().strain_sd)
    assert "10 campaigns" in limits.provenance
    assert "--placebos 10" in limits.provenance
    assert [t["number"] for t in tried] == list(range(1, 11))
    assert sorted(p.name for p in out.iterdir()) == ["cells", "thresholds.toml"]


def test_in_words(vgvt, tmp_path: Path, beam: Path, tried) -> None:
    found = placebos(vgvt, beam, tmp_path / "out")
    assert "Of 10 campaigns in which nothing is missing 1 was given a name: of all" in found.out
    assert "names: added-mass 1" in found.out
    assert "as shipped" in found.out
    assert "--thresholds" in found.out


def test_what_is_done_is_kept_and_another_question_is_not_answered_with_it(
    vgvt, tmp_path: Path, beam: Path, tried, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, whole = tmp_path / "out", rehearsal.rehearsed

    def stops(scenario: Scenario, number: int, **options: Any) -> Rehearsal:
        if number == 4:
            raise KeyboardInterrupt
        return whole(scenario, number, **options)

    with monkeypatch.context() as patch:
        patch.setattr(rehearsal, "rehearsed", stops)
        stopped = placebos(vgvt, beam, out)
    assert stopped.status == 130
    assert "3 campaigns are kept" in stopped.err
    assert not (out / "thresholds.toml").exists()
    again = placebos(vgvt, beam, out)
    assert again.status == 0
    assert "took 3 of 10 campaigns" in again.err
    assert [t["number"] for t in tried] == [1, 2, 3, *range(4, 11)]
    placebos(vgvt, beam, out)
    assert len(tried) == 10
    placebos(vgvt, beam, out, "--force")
    assert len(tried) == 20
    placebos(vgvt, beam, out, "--lines", 160)
    assert len(tried) == 30
    beam.write_text(BEAM.replace("duration_s = 20.0", "duration_s = 21.0"), encoding="utf-8")
    placebos(vgvt, beam, out)
    assert len(tried) == 40


def test_a_cut_off_file_of_a_campaign_is_made_again(vgvt, tmp_path: Path, beam: Path, tried) -> None:
    out = tmp_path / "out"
    placebos(vgvt, beam, out)
    kept = out / "cells" / "placebo-0007.json"
    kept.write_bytes(kept.read_bytes()[:40])
    placebos(vgvt, beam, out)
    assert [t["number"] for t in tried[10:]] == [7]


def test_options_reach_every_campaign(vgvt, tmp_path: Path, beam: Path, tried) -> None:
    limits = tmp_path / "limits.toml"
    write_thresholds(limits, replace(stored_thresholds(), evidence_nats=20.0))
    options = ("--thresholds", limits, "--band", 3, 40, "--lines", 99, "--only", "added-mass", "--seed", 12)
    assert placebos(vgvt, beam, tmp_path / "out", *options).status == 0
    for one in tried:
        assert one["thresholds"].evidence_nats == 20.0
        assert one["band_hz"] == (3.0, 25.0)
        assert one["lines"] == 99
        assert list(one["effects"]) == ["added-mass"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("campaign.nc", "--placebos", 10), "CAMPAIGN: was measured"),
        (("--placebos", 10, "--power"), "--power: asks for something else"),
        (("--placebos", 10, "--leave-out-faulty"), "--leave-out-faulty: leaves out what was measured badly"),
        (("--placebos", 9), "'--placebos': Input should be greater than or equal to 10"),
        (("--placebos", 10, "--band", 40, 50), "--band: 40 to 50 Hz lies outside"),
        (("--placebos", 10, "--thresholds", "nowhere.toml"), "nowhere.toml: cannot be read"),
        (("--placebos", 10, "--out", "beam.toml"), "this is a file"),
        (("--power", "--thresholds", "beam.toml"), "beam.toml: chi2_per_dof: is missing"),
    ],
)
def test_what_makes_no_sense_is_refused_before_any_campaign(
    vgvt, beam: Path, tried, arguments: tuple[object, ...], words: str
) -> None:
    found = vgvt("reconcile", "--scenario", beam, *arguments)
    assert found.status == 2
    assert words in " ".join(found.err.split())
    assert tried == []
    assert sorted(p.name for p in beam.parent.iterdir()) == ["beam.toml"]


def test_limits_reach_the_loop_and_make_another_question(
    vgvt, tmp_path: Path, beam: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a campaign of the beam itself, the loop broken off where it begins."""
    simulated = simulated_campaign(load_scenario(str(beam)), engine="linear")
    campaign, limits = written(tmp_path, simulated), tmp_path / "limits.toml"
    asked: list[tuple[object, str]] = []
    fingerprint = reconcile_folder.fingerprint_of

    def told(*given: Any) -> str:
        asked.append((None, fingerprint(*given)))
        return asked[-1][1]

    def broken_off(*_: object, thresholds: Thresholds | None, **__: object) -> None:
        asked[-1] = (thresholds and thresholds.evidence_nats, asked[-1][1])
        raise KeyboardInterrupt

    monkeypatch.setattr(reconcile_folder, "fingerprint_of", told)
    monkeypatch.setattr(loop, "reconcile", broken_off)
    for nats in (None, 20.0, 30.0, 30.0):
        write_thresholds(limits, replace(stored_thresholds(), evidence_nats=nats or 1.0))
        options = () if nats is None else ("--thresholds", limits)
        assert vgvt("reconcile", campaign, "--scenario", beam, "--out", "found", *options).status == 130
    assert [nats for nats, _ in asked] == [None, 20.0, 30.0, 30.0]
    assert len({question for _, question in asked}) == 3
    assert asked[2] == asked[3]


def test_a_hammer_is_refused(vgvt, beam: Path, tried) -> None:
    found = vgvt("reconcile", "--scenario", "teaching-beam-hammer", "--placebos", 10)
    assert found.status == 2
    assert "a hammer" in found.err
    assert tried == []


@pytest.mark.slow
def test_campaigns_in_two_processes_are_those_of_one(tmp_path: Path, beam: Path) -> None:
    """Of a beam of four cells, which is no model of what has twenty: a rehearsal is where that shows."""
    scenario = load_scenario(str(beam))
    effects = {"added-mass": available_effects()["added-mass"]}
    work = partial(
        reconcile_placebos._rows, scenario=scenario, effects=effects, thresholds=None, lines=60, band_hz=None
    )
    found = [
        reconcile_placebos._worked_off(tmp_path / f"by-{n}", "a test", 2, work, n, False, lambda *_: None)
        for n in (1, 2)
    ]
    assert found[0] == found[1]
    assert [row["number"] for row in found[0]] == [1, 2]
    assert all(row["verdict"] != "adequate" for row in found[0])
