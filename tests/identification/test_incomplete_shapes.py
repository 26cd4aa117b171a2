"""A mode whose shape cannot be had at some DOFs: the advice says where, why, and what would tell it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import Campaign, ChannelRole, Dof
from vgvt.identification import make_identifier, run_identifier
from vgvt.identification.example import Example
from vgvt.identification.incomplete_shapes import unknown_parts


@pytest.fixture(scope="module")
def apart() -> Campaign:
    """Half of the runs with a force at another place, and no sensor that stays: nothing ties the halves together."""
    campaign = Example(noise_m_s2=1e-3).campaign()
    runs = [
        replace(
            record,
            channels=tuple(
                replace(c, dof=Dof.from_label("98+Z")) if c.role is ChannelRole.REFERENCE else c
                for c in record.channels
            ),
        )
        if record.run > 2
        else record
        for record in campaign.runs
    ]
    geometry = campaign.geometry
    positions = np.vstack([geometry.positions_m, geometry.positions_m[-1] + [0.0, 0.1, 0.0]])
    return replace(
        campaign,
        runs=tuple(runs),
        geometry=replace(geometry, nodes=(*geometry.nodes, 98), positions_m=positions),
    )


@pytest.mark.parametrize("name", ["plscf", "quadrature", "cfdd"])
def test_the_claim_says_where_a_shape_is_unknown(apart: Campaign, name: str) -> None:
    model = run_identifier(make_identifier(name), apart)
    assert len(model) == 3 and all("shape_incomplete" in flags for flags in model.flags)
    said = [line for line in model.advice if "is unknown, and stands as zero, at" in line]
    halves = {"1+Z, 2+Z, 3+Z, 4+Z", "5+Z, 6+Z, 7+Z, 8+Z"}
    for shape, hz in zip(model.shapes, model.natural_frequency_hz, strict=True):
        lacking = ", ".join(str(d) for d, value in zip(model.dofs, shape, strict=True) if value == 0)
        assert lacking in halves
        (line,) = (line for line in said if f"{hz:.3f}" in line)
        assert lacking in line and "same drive point" in line


def test_a_whole_shape_says_nothing() -> None:
    whole = run_identifier(make_identifier("plscf"), Example(noise_m_s2=1e-3).campaign())
    assert not unknown_parts(whole) and not any("unknown" in line for line in whole.advice)
    # A node of the shape is zero, and known: only what is flagged is told.
    assert not unknown_parts(replace(whole, shapes=whole.shapes * (np.arange(8) > 0)))


def test_many_places_are_counted() -> None:
    whole = run_identifier(make_identifier("plscf"), Example(stations=6, noise_m_s2=1e-3).campaign())
    flagged = replace(whole, flags=(("shape_incomplete",),) * 3, shapes=whole.shapes * (np.arange(12) > 9))
    (line,) = unknown_parts(flagged)
    assert "the modes at 6.300, 13.700, 26.900 Hz" in line and "8+Z and 2 more" in line
