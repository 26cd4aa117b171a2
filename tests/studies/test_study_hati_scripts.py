"""The scripts of the measured campaign's studies: what they permute, part and group, on made-up data."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import hati_identified
import hati_reconciled
import numpy as np
import pytest
from hati_identified_page import GAP, groups

from vgvt.data import ChannelRole
from vgvt.identification.example import Example

EXAMPLE = Example(frequency_hz=(6.3, 13.7), damping_ratio=(0.012, 0.009), stations=3, noise_m_s2=0.1)


def test_labels_are_permuted_and_samples_are_not() -> None:
    campaign = EXAMPLE.campaign()
    other = hati_reconciled.shuffled(campaign, 20150924)
    assert sorted(map(str, other.response_dofs)) == sorted(map(str, campaign.response_dofs))
    assert other.response_dofs != campaign.response_dofs
    for a, b in zip(campaign.runs, other.runs, strict=True):
        assert np.array_equal(a.samples, b.samples)
        for one, two in zip(a.channels, b.channels, strict=True):
            assert one.role is ChannelRole.RESPONSE or one == two
    assert hati_reconciled.shuffled(campaign, 20150924).response_dofs == other.response_dofs


@pytest.mark.parametrize("pair", [("odd runs", "even runs"), ("forward row", "aft row"), ("right wing", "left wing")])
def test_the_two_ways_of_a_hold_out_share_nothing_and_leave_nothing_out(pair: tuple[str, str]) -> None:
    scenario = hati_reconciled.nominal()
    channels = [
        SimpleNamespace(run_number=r + 1, dof=SimpleNamespace(node=n))
        for r, run in enumerate(scenario.acquisition.runs)
        for n in run
    ]
    problem = SimpleNamespace(measured=SimpleNamespace(channels=channels))
    one, other = (hati_reconciled.half(problem, what) for what in pair)  # type: ignore[arg-type]
    assert one.sum() == 10
    assert np.array_equal(one, ~other)


@pytest.mark.parametrize("where", ["effects", "leads"])
def test_what_a_stage_named_comes_back_with_its_values(where: str) -> None:
    """Or what came nearest, where it named nothing."""
    document: dict[str, Any] = {
        "effects": [],
        "leads": [],
        where: [
            {
                "name": "local-absorber",
                "settings": {},
                "equivalent": ["suspension-surge"],
                "parameters": {"mass_kg": {"value": 0.05, "std": 0.001, "unit": "kg"}},
            }
        ],
    }
    ((hypothesis, values),) = hati_reconciled.named(document)
    assert (hypothesis.name, values) == ("local-absorber", {"mass_kg": 0.05})
    k = [p.name for p in hypothesis.parameters].index("mass_kg")
    assert hypothesis.values(hypothesis.scores(values))["mass_kg"] == pytest.approx(0.05)
    assert hypothesis.scores(values)[k] != 0
    assert not {"local-absorber", "suspension-surge"} & set(hati_reconciled.without(document))


def test_runs_are_tried_together_and_one_by_one() -> None:
    campaign = replace(EXAMPLE, seed=3).campaign()
    parts = hati_identified.parts_of(campaign)
    assert parts["all"] is campaign
    assert [p.runs[0].run for name, p in parts.items() if name != "all"] == [r.run for r in campaign.runs]


def test_claims_that_lie_together_share_a_row() -> None:
    step = 1 + 0.9 * GAP
    assert groups([10.0 * step**2, 10.0, 20.0, 10.0 * step]) == [(10.0, 10.0 * step**2), (20.0, 20.0)]
