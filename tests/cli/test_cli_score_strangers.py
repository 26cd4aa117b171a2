"""``vgvt score`` tells, and still scores, where a claim and a truth are of different tests."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from vgvt.files import write_campaign


@pytest.fixture
def own_name(monkeypatch: pytest.MonkeyPatch, simulations: list[str], plate_campaign) -> None:
    """The plate's campaign under the name of the scenario, as the simulation names it."""
    from dataclasses import replace

    import vgvt.simulation

    stand_in = vgvt.simulation.simulate

    def simulate(scenario, **options):
        return replace(stand_in(scenario, **options), campaign=replace(plate_campaign, name=scenario.name))

    monkeypatch.setattr(vgvt.simulation, "simulate", simulate)


@pytest.mark.usefixtures("own_name")
def test_a_claim_against_its_own_truth_needs_no_word(vgvt) -> None:
    assert vgvt("run", "quick", "--no-report").status == 0
    for place in (("runs/quick",), ("runs/quick/claims/auto.json", "runs/quick/sealed/truth.nc")):
        result = vgvt("score", *place)
        assert result.status == 0
        assert "careful" not in result.err
    assert json.loads(Path("runs/quick/claims/auto.json").read_text())["campaign"] == "quick"


@pytest.mark.usefixtures("own_name")
def test_a_claim_of_another_campaign_is_told_of_in_a_line(vgvt, plate_campaign) -> None:
    from dataclasses import replace

    vgvt("run", "quick", "--no-report")
    write_campaign(Path("other.nc"), replace(plate_campaign, name="the other"))
    vgvt("identify", "other.nc", "--out", "claim.json")
    for form in ((), ("--json",)):
        result = vgvt("score", "claim.json", "runs/quick/sealed/truth.nc", *form)
        assert result.status == 0
        (line,) = (line for line in result.err.splitlines() if "careful" in line)
        assert "'the other'" in line and "'quick'" in line
    # A claim written before claims had names lies beside its campaign, which has one.
    write_campaign(Path("runs/quick/campaign.nc"), replace(plate_campaign, name="the other"))
    path = Path("runs/quick/claims/auto.json")
    document = json.loads(path.read_text())
    del document["campaign"]
    path.write_text(json.dumps(document))
    assert "'the other'" in vgvt("score", path, "runs/quick/sealed/truth.nc").err
    # Alone in a folder nothing is known of it, and nothing is said.
    Path("alone.json").write_text(json.dumps(document))
    assert "careful" not in vgvt("score", "alone.json", "runs/quick/sealed/truth.nc").err


@pytest.mark.usefixtures("own_name")
def test_points_that_the_truth_does_not_have_are_named(vgvt) -> None:
    vgvt("run", "quick", "--no-report")
    path = Path("runs/quick/claims/auto.json")
    document = json.loads(path.read_text())
    for mode in document["modes"]:
        mode["shape"][0]["dof"] = "777+Z"
    document["residues"] = None
    path.write_text(json.dumps(document))
    result = vgvt("score", "runs/quick")
    assert result.status == 0
    assert "777+Z" in result.err
