"""A light Hati for planning: few cells, one short sweep."""

from __future__ import annotations

import pytest

from vgvt.scenario import load_scenario


@pytest.fixture(scope="session")
def light():
    """``quick`` with six cells a wing, the linear engine and ten accelerometers."""
    scenario = load_scenario("quick")
    beams = tuple(beam.model_copy(update={"cells": 6}) for beam in scenario.airframe.beam)
    return scenario.model_copy(
        update={
            "airframe": scenario.airframe.model_copy(update={"beam": beams}),
            "acquisition": scenario.acquisition.model_copy(update={"runs": ((1, 2, 5, 9, 10, 11, 12, 15, 19, 20),)}),
            "simulation": scenario.simulation.model_copy(update={"engine": "linear"}),
        }
    )
