"""``vgvt reconcile``: what it writes, takes up again and refuses; the whole loop once on a coarse beam."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from coarse_beam import BEAM, written

from vgvt.data import Campaign, Channel, ChannelRole, Direction, Dof, Geometry, Quantity, Record
from vgvt.scenario.points import sensor_points
from vgvt.view.reconcile_account import Account, ChannelRow, EffectRow, ModelState, SuggestionRow

MERIT = {"chi2_per_dof": 1.0, "nrmse_percent": 99.0, "mean_abs_db": 0.01, "frac": 0.999, "nu_gap": 0.01}


@pytest.fixture
def beam(tmp_path: Path) -> Path:
    """A small scenario on disk."""
    path = tmp_path / "beam.toml"
    path.write_text(BEAM, encoding="utf-8")
    return path


def measured(
    place: Callable[[Geometry], Geometry] = lambda g: g, direction: Direction = Direction.PLUS_Z, first: int = 0
) -> Campaign:
    """Noise at the points of the coarse beam, or with something about them changed."""
    nodes = tuple(range(1 + first, 9 + first))
    positions = [(-0.1 if k % 2 == 0 else 0.1, 0.2 + 0.2 * (k // 2), 0.0) for k in range(8)]
    geometry = place(Geometry((*nodes, 100), np.array([*positions, (0.08, 0.8, 0.0)])))
    generator = np.random.default_rng(5)
    runs = []
    for run in range(4):
        channels = [Channel("force", Quantity.EXCITATION_FORCE, ChannelRole.REFERENCE, Dof(100, Direction.PLUS_Z))]
        channels += [
            Channel(f"a{node}", Quantity.ACCELERATION, ChannelRole.RESPONSE, Dof(node, direction))
            for node in nodes[2 * run : 2 * run + 2]
        ]
        runs.append(Record(run + 1, 100.0, tuple(channels), generator.normal(size=(3, 3000))))
    return Campaign("beam", geometry, tuple(runs), (2.0, 25.0))


def moved(node: int, by: tuple[float, float, float]) -> Callable[[Geometry], Geometry]:
    """The geometry with one node elsewhere."""

    def place(geometry: Geometry) -> Geometry:
        positions = geometry.positions_m.copy()
        positions[geometry.nodes.index(node)] += by
        return replace(geometry, positions_m=positions)

    return place


BAD = [
    pytest.param(measured(first=1000), (), ("no response point", "1001+Z", "write the campaign's nodes"), id="points"),
    pytest.param(measured(direction=Direction.MINUS_X), (), ("1-X", "along +Z", "direction"), id="direction"),
    pytest.param(measured(moved(3, (12.0, 0.0, 0.0))), (), ("node 3", "12.00 m", "in metres"), id="places"),
    pytest.param(measured(moved(100, (0.0, -0.3, 0.0))), (), ("0.300 m", "position_m = [0.08, 0.5, 0]"), id="drive"),
    pytest.param(measured(), ("--band", 40, 60), ("40 to 60", "within 2 and 25"), id="band"),
    pytest.param(measured(), ("--band", 9, 4), ("not a band",), id="band upside down"),
    pytest.param(measured(), ("--only", "local-absorbr"), ("local-absorbr", "local-absorber"), id="effect"),
    pytest.param(
        measured(), ("--without", "mains-hum, added-mass"), ("--without mains-hum --without added-mass",), id="a list"
    ),
    pytest.param(measured(), ("--only", "mains-hum", "--without", "mains-hum"), ("no effect to try",), id="none left"),
]


@pytest.mark.parametrize(("campaign", "options", "words"), BAD)
def test_what_does_not_fit_together_is_said_before_anything_is_computed(
    vgvt, tmp_path: Path, beam: Path, campaign: Campaign, options: tuple[Any, ...], words: tuple[str, ...]
) -> None:
    result = vgvt("reconcile", written(tmp_path, campaign), "--scenario", beam, *options)
    assert result.status == 2
    assert result.out == ""
    for word in words:
        assert word in result.err
    assert not (tmp_path / "reconciled").exists()


def test_what_is_missing_is_asked_for(vgvt, tmp_path: Path, beam: Path) -> None:
    without_scenario = vgvt("reconcile", written(tmp_path, measured()))
    assert (without_scenario.status, "--scenario" in without_scenario.err) == (2, True)
    without_campaign = vgvt("reconcile", "--scenario", beam)
    assert (without_campaign.status, "--power" in without_campaign.err) == (2, True)
    hammer = vgvt("reconcile", written(tmp_path, measured()), "--scenario", "teaching-beam-hammer")
    assert (hammer.status, "one shaker" in hammer.err) == (2, True)


def test_a_folder_with_other_files_is_left_alone(vgvt, tmp_path: Path, beam: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("years of work", encoding="utf-8")
    result = vgvt("reconcile", written(tmp_path, measured()), "--scenario", beam, "--out", "mine")
    assert result.status == 2
    assert "thesis.tex" in result.err
    assert [p.name for p in (tmp_path / "mine").iterdir()] == ["thesis.tex"]


def hand_made(verdict: object, *, title: str, facts: dict[str, str], power: tuple[object, ...]) -> Account:
    """What a page shows, without anything computed."""
    frequency = np.linspace(2.0, 25.0, 60)
    predicted = np.outer([1.0, 0.5], 1 + frequency**2) + 0j
    figures: dict[str, float | None] = {
        "chi2_per_dof": 1.0,
        "smooth_per_dof": 1.0,
        "held_out_chi2_per_dof": 1.0,
        "lag_one": 0.0,
        "between_channels": 0.0,
        "share_beyond_three": 0.0,
    }
    merits: dict[str, dict[str, float] | None] = {"train": MERIT, "held_out": MERIT}
    state = ModelState(predicted, np.ones((2, 2)), figures, merits, True)
    return Account(
        title=title,
        kind="ambiguous",
        reasons=("because",),
        unexplained=(),
        facts=facts,
        geometry=Geometry((1,), np.zeros((1, 3))),
        channels=(ChannelRow("run 1, 1+Z"), ChannelRow("run 1, 2+Z", "channel")),
        frequency_hz=frequency,
        measured=predicted,
        sigma=0.01 * np.abs(predicted),
        bands_hz=np.array([2.0, 10.0, 25.0]),
        before=state,
        after=state,
        limits={"chi2_per_dof": 1.3, "smooth_per_dof": 1.8, "held_out_chi2_per_dof": 2.0, "evidence_nats": 6.0}
        | {"set_nats": 5.0},
        provenance="by hand",
        effects=(
            EffectRow(
                "added-mass", "", {"mass_kg": (0.1, 0.01, "kg")}, {}, 50.0, ("local-absorber",), 9.0, 1.0, "", ""
            ),
        ),
        tests=(SuggestionRow("tape a mass", ("added-mass", "local-absorber"), 20.0, 5.0),),
    )


@pytest.fixture
def loops(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """Let a verdict by hand stand in for the loop; the list grows by the options of every call."""
    import vgvt.reconcile.loop
    import vgvt.reconcile.outcome.account
    import vgvt.view.reconcile_page

    done: list[dict[str, Any]] = []

    def close(campaign: Campaign, scenario: Any, *, folder: Path, progress: Any, **options: Any) -> SimpleNamespace:
        done.append({"seed": scenario.seed, "band_hz": campaign.band_hz, "runs": campaign.runs, **options})
        progress(0.5, "half way", 3.0)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "reconciled.toml").write_text("# found\n", encoding="utf-8")
        effect = {"parameters": {"mass_kg": {"value": 0.1, "std": 0.01, "unit": "kg"}}, "settings": {}}
        effect |= {"name": "added-mass", "evidence_nats": 50.0, "equivalent": ["local-absorber"]}
        sets = {"train": MERIT, "held_out": MERIT, "held_runs": None, "held_channels": None}
        document = {"verdict": "ambiguous", "reasons": ["because"], "effects": [effect], "before": sets, "after": sets}
        about = SimpleNamespace(
            scenario=scenario,
            measured=SimpleNamespace(runs=scenario.acquisition.run_nodes, run_numbers=()),
            layouts=SimpleNamespace(first=SimpleNamespace(grid=sensor_points(scenario))),
        )
        found = SimpleNamespace(null=SimpleNamespace(problem=about))
        return SimpleNamespace(kind="ambiguous", document=lambda: document, attribution=found)

    monkeypatch.setattr(vgvt.reconcile.loop, "reconcile", close)

    def page(path: Path, account: Account) -> Path:
        path.write_text(account.title, encoding="utf-8")  # drawn in the tests of the page; here it would only cost time
        return path

    monkeypatch.setattr(vgvt.reconcile.outcome.account, "account_of", hand_made)
    monkeypatch.setattr(vgvt.view.reconcile_page, "write_reconcile_page", page)
    return done


def test_three_files_one_object_and_the_verdict_in_words(vgvt, tmp_path: Path, beam: Path, loops) -> None:
    campaign = written(tmp_path, measured())
    arguments = ("reconcile", campaign, "--scenario", beam, "--out", "found")
    document = vgvt(*arguments, "--json").document
    assert {"verdict", "effects", "before", "after", "sentence", "next_steps", "would_disprove_it"} <= set(document)
    files = {p.name for p in (tmp_path / "found").iterdir()}
    assert {"verdict.json", "reconciled.toml", "report.html"} <= files <= {*files, "cache"}
    assert json.loads((tmp_path / "found" / "verdict.json").read_text(encoding="utf-8")) == document
    told = vgvt(*arguments)
    assert told.status == 0
    for words in ("added-mass or local-absorber", "because", "0.100 ± 0.010 kg", "99.00", "tape a mass"):
        assert words in told.out


def test_an_answered_question_is_not_computed_again(vgvt, tmp_path: Path, beam: Path, loops) -> None:
    campaign = written(tmp_path, measured())
    arguments = ("reconcile", campaign, "--scenario", beam, "--out", "found", "--json")
    first = vgvt(*arguments).document
    again = vgvt(*arguments)
    assert again.document == first
    assert "already holds" in again.err
    assert len(loops) == 1
    vgvt(*arguments, "--force")
    vgvt(*arguments, "--lines", 100)
    vgvt(*arguments, "--lines", 100, "--seed", 7)
    vgvt(*arguments, "--lines", 100, "--seed", 7, "--band", 3, 20)
    assert len(loops) == 5
    assert (loops[3]["seed"], loops[4]["band_hz"], loops[4]["lines"]) == (7, (3.0, 20.0), 100)
    (tmp_path / "found" / "report.html").unlink()
    vgvt(*arguments, "--lines", 100, "--seed", 7, "--band", 3, 20)
    assert len(loops) == 6


def test_other_samples_are_another_question(vgvt, tmp_path: Path, beam: Path, loops) -> None:
    campaign = measured()
    arguments = ("--scenario", beam, "--out", "found", "--json")
    vgvt("reconcile", written(tmp_path, campaign), *arguments)
    first = campaign.runs[0]
    louder = replace(campaign, runs=(replace(first, samples=1.01 * first.samples), *campaign.runs[1:]))
    vgvt("reconcile", written(tmp_path, louder), *arguments)
    assert len(loops) == 2


@pytest.mark.parametrize("dead", [[1], [1, 2]], ids=["one channel", "all of a run"])
def test_a_dead_channel_is_refused_or_left_out_and_stays_on_the_aircraft(
    vgvt, tmp_path: Path, beam: Path, loops, dead: list[int]
) -> None:
    """It goes to the loop as it is: that leaves it out, and must know what hangs on the structure in which run."""
    campaign = measured()
    silent = campaign.runs[1].samples.copy()
    silent[dead] = 0.0
    broken = replace(campaign, runs=(campaign.runs[0], replace(campaign.runs[1], samples=silent), *campaign.runs[2:]))
    arguments = ("reconcile", written(tmp_path, broken), "--scenario", beam, "--out", "found", "--json")
    refused = vgvt(*arguments)
    assert refused.status == 2
    assert "run 2, channel a3" in refused.document["error"]["message"]
    assert "--leave-out-faulty" in refused.document["error"]["advice"]
    assert vgvt(*arguments, "--leave-out-faulty").status == 0
    assert [[len(record.channels) for record in done["runs"]] for done in loops] == [[3, 3, 3, 3]]


def test_only_and_without_choose_the_hypotheses(vgvt, tmp_path: Path, beam: Path, loops) -> None:
    campaign = written(tmp_path, measured())
    arguments = ("reconcile", campaign, "--scenario", beam, "--json")
    vgvt(*arguments, "--only", "added-mass", "--only", "mains-hum")
    vgvt(*arguments, "--without", "added-mass")
    assert set(loops[0]["effects"]) == {"added-mass", "mains-hum"}
    assert "added-mass" not in loops[1]["effects"] and "mains-hum" in loops[1]["effects"]


def test_what_was_asked_for_and_not_tried_is_told(vgvt, tmp_path: Path, beam: Path, loops) -> None:
    """A shaker on a beam puts no moment on the body; it had been left out without a word."""
    arguments = ("reconcile", written(tmp_path, measured()), "--scenario", beam, "--only", "added-mass")
    arguments = (*arguments, "--only", "stinger-moment", "--json")
    for told in (vgvt(*arguments), vgvt(*arguments)):
        assert list(told.document["not_tried"]) == ["stinger-moment"]
        assert "--only: stinger-moment was not tried, as no variant of it could show" in told.err
        assert "a moment can only be put on the centre body" in told.err
    assert len(loops) == 1
    everything = vgvt("reconcile", *arguments[1:4], "--json")
    assert "stinger-moment" in everything.document["not_tried"] and "was not tried" not in everything.err


def test_how_many_share_the_work_changes_no_question(vgvt, tmp_path: Path, beam: Path, loops) -> None:
    arguments = ("reconcile", written(tmp_path, measured()), "--scenario", beam, "--out", "found", "--json")
    vgvt(*arguments, "--workers", 3)
    vgvt(*arguments)
    assert [done["workers"] for done in loops] == [3]
    vgvt(*arguments, "--force")
    assert 1 <= loops[1]["workers"] <= 4


def test_ctrl_c_keeps_the_former_answer(vgvt, tmp_path: Path, beam: Path, loops, monkeypatch) -> None:
    from vgvt.reconcile import loop

    arguments = ("reconcile", written(tmp_path, measured()), "--scenario", beam, "--out", "found", "--json")
    first = vgvt(*arguments).document

    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(loop, "reconcile", interrupted)
    stopped = vgvt(*arguments, "--force")
    assert stopped.status == 130
    assert "kept in found" in stopped.err
    assert vgvt(*arguments).document == first


@pytest.mark.slow
def test_the_whole_loop_on_a_coarse_beam(vgvt, tmp_path: Path, beam: Path) -> None:
    from vgvt.scenario import load_scenario

    truth = tmp_path / "truth.toml"
    effect = '[[effect]]\nname = "channel-gain"\ngain_error = 0.10\nchannels = "sensor-2"\n'
    truth.write_text(BEAM.replace("coarse-beam", "true-beam") + effect, encoding="utf-8")
    assert vgvt("simulate", truth, "--out", "test").status == 0
    arguments = ("reconcile", "test", "--scenario", beam, "--only", "channel-gain", "--lines", 60, "--out", "found")
    document = vgvt(*arguments, "--json").document
    assert document["verdict"] in ("adequate", "explained", "ambiguous", "partly_explained", "unknown")
    assert {"nrmse_percent", "chi2_per_dof", "mean_abs_db"} <= set(document["before"]["held_out"])
    assert document["suggested_tests"] is not None and document["unexplained"] is not None
    assert load_scenario(str(tmp_path / "found" / "reconciled.toml")).name.endswith("reconciled")
    page = (tmp_path / "found" / "report.html").read_text(encoding="utf-8")
    assert document["sentence"] in page
    again = vgvt(*arguments, "--force", "--json").document
    changing = ("timing_s",)
    assert {k: v for k, v in again.items() if k not in changing} == {
        k: v for k, v in document.items() if k not in changing
    }
