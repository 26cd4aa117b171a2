"""Plugins that are no good, at the command line: each is named, breaks nothing else, and is no fault of the input."""

from __future__ import annotations

from pathlib import Path

import pytest

pytestmark = pytest.mark.filterwarnings("default:.* is left out")

EFFECTS = """
from dataclasses import dataclass
from typing import ClassVar

from vgvt.effects import Action, Family, parameter


@dataclass(frozen=True)
class Bare:
    name: ClassVar[str] = "bare"

    def act(self, scenario, run):
        return Action()


@dataclass(frozen=True)
class Failing:
    name: ClassVar[str] = "failing"
    summary: ClassVar[str] = "It fails"
    family: ClassVar[Family] = Family.ACQUISITION
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "none"
    confused_with: ClassVar[tuple[str, ...]] = ()
    separating_test: ClassVar[str] = "none"
    reference: ClassVar[str] = "none"
    size_kg: float = parameter("kg", 0.1, 1.0, "size", neutral=0.0)

    def act(self, scenario, run):
        return {}["k"]
"""
METHOD = """
from dataclasses import dataclass
from typing import ClassVar

from vgvt.identification import Needs


@dataclass(frozen=True)
class Method:
    name: ClassVar[str] = "{name}"
    summary: ClassVar[str] = "It fails"
    citation: ClassVar[str] = "@misc{{none, title = {{None}}}}"
    needs: ClassVar[Needs] = Needs.FRFS

    def identify(self, campaign, band_hz):
        {body}
"""
SCENARIO = """
extends = "quick"
name = "spoiled"
summary = "Quick, with an effect that fails."

[[effect]]
name = "failing"
size_kg = 0.5
"""


@pytest.fixture
def effects(install) -> None:
    """Two effects: one that says nothing of itself, one that fails."""
    install("mike", EFFECTS, "vgvt.effects", {"bare": "Bare", "failing": "Failing"})


@pytest.mark.usefixtures("effects")
def test_one_faulty_effect_does_not_break_the_list(vgvt) -> None:
    result = vgvt("list", "effects", "--json")
    assert result.status == 0
    names = {item["name"] for item in result.document["items"]}
    assert {"failing", "channel-gain"} <= names and "bare" not in names
    assert "effect plugin 'bare' (mike:Bare) is left out: its class attribute 'summary' is missing" in result.err


@pytest.mark.usefixtures("effects")
def test_doctor_looks_at_effects_too(vgvt, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vgvt.cli.doctor._in_process", lambda *_: "")
    checks = [c for c in vgvt("doctor", "--json").document["checks"] if c["check"] == "effects"]
    assert [c["status"] for c in checks] == ["ok", "warn"]
    assert "channel-gain" in checks[0]["detail"] and checks[0]["detail"].endswith(", failing")
    assert "'bare' (mike:Bare)" in checks[1]["detail"] and checks[1]["advice"]


@pytest.mark.usefixtures("effects")
def test_an_effect_that_fails_is_named_and_the_input_is_not_blamed(vgvt, tmp_path: Path) -> None:
    (tmp_path / "spoiled.toml").write_text(SCENARIO)
    result = vgvt("simulate", "./spoiled.toml", "--engine", "linear", "--json")
    assert result.status == 1
    error = result.document["error"]
    assert error["kind"] == "failure"
    assert error["message"].startswith("effect 'failing' failed in act(run 0): KeyError: 'k' (run with VGVT_TRACEBACK")


@pytest.mark.usefixtures("effects")
def test_a_scenario_with_an_effect_that_is_left_out_is_told_so(vgvt, tmp_path: Path) -> None:
    """And not that there is none of that name, with the names of all others."""
    (tmp_path / "spoiled.toml").write_text(SCENARIO.replace("failing", "bare").replace("size_kg = 0.5", ""))
    result = vgvt("simulate", "./spoiled.toml", "--engine", "linear", "--json")
    assert result.status == 2
    error = result.document["error"]
    assert "effect 'bare' is installed, but of no use" in error["message"] and "doctor" in str(error)


@pytest.mark.filterwarnings("default:divide by zero")
def test_numbers_that_are_none_are_not_written_to_a_campaign(vgvt, install, tmp_path: Path) -> None:
    """A factor that is infinite at 0 Hz, the likeliest mistake of all."""
    act = "return Action(channels=(ChannelFilter('response', lambda f: 1 + 1 / f),))"
    source = EFFECTS.replace('return {}["k"]', act)
    source = source.replace("import Action,", "import Action, ChannelFilter,")
    install("mike", source, "vgvt.effects", {"failing": "Failing"})
    (tmp_path / "spoiled.toml").write_text(SCENARIO)
    result = vgvt("simulate", "./spoiled.toml", "--engine", "linear", "--out", "there", "--json")
    assert result.status == 1
    said = "effect 'failing' failed in the ChannelFilter on 'response' (run 0): ValueError: 1 of "
    assert result.document["error"]["message"].startswith(said)
    assert not (tmp_path / "there").exists()


def test_a_module_that_leaves_breaks_nothing_else(vgvt, install) -> None:
    install("mike", "import sys\nsys.exit(3)", "vgvt.effects", {"bare": "Bare"})
    result = vgvt("list", "effects", "--json")
    assert result.status == 0 and "effect plugin 'bare' (mike:Bare) is left out: SystemExit: 3" in result.err


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ('return {}["k"]', "identifier 'peaks' failed in identify: KeyError: 'k' (run with VGVT_TRACEBACK"),
        ("return None", "identifier 'peaks' returned NoneType, not a ModalModel (run with VGVT_TRACEBACK"),
    ],
)
def test_an_identifier_that_fails_is_named(vgvt, install, campaign_file: Path, body: str, said: str) -> None:
    install("mike", METHOD.format(name="peaks", body=body), "vgvt.identifiers", {"peaks": "Method"})
    result = vgvt("identify", campaign_file, "--identifier", "peaks", "--json")
    assert result.status == 1
    assert result.document["error"]["message"].startswith(said)


def test_an_identifier_of_a_bundled_name_changes_no_claim(vgvt, install, campaign_file: Path) -> None:
    source = METHOD.format(name="quadrature", body="raise RuntimeError")
    install("aaa", source, "vgvt.identifiers", {"quadrature": "Method"})
    result = vgvt("identify", campaign_file, "--identifier", "quadrature", "--json")
    assert (result.status, result.document["outcome"]) == (0, "found")
    assert "two are called 'quadrature': that of vgvt is used, that of aaa (aaa:Method) is left out" in result.err
