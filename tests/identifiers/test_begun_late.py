"""A record that begins while the aircraft rings, as the paper's do: every mode of what is recorded, all the same."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.identification import make_identifier, run_identifier
from vgvt.scenario import load_scenario
from vgvt.simulation import simulate


@pytest.mark.parametrize("name", ["auto", "maximum-likelihood"])
def test_the_recorded_modes_are_found(name: str) -> None:
    """Sköll's sweep from 1 Hz, shortened to 24 s: at 3 Hz, and ringing, when the record begins."""
    scenario = load_scenario("skoll-gvt1")
    runs = ((1, 2, 5, 6, 9, 10, 11, 12, 15, 16, 19, 20),)
    beams = tuple(beam.model_copy(update={"cells": 6}) for beam in scenario.airframe.beam)
    sweep = {"duration_s": 24.0, "unrecorded_s": 24.0 * 2 / 34, "ring_down_s": 3.0}
    late = scenario.model_copy(
        update={
            "airframe": scenario.airframe.model_copy(update={"beam": beams}),
            "acquisition": scenario.acquisition.model_copy(update={"runs": runs, "sample_rate_hz": 250.0}),
            "excitation": scenario.excitation.model_copy(update=sweep),
        }
    )
    result = simulate(late, engine="linear")
    assert result.campaign.band_hz == pytest.approx((3.0, 35.0))
    first = np.abs(result.campaign.runs[0].samples[1:, :10]).max(axis=1)
    assert (first > 1e-3 * np.abs(result.campaign.runs[0].samples[1:]).max(axis=1)).all()
    claim, truth = run_identifier(make_identifier(name), result.campaign), result.truth.as_tested[0]
    bending = [f for f, label in zip(truth.natural_frequency_hz, truth.labels, strict=True) if "bending" in label]
    for hz in (f for f in bending if 3.0 < f < 33.0):
        assert np.abs(claim.natural_frequency_hz / hz - 1).min() < 2e-3
