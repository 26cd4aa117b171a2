"""``vgvt reconcile`` asked again: an edited effect and --force begin anew; what leaves nothing to try is refused."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import pytest
from coarse_beam import BEAM, written

from vgvt.cli.reconcile import own_folder
from vgvt.cli.reconcile_folder import ReconcileFolder, fingerprint_of
from vgvt.data import Campaign, InputError
from vgvt.effects import Action, parameter
from vgvt.scenario import load_scenario
from vgvt.scenario.points import sensor_points

GAIN = '[[effect]]\nname = "channel-gain"\ngain_error = 0.10\nchannels = "sensor-2"\n'


@pytest.fixture
def beam(tmp_path: Path) -> Path:
    """A small scenario on disk that has an effect already."""
    path = tmp_path / "beam.toml"
    path.write_text(BEAM + GAIN, encoding="utf-8")
    return path


def measured(beam: Path) -> Campaign:
    """What a test of such a beam shows, by the linear engine."""
    from vgvt.simulation import simulated_campaign

    return simulated_campaign(load_scenario(str(beam)), engine="linear")


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """Each call of the loop with the rounds that it finds; no verdict is ever written."""
    import vgvt.reconcile.loop
    import vgvt.reconcile.outcome.account

    calls: list[dict[str, Any]] = []

    def close(campaign: Any, scenario: Any, *, folder: Path, **options: Any) -> SimpleNamespace:
        calls.append({"found": sorted(p.name for p in folder.glob("*") if p.name != "lock"), **options})
        about = SimpleNamespace(
            scenario=scenario,
            measured=SimpleNamespace(runs=scenario.acquisition.run_nodes, run_numbers=()),
            layouts=SimpleNamespace(first=SimpleNamespace(grid=sensor_points(scenario))),
        )
        return SimpleNamespace(
            kind="unknown", attribution=SimpleNamespace(null=SimpleNamespace(problem=about)), document=dict
        )

    def account(verdict: object, *, facts: dict[str, str], **told: object) -> None:
        calls[-1]["facts"] = facts
        raise InputError("the test", "has seen enough", "stop")

    monkeypatch.setattr(vgvt.reconcile.loop, "reconcile", close)
    monkeypatch.setattr(vgvt.reconcile.outcome.account, "account_of", account)
    return calls


def test_force_does_not_go_on_from_old_rounds(vgvt, tmp_path: Path, beam: Path, asked) -> None:
    """Without it a call that was broken off does; derivatives hold no effect, and are dear."""
    cache = tmp_path / "found" / "cache"
    cache.mkdir(parents=True)
    for name in ("rounds.json", "rounds-plausible.json", "rounds-turned.json", "slopes.npz"):
        (cache / name).write_text("{}", encoding="utf-8")
    arguments = ("reconcile", written(tmp_path, measured(beam)), "--scenario", beam, "--out", "found")
    vgvt(*arguments)
    vgvt(*arguments, "--force")
    assert {"rounds.json", "rounds-turned.json"} < set(asked[0]["found"])
    assert asked[1]["found"] == ["slopes.npz"]


@dataclass(frozen=True)
class Twice:
    """An effect of somebody's own."""

    name: ClassVar[str] = "mine"
    size: float = parameter("", 0.1, 1.0, "size", neutral=0.0, scale="log")

    def act(self, scenario: object, run: int) -> Action:
        return Action(warming_k=2 * self.size)


@dataclass(frozen=True)
class Thrice:
    """The same, edited."""

    name: ClassVar[str] = "mine"
    size: float = parameter("", 0.1, 1.0, "size", neutral=0.0, scale="log")

    def act(self, scenario: object, run: int) -> Action:
        return Action(warming_k=3 * self.size)


def test_an_answer_belongs_to_what_the_effect_did(tmp_path: Path, beam: Path) -> None:
    scenario, campaign = load_scenario(str(beam)), measured(beam)
    once, again, edited = (
        fingerprint_of(campaign, scenario, {"mine": cls}, {"lines": 100}) for cls in (Twice, Twice, Thrice)
    )
    assert once == again != edited
    assert ReconcileFolder(tmp_path).answer(edited) is None


@pytest.mark.parametrize("power", [False, True])
def test_an_effect_that_the_scenario_has_is_not_tried_again(vgvt, tmp_path: Path, beam: Path, asked, power) -> None:
    given = ("--power",) if power else (written(tmp_path, measured(beam)),)
    result = vgvt("reconcile", *given, "--scenario", beam, "--only", "channel-gain")
    assert result.status == 2
    assert "channel-gain in [[effect]] already" in result.err
    assert not asked
    assert not (tmp_path / "reconciled").exists()


def test_an_effect_that_was_asked_for_beside_others_is_told_where_it_is_not_tried(vgvt, tmp_path, beam, asked) -> None:
    """It had been left out without a word, and its verdict read as if it had been refused."""
    arguments = ("reconcile", written(tmp_path, measured(beam)), "--scenario", beam)
    told = vgvt(*arguments, "--only", "channel-gain", "--only", "added-mass").err
    assert "--only: scenario coarse-beam has channel-gain in [[effect]] already: not tried a second time" in told
    assert "already" not in vgvt(*arguments, "--only", "added-mass").err
    assert "already" not in vgvt(*arguments).err


@pytest.mark.parametrize(
    ("named", "folder"),
    [
        ("wing-test", "wing-test-mine"),
        ("GVT 2/3", "GVT 2-3-mine"),
        ("../up", "up-mine"),
        ("/wing", "wing-mine"),
        ("C:\\test", "C-test-mine"),
        ("..", "campaign-mine"),
    ],
)
def test_records_of_any_name_have_one_folder_of_their_own(named: str, folder: str) -> None:
    """A sidecar's name is free text: a slash had made folders of it, outside ``reconciled``, too."""
    assert own_folder(named, "mine") == Path("reconciled") / folder


def test_what_was_tried_is_counted(vgvt, tmp_path: Path, beam: Path, asked) -> None:
    """Not what was asked for: a campaign of one sensor a run has no two that could be taken for one another."""
    arguments = ("reconcile", written(tmp_path, measured(beam)), "--scenario", beam)
    vgvt(*arguments, *(word for n in ("channel-gain", "added-mass", "mains-hum") for word in ("--only", n)))
    assert asked[0]["facts"]["effects tried"] == "2"


def test_what_no_variant_could_show_is_refused_at_once(
    vgvt, tmp_path: Path, beam: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A beam of four runs of one sensor each has no two that could be taken for one another: nothing is fitted."""
    from vgvt.reconcile import loop

    monkeypatch.setattr(loop, "calibrate", lambda *_, **__: pytest.fail("fitted"))
    alone = BEAM.replace("[[1, 2], [3, 4], [5, 6], [7, 8]]", "[[1], [3], [5], [7]]")
    beam.write_text(alone, encoding="utf-8")
    result = vgvt("reconcile", written(tmp_path, measured(beam)), "--scenario", beam, "--only", "swapped-sensors")
    assert result.status == 2
    assert "no variant of swapped-sensors" in result.err
