"""A campaign with everything that formats of other programs have no place for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vgvt.data import Campaign, Channel, ChannelRole, Dof, Geometry, Quantity, Record


def _acceleration(name: str, dof: str) -> Channel:
    return Channel(name, Quantity.ACCELERATION, ChannelRole.RESPONSE, Dof.from_label(dof))


def rich_campaign() -> Campaign:
    """Two runs of other lengths and rates: a sensor that moves and is turned, one that stays, NaN, names, notes."""
    generator = np.random.default_rng(8)
    drive = Channel("drive", Quantity.GENERAL, ChannelRole.DRIVE)
    force = Channel("force, left", Quantity.EXCITATION_FORCE, ChannelRole.REFERENCE, Dof.from_label("9+Z"))
    speed = Channel("vel", Quantity.VELOCITY, ChannelRole.RESPONSE, Dof.from_label("3-RX"))
    path = Channel("disp", Quantity.DISPLACEMENT, ChannelRole.RESPONSE, Dof.from_label("4S"))
    first, second = generator.standard_normal((5, 300)) * 10.0 ** generator.integers(-9, 9, (5, 300)), np.zeros((5, 77))
    second[:] = generator.standard_normal((5, 77))
    first[1, 17] = np.nan
    return Campaign(
        name='“wing” \\ n° 3 "b"\nline',
        geometry=Geometry(
            (1, 2, 3, 4, 9),
            generator.standard_normal((5, 3)),
            ((1, 2, 3), (4, 9)),
            (generator.standard_normal((4, 3)),),
        ),
        runs=(
            Record(
                7,
                1652.5,
                (drive, force, _acceleration("a1", "1+Z"), speed, path),
                first,
                ("a1",),
                ("windy", "force, left: 1 of 300 samples are not finite"),
            ),
            Record(3, 100 / 3, (drive, force, _acceleration("a2 é", "2-X"), speed, path), second, (), ()),
        ),
        band_hz=(0.1, 35.25),
        notes={"aircraft": "none, “made up”", "a key. of = two\nlines": "x\ty", "summary": "short"},
    )


def single_precision(campaign: Campaign) -> Campaign:
    """The same with samples of 32 bit."""
    return replace(campaign, runs=tuple(replace(r, samples=r.samples.astype(np.float32)) for r in campaign.runs))
