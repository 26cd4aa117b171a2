"""A rehearsal: a campaign in which nothing is missing, the same one for the same number, taken through the loop."""

from __future__ import annotations

import numpy as np
import pytest

import vgvt.reconcile.rehearsal as rehearsal
from vgvt.data import InputError
from vgvt.effects import available_effects
from vgvt.reconcile import Kind, placebo_campaign, rehearsed
from vgvt.scenario import Scenario, load_scenario


@pytest.fixture(scope="module")
def brief() -> Scenario:
    """Three runs of quick with a short sweep."""
    quick = load_scenario("quick")
    sweep = {"start_hz": 4.0, "stop_hz": 32.0, "duration_s": 10.0, "ring_down_s": 3.0}
    runs = ((1, 6, 13, 18), (3, 8, 11, 20), (5, 10, 15, 16))
    return quick.model_copy(
        update={
            "excitation": quick.excitation.model_copy(update=sweep),
            "acquisition": quick.acquisition.model_copy(update={"runs": runs}),
        }
    )


def test_a_number_is_one_campaign_and_another_number_another(brief: Scenario) -> None:
    one, again, other = (placebo_campaign(brief, k) for k in (1, 1, 2))
    assert all(np.array_equal(a.samples, b.samples) for a, b in zip(one.runs, again.runs, strict=True))
    assert not np.allclose(one.runs[0].samples, other.runs[0].samples)
    elsewhere = placebo_campaign(brief.model_copy(update={"seed": brief.seed + 1}), 1)
    assert not np.allclose(one.runs[0].samples, elsewhere.runs[0].samples)


def test_it_does_not_say_what_it_is(brief: Scenario) -> None:
    campaign = placebo_campaign(brief, 1)
    assert campaign.notes == {}
    assert campaign.band_hz == brief.excitation.recorded_band_hz


def test_tolerances_that_hold_no_aircraft_are_told(brief: Scenario, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []

    def falls(lab: Scenario, **_: object) -> None:
        asked.append(lab.seed)
        raise InputError("somewhere", "it falls")

    monkeypatch.setattr(rehearsal, "simulated_campaign", falls)
    with pytest.raises(InputError, match=r"tolerances: of 5 labs .* \(it falls\)"):
        placebo_campaign(brief, 1)
    assert len(set(asked)) == 5


def test_an_aircraft_that_falls_is_drawn_anew(brief: Scenario, monkeypatch: pytest.MonkeyPatch) -> None:
    made, falls = rehearsal.simulated_campaign, iter([True, False])

    def once(lab: Scenario, **options: object) -> object:
        if next(falls):
            raise RuntimeError("no rest")
        return made(lab, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(rehearsal, "simulated_campaign", once)
    assert placebo_campaign(brief, 1).runs


def test_a_hammer_is_refused_as_with_a_campaign() -> None:
    with pytest.raises(InputError, match="a hammer"):
        rehearsed(load_scenario("teaching-beam-hammer"), 1)


def test_nothing_is_missing_and_its_figures_are_those_of_a_placebo(brief: Scenario) -> None:
    """One effect to choose from: it gets no name, and what is left is about the noise."""
    told: list[float] = []
    effects = {"local-absorber": available_effects()["local-absorber"]}
    found = rehearsed(brief, 1, effects=effects, lines=80, progress=lambda f, _: told.append(f))
    assert found.number == 1
    assert found.kind is Kind.ADEQUATE
    assert found.named == ()
    assert 0 < found.placebo.noise_per_dof < 1
    assert found.placebo.chi2_per_dof == pytest.approx(found.placebo.noise_per_dof, rel=0.3)
    assert found.placebo.model_form == pytest.approx(brief.tolerances.model_form, rel=0.2)
    assert 0 < told[0] < 0.2 < told[len(told) // 2] < told[-1] == 1.0
