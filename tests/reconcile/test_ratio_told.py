"""A/F is a ratio: what is named of all responses may be the force's, and the verdict says where to look."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import claimed, problem

from vgvt.cli.reconcile_tables import effects_table
from vgvt.effects import available_effects, parameters_of
from vgvt.effects.acting import action_of
from vgvt.effects.action import ChannelFilter
from vgvt.reconcile.decision import reasons
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.scenario import load_scenario
from vgvt.view import reconcile_wording
from vgvt.view.reconcile_account import EffectRow
from vgvt.view.reconcile_wording import in_the_ratio, parameter_text, settings_texts

GAUGE = "look at the force gauge, its plug, cable and amplifier, and at what all responses share"


def rival(name: str, **settings: Any) -> Any:
    hypothesis = Hypothesis(available_effects()[name], settings)
    return SimpleNamespace(
        name=name, hypothesis=hypothesis, gain_nats=90.0, lasting_nats=80.0, held_out=1.0,
        fit=SimpleNamespace(chi2_per_dof=1.1, hypotheses=(hypothesis,)),
    )  # fmt: skip


def told_of_a_name(monkeypatch: pytest.MonkeyPatch, winner: Any, *others: Any) -> list[str]:
    monkeypatch.setattr(reasons, "open_places", lambda addition: ())
    monkeypatch.setattr(reasons, "untold_parameters", lambda fit, index: ())
    addition: Any = SimpleNamespace(
        winner=winner, equivalent=(winner, *others), in_its_place=(winner,), held_out_before=2.0
    )
    limits: Any = SimpleNamespace(set_nats=5.0, evidence_nats=9.0)
    return [words for words in reasons._of_a_name(addition, limits) if "A/F does not tell" in words]


@pytest.mark.parametrize("name", ["sign-flip", "channel-gain", "gain-drift", "anti-alias-delay", "channel-delay"])
@pytest.mark.parametrize("channels", ["response", "force"])
def test_a_name_for_all_responses_or_the_force_sends_to_the_gauge(
    monkeypatch: pytest.MonkeyPatch, name: str, channels: str
) -> None:
    """Once, whichever of the two it is, and whether the other stands beside it."""
    other = {"response": "force", "force": "response"}[channels]
    for others in ((), (rival(name, channels=other),)):
        (said,) = told_of_a_name(monkeypatch, rival(name, channels=channels), *others)
        assert said.endswith(GAUGE)
        assert ("the wrong way round" in said) == (name == "sign-flip")


def test_one_channel_or_hum_on_all_of_them_does_not(monkeypatch: pytest.MonkeyPatch) -> None:
    for winner in (rival("sign-flip", channels="12+Z"), rival("mains-hum", channels="response"), rival("added-mass")):
        assert told_of_a_name(monkeypatch, winner) == []
    (said,) = told_of_a_name(monkeypatch, rival("added-mass"), rival("sign-flip", channels="response"))
    assert said.endswith(GAUGE)


def test_a_lead_sends_there_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """No name was given, and the gauge is what to look at first all the same."""
    for name in ("why_no_name", "beside_a_lead"):
        monkeypatch.setattr(reasons, name, lambda *_: "")
    lead = SimpleNamespace(winner=rival("sign-flip", channels="force"), alike=(), held_out_before=3.0)
    found: Any = SimpleNamespace(null=SimpleNamespace(converged=True), vetoed=(), leads=(lead,), nameless=None)
    assert sum(words.endswith(GAUGE) for words in reasons._of_the_unknown(found)) == 1


def test_no_data_tell_all_responses_turned_from_the_force_turned(tmp_path: Path) -> None:
    case = problem(tmp_path, 1)
    responses, force = (claimed(case, "sign-flip", {}, channels=c).predicted for c in ("response", "force"))
    np.testing.assert_allclose(responses, force, atol=1e-12 * np.abs(force).max())


def test_what_is_told_so_multiplies_channels_in_every_effect_of_the_catalogue() -> None:
    """And nothing else does: hum, lost samples and another clock are no factor of a spectrum."""
    scenario = load_scenario("quick")
    found = set()
    for name, cls in available_effects().items():
        if "channels" not in getattr(cls, "__dataclass_fields__", {}):
            continue
        sizes = {p.name: p.high for p in parameters_of(cls) if p.neutral is not None}
        effect = cls(channels="response", **sizes)
        # A drift is nothing in the only run there is.
        more = scenario.acquisition.model_copy(update={"runs": scenario.acquisition.runs * 2})
        changes = action_of(effect, scenario.model_copy(update={"acquisition": more}), 1).channels
        if changes and all(isinstance(change, ChannelFilter) for change in changes):
            found.add(name)
    assert found == reconcile_wording._FACTORS


def test_the_setting_is_told_with_what_it_may_be_instead() -> None:
    assert settings_texts("sign-flip", {"channels": "response"}, {}) == [
        "channels = response (or force: A/F does not tell)"
    ]
    assert settings_texts("gain-drift", {"channels": "force", "shape": "step"}, {}) == [
        "channels = force (or response: A/F does not tell)",
        "shape = step",
    ]
    assert settings_texts("mains-hum", {"channels": "response"}, {}) == ["channels = response"]
    assert not in_the_ratio("sign-flip", {"channels": "12+Z"}) and not in_the_ratio("added-mass", {})
    effect = EffectRow("sign-flip", "", {}, {"channels": "force"}, 90.0, (), None, None, "", "")
    document = {"name": "sign-flip", "parameters": {}, "settings": effect.settings, "evidence_nats": 90.0}
    (row,) = effects_table([document | {"equivalent": []}]).rows
    assert row[1] == parameter_text(effect) == "channels = force (or response: A/F does not tell)"
