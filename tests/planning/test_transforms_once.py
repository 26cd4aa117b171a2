"""A plan asks for the spectrum of each excitation once, and of its rigs for no more than it uses."""

from __future__ import annotations

import pytest

from vgvt.planning import search
from vgvt.planning.budget import Budget
from vgvt.planning.places import shaker_places
from vgvt.planning.planner import Order, plan_test
from vgvt.planning.system import seen_by, systems_of
from vgvt.simulation import command_spectra


@pytest.fixture
def made(monkeypatch):
    """The excitations that were transformed."""
    asked, transformed = [], command_spectra._transformed

    def told(layout, run):
        asked.append(layout.scenario.excitation)
        return transformed(layout, run)

    monkeypatch.setattr(command_spectra, "_known", {})
    monkeypatch.setattr(command_spectra, "_transformed", told)
    return asked


def test_however_many_places_of_the_shaker_are_compared(light, made, monkeypatch) -> None:
    monkeypatch.setattr(search, "shaker_places", lambda scenario: shaker_places(scenario)[:3])
    order = Order(Budget(20.0, 20), free=frozenset({"shaker", "band"}), seeds=0)
    plan_test(light, order)
    # Two bands, of each a linear and a logarithmic sweep, among them.
    assert len(made) == len(set(made)) > 10


def test_rigs_ask_for_no_truth(light, made) -> None:
    """Which bounds every mode by what all sensors tell."""
    (system,) = systems_of(light)
    assert not made
    seen_by(system)
    assert len(made) == 1
