"""A sensor that is turned over between runs is one response, also where nothing is found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import Campaign, ChannelRole, Direction, Dof, Quantity
from vgvt.identification import make_identifier, run_identifier
from vgvt.identification.example import Example


@pytest.fixture(scope="module")
def turned() -> Campaign:
    """Two runs of the same points, the sensors upside down in the second one."""
    campaign = Example(stations=2, duration_s=20.0, sweep_s=16.0).campaign()
    first = campaign.runs[0]
    over = {c: Dof(c.dof.node, Direction.MINUS_Z) for c in first.channels if c.dof and c.role is ChannelRole.RESPONSE}
    channels = tuple(replace(c, dof=over.get(c, c.dof)) for c in first.channels)
    return replace(campaign, runs=(first, replace(first, run=first.run + 1, channels=channels)))


@pytest.mark.parametrize("name", ["quadrature", "era", "plscf", "cfdd", "subspace"])
def test_a_band_without_modes_has_none(turned: Campaign, name: str) -> None:
    model = run_identifier(make_identifier(name), turned, (17.0, 18.0))
    assert len(model) == 0
    assert len({d.unsigned for d in model.dofs}) == len(model.dofs) == 2


@pytest.mark.parametrize("name", ["ssi-cov", "cfdd-output-only"])
@pytest.mark.parametrize("quantity", [Quantity.ACCELERATION, Quantity.VELOCITY])
def test_two_sensors_of_one_point_are_one_response_without_a_force_too(name: str, quantity: Quantity) -> None:
    """The second sensor is at node 2 upside down: of one quantity the two are averaged, of two the first counts."""
    example = Example(noise_m_s2=0.02)
    campaign = example.ambient_campaign()
    record = campaign.runs[0]
    again = replace(record.channels[1], name="b2", dof=Dof(2, Direction.MINUS_Z), quantity=quantity)
    samples = np.vstack([record.samples, -record.samples[1]])
    both = replace(campaign, runs=(replace(record, channels=(*record.channels, again), samples=samples),))
    alone, model = (run_identifier(make_identifier(name), c) for c in (campaign, both))
    assert model.dofs == alone.dofs
    np.testing.assert_allclose(model.natural_frequency_hz, alone.natural_frequency_hz, rtol=1e-6)
    np.testing.assert_allclose(model.shapes, alone.shapes, rtol=0, atol=1e-6)
    said = [line for line in model.advice if "2+Z is measured by a2, b2" in line]
    assert len(said) == 1 and ("mean" in said[0]) == (quantity is Quantity.ACCELERATION)
