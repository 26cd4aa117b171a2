"""Running an identifier: the band is checked against the campaign, the claim against the contract."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest

from vgvt.data import Campaign, Dof, InputError, ModalModel, Outcome, PluginError
from vgvt.identification import (
    ContractError,
    Needs,
    bibliography,
    bibtex_entries,
    make_identifier,
    run_identifier,
)
from vgvt.identification.conformance import without_force
from vgvt.identification.example import Example


@dataclass(frozen=True)
class Fixed:
    """Claims the frequencies it is told to, whatever it sees."""

    name: ClassVar[str] = "fixed"
    summary: ClassVar[str] = "for tests"
    citation: ClassVar[str] = "@misc{fixed, title = {Fixed}}\n\n@book{ewins2000, title = {Modal Testing}}"
    needs: ClassVar[Needs] = Needs.FORCE_REFERENCE
    claims_hz: tuple[float, ...] = ()
    outcome: Outcome = Outcome.FOUND
    advice: tuple[str, ...] = ()

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The claim as set."""
        count, dofs = len(self.claims_hz), campaign.response_dofs
        return ModalModel(
            natural_frequency_hz=np.array(self.claims_hz, dtype=float),
            damping_ratio=np.full(count, 0.01),
            shapes=np.ones((count, len(dofs)), dtype=complex),
            dofs=dofs,
            outcome=self.outcome,
            advice=self.advice,
        )


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    return Example().campaign()


def test_the_claim_is_stamped_with_method_and_settings(campaign: Campaign) -> None:
    model = run_identifier(Fixed((10.0,)), campaign)
    assert model.method == "fixed"
    assert model.settings["claims_hz"] == "(10.0,)"


@pytest.mark.parametrize(
    ("band", "words"),
    [
        ((20.0, 10.0), "not 0 <= low < high"),
        ((-1.0, 10.0), "not 0 <= low < high"),
        ((5.0, float("nan")), "not 0 <= low < high"),
        ((5.0, 500.0), "above half the sample rate"),
        ((50.0, 60.0), "outside the excitation"),
    ],
)
def test_a_band_the_records_cannot_hold_is_bad_input(campaign: Campaign, band: tuple[float, float], words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        run_identifier(Fixed((10.0,)), campaign, band)
    assert "3 to 40 Hz" in str(caught.value)


def test_a_band_beyond_the_excitation_is_remarked(campaign: Campaign) -> None:
    model = run_identifier(Fixed((10.0,)), campaign, (1.0, 60.0))
    assert any("beyond the excited one" in text for text in model.advice)


def test_the_claim_says_whether_the_force_was_used(campaign: Campaign) -> None:
    """The needs decide, for what is found as for a refusal."""

    class Blind(Fixed):
        needs: ClassVar[Needs] = Needs.OUTPUT_ONLY

    assert run_identifier(Blind((10.0,)), campaign).output_only
    assert run_identifier(Blind(outcome=Outcome.DECLINED, advice=("a sweep",)), campaign).output_only
    assert not run_identifier(Fixed((10.0,)), campaign).output_only


def test_a_method_that_needs_a_force_is_declined_without_one(campaign: Campaign) -> None:
    model = run_identifier(Fixed((10.0,)), without_force(campaign))
    assert model.outcome is Outcome.DECLINED
    assert "run 1" in model.advice[0]


def test_claims_outside_the_band_break_the_contract(campaign: Campaign) -> None:
    with pytest.raises(ContractError, match="outside the band"):
        run_identifier(Fixed((10.0,)), campaign, (20.0, 30.0))


def test_an_empty_claim_needs_a_reason(campaign: Campaign) -> None:
    with pytest.raises(ContractError, match="without saying why"):
        run_identifier(Fixed(), campaign)
    model = run_identifier(Fixed(outcome=Outcome.NOTHING_FOUND, advice=("quiet",)), campaign)
    assert model.advice == ("quiet",)


def test_what_no_modal_model_may_hold_is_the_identifiers_fault(campaign: Campaign) -> None:
    with pytest.raises(PluginError, match="'fixed' failed in identify: ValueError: natural_frequency_hz must"):
        run_identifier(Fixed((float("nan"),)), campaign)
    twice = (("dofs", (Dof.from_label("1+Z"), Dof.from_label("1-Z"))), ("shapes", np.ones((1, 2), complex)))
    with pytest.raises(PluginError, match=r"'fixed' failed in identify: ValueError: dofs .* twice: 1\+Z"):
        run_identifier(Wrong((10.0,), changes=twice), campaign)


def test_a_fault_of_a_bundled_identifier_is_seen_as_it_is(campaign: Campaign, monkeypatch: pytest.MonkeyPatch) -> None:
    method = make_identifier("quadrature")
    monkeypatch.setattr(type(method), "identify", lambda *_: {}["k"])
    with pytest.raises(KeyError, match="k"):
        run_identifier(method, campaign)


@pytest.mark.parametrize("error", [InputError("run 1", "is no sweep"), MemoryError("enough")])
def test_what_is_no_fault_of_the_identifier_passes(
    campaign: Campaign, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    def refuse(*_: object) -> ModalModel:
        raise error

    monkeypatch.setattr(Fixed, "identify", refuse)
    with pytest.raises(type(error), match=str(error)):
        run_identifier(Fixed((10.0,)), campaign)


@dataclass(frozen=True)
class Wrong(Fixed):
    """Claims one mode with some of its values changed."""

    changes: tuple[tuple[str, object], ...] = ()

    def identify(self, campaign: Campaign, band_hz: tuple[float, float]) -> ModalModel:
        """The claim as set, changed."""
        return replace(super().identify(campaign, band_hz), **dict(self.changes))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"damping_ratio": np.array([1.0])}, "does not swing"),
        ({"damping_ratio": np.array([-1.5])}, "does not swing"),
        ({"natural_frequency_std_hz": np.array([-0.1])}, "below zero"),
        ({"damping_ratio_std": np.array([-0.1])}, "below zero"),
        ({"shapes": np.full((1, 8), np.nan, complex)}, "not finite"),
    ],
)
def test_values_that_no_claim_file_may_hold_break_the_contract(
    campaign: Campaign, changes: dict[str, object], words: str
) -> None:
    with pytest.raises(ContractError, match=words):
        run_identifier(Wrong((10.0,), changes=tuple(changes.items())), campaign)


def test_a_mode_without_deviations_is_a_claim(campaign: Campaign) -> None:
    unknown = (("natural_frequency_std_hz", np.array([np.nan])), ("damping_ratio", np.array([-0.01])))
    assert len(run_identifier(Wrong((10.0,), changes=unknown), campaign)) == 1


def test_the_bibliography_holds_every_key_once() -> None:
    text = bibliography([Fixed(), Fixed((1.0,))])
    assert list(bibtex_entries(text)) == ["ewins2000", "fixed"]


def test_a_citation_that_is_no_bibtex_is_refused() -> None:
    with pytest.raises(ValueError, match="no BibTeX entry"):
        bibtex_entries("Ewins, Modal Testing, 2000")
