"""The whole loop on small campaigns with known truth: nothing is named where nothing is missing, and what is, is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, small_scenario

from vgvt.effects import Effect, available_effects
from vgvt.reconcile import Kind, Verdict, loop, reconcile, searches
from vgvt.reconcile.decision.leads import demoted
from vgvt.reconcile.outcome.account import account_of
from vgvt.reconcile.outcome.cells import at_whole_cells
from vgvt.reconcile.outcome.instruments import gain_tables
from vgvt.scenario import load_scenario

SOME = ("channel-gain", "channel-delay", "transducer-mass")
MANY = (*SOME, "local-absorber", "added-mass", "root-compliance", "stinger-moment", "suspension-surge")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Derivatives are worked out once for all tests."""
    return tmp_path_factory.mktemp("reconcile")


def verdict(folder: Path, seed: int, names: tuple[str, ...], *made: Effect) -> Verdict:
    """The verdict on a campaign with effects, the catalogue being those named."""
    known = available_effects()
    scenario = small_scenario()
    campaign = campaign_of(scenario, seed, *made)
    return reconcile(campaign, scenario, effects={n: known[n] for n in names}, lines=150, folder=folder)


def text_of(folder: Path) -> str:
    return (folder / "reconciled.toml").read_text(encoding="utf-8")


def test_a_campaign_without_any_effect_is_adequate(folder: Path) -> None:
    found = verdict(folder, 11, SOME)
    assert found.kind is Kind.ADEQUATE, found.reasons
    assert found.effects == ()


def test_a_wrong_sensitivity_is_named_and_written_back(folder: Path) -> None:
    found = verdict(folder, 12, SOME, available_effects()["channel-gain"](gain_error=0.08, channels="7+Z"))
    assert found.kind is Kind.EXPLAINED, found.reasons
    (effect,) = found.effects
    assert (effect.name, effect.settings["channels"]) == ("channel-gain", "7+Z")
    value, sd, _ = effect.parameters["gain_error"]
    assert abs(value - 0.08) < max(4 * sd, 0.015)
    assert found.after.held_out is not None and found.before.held_out is not None
    # Without the name the channel's own gain takes the error, far out of its tolerance: the data are met either way.
    assert found.after.train.chi2_per_dof < 1.01 * found.before.train.chi2_per_dof
    again = load_scenario(folder / "reconciled.toml")
    gains = gain_tables(again, at_whole_cells(found.attribution.final))
    assert [t.name for t in again.effect[: -len(gains)]] == ["channel-gain"]
    assert again.effect[-len(gains) :] == gains
    assert f"# The last {len(gains)} [[effect]] tables are no findings" in text_of(folder)
    document: Any = found.document()
    assert document["verdict"] == "explained"
    assert document["resimulated"]["train"]["chi2_per_dof"] < document["after"]["train"]["chi2_per_dof"] + 1.0
    assert document["resimulated"]["held_out"]["nu_gap"] < 0.05


@pytest.mark.slow
def test_a_small_second_effect_has_its_name_where_the_first_one_meets_the_data(folder: Path) -> None:
    """The delay leaves noise alone, and a gain that its tolerance of 2 % takes for three deviations of its own."""
    known = available_effects()
    delay = known["channel-delay"](channels="12+Z", delay_s=1.5e-4)
    found = verdict(folder, 3, SOME, delay, known["channel-gain"](channels="4+Z", gain_error=0.06))
    assert {e.name: e.settings["channels"] for e in found.effects} == {"channel-delay": "12+Z", "channel-gain": "4+Z"}
    first = found.attribution.rounds[0].winner
    assert first.name == "channel-delay"
    assert first.fit.chi2_per_dof < 1.02 * found.after.train.chi2_per_dof


def test_a_lead_is_told_and_neither_named_nor_switched_on(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loop, "as_leads", lambda found, thresholds: demoted(found))
    found = verdict(folder, 12, SOME, available_effects()["channel-gain"](gain_error=0.08, channels="7+Z"))
    assert found.kind is Kind.UNKNOWN
    assert found.effects == ()
    (lead,) = found.leads
    assert lead.name == "channel-gain"
    assert found.after == found.before
    assert any("channel-gain (channels = 7+Z) comes nearest" in reason for reason in found.reasons)
    document: Any = found.document()
    assert document["effects"] == []
    assert [e["name"] for e in document["leads"]] == ["channel-gain"]
    assert any("channel-gain" in row["effect"] for row in document["candidates"])
    told = account_of(found, title="a lead")
    assert not told.changed
    assert [row.name for row in told.posterior if not row.tolerance] == ["cells"]
    assert [e.name for e in told.leads] == ["channel-gain"]
    assert [c.standing for c in told.candidates].count("lead") == 1
    written = load_scenario(folder / "reconciled.toml")
    assert written.effect == gain_tables(written, at_whole_cells(found.attribution.final))
    assert "a lead, not switched on here: channel-gain" in text_of(folder)


@pytest.mark.parametrize("as_good", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_the_search_is_made_again_without_what_is_no_plausible_thing(
    folder: Path, monkeypatch: pytest.MonkeyPatch, as_good: bool
) -> None:
    """And counts where what it names does as well."""

    def strange(found: Any) -> frozenset[str]:
        return frozenset(h.name for h in found.final.hypotheses if h.name == "channel-gain")

    told: list[Any] = []

    def telling(found: Any, without: Any) -> Any:
        told.append(without)
        return without

    monkeypatch.setattr(searches, "telling", telling)
    monkeypatch.setattr(searches, "strange_names", strange)
    monkeypatch.setattr(searches, "does_without", lambda found, without, within_nats: as_good)
    found = verdict(folder, 12, SOME, available_effects()["channel-gain"](gain_error=0.08, channels="7+Z"))
    tried = found.attribution
    asked = {r.name for rivals in (*(a.rivals for a in tried.rounds), tried.last_rivals) for r in rivals}
    assert ("channel-gain" in asked) is not as_good
    assert [e.name for e in found.effects] == ([] if as_good else ["channel-gain"])
    # What has no name may be told afterwards of what the search found.
    assert [a.final for a in told] == ([tried.final] if as_good else [])


@pytest.mark.slow
def test_the_same_call_gives_the_same_verdict(folder: Path) -> None:
    first, second = (verdict(folder, 11, ("channel-delay",)) for _ in range(2))
    np.testing.assert_array_equal(first.attribution.final.u, second.attribution.final.u)
    assert first.document() == second.document()


@pytest.mark.slow
@pytest.mark.parametrize(("mass_kg", "frequency_hz", "x_m", "y_m"), [(0.04, 8.0, 0.9, -1.2), (0.03, 24.0, 0.75, 0.9)])
def test_an_absorber_is_found_where_it_is(
    folder: Path, mass_kg: float, frequency_hz: float, x_m: float, y_m: float
) -> None:
    made = available_effects()["local-absorber"](mass_kg=mass_kg, frequency_hz=frequency_hz, x_m=x_m, y_m=y_m)
    found = verdict(folder, 13, MANY, made)
    assert found.effects, found.reasons
    assert found.effects[0].name == "local-absorber", found.reasons
    values = {name: value for name, (value, _, _) in found.effects[0].parameters.items()}
    assert abs(values["frequency_hz"] / frequency_hz - 1) < 0.05
    # Within one station of the candidates' grid.
    assert np.hypot(values["x_m"] - x_m, values["y_m"] - y_m) < 0.4


@pytest.mark.slow
def test_an_effect_outside_the_catalogue_is_not_given_another_name(folder: Path) -> None:
    made = available_effects()["local-absorber"](mass_kg=0.05, frequency_hz=14.0, x_m=0.75, y_m=0.9)
    found = verdict(folder, 13, tuple(n for n in MANY if n != "local-absorber"), made)
    assert found.kind in (Kind.UNKNOWN, Kind.PARTLY_EXPLAINED), found.reasons
    assert found.localisation is not None and found.localisation.places


@pytest.mark.slow
def test_where_one_name_is_left_other_levels_alone_are_compared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With nothing to tell apart there is what came next, and what depends on level."""
    asked = list[tuple[Any, bool]]()

    def suggest(fits: Any, *, levels_alone: bool = False) -> tuple[()]:
        asked.append((fits, levels_alone))
        return ()

    monkeypatch.setattr(loop, "kind_of", lambda found: Kind.AMBIGUOUS)
    monkeypatch.setattr(loop, "undecided", lambda found: ("alone",))
    monkeypatch.setattr(loop, "next_best", lambda found: ("alone", "next"))
    monkeypatch.setattr(loop, "suggest", suggest)
    reconcile(campaign_of(small_scenario(), 1), small_scenario(), effects={}, lines=60, folder=tmp_path)
    assert asked == [(("alone",), False), (("alone", "next"), True)]
