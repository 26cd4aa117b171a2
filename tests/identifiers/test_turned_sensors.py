"""A sensor that is turned over between runs is one response, also where nothing is found."""

from __future__ import annotations

from dataclasses import replace

import pytest

from vgvt.data import Campaign, ChannelRole, Direction, Dof
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
