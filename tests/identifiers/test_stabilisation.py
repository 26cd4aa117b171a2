"""Poles that come back at every order are modes, and every pole has one fate with a reason."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from vgvt.data import grouped_candidates
from vgvt_identifiers.stabilisation import Criteria, PolesAtOrder, stabilise


def pole(frequency_hz: float, damping_ratio: float) -> complex:
    omega = 2 * np.pi * frequency_hz
    return complex(-damping_ratio * omega, omega * np.sqrt(1 - damping_ratio**2))


def table_of(poles: Callable[[int], list[complex]], orders: range = range(2, 33)) -> list[PolesAtOrder]:
    """A table with vectors that all agree."""
    return [PolesAtOrder(n, np.array(poles(n), complex), np.ones((len(poles(n)), 3), complex)) for n in orders]


def test_a_steady_pole_is_a_mode_and_wandering_ones_are_not() -> None:
    generator = np.random.default_rng(0)
    table = table_of(lambda n: [pole(8.0, 0.01), pole(generator.uniform(10, 30), generator.uniform(0.001, 0.05))])
    stable = stabilise(table)
    assert [m.frequency_hz for m in stable.modes] == pytest.approx([8.0])
    assert stable.modes[0].share == 1.0


@pytest.mark.parametrize("damping", [0.0005, 0.01, 0.02])
def test_a_pair_two_per_cent_apart_stays_a_pair(damping: float) -> None:
    """Whatever the damping: at 2 % of it the poles lie one half width apart, at 0.05 % forty."""
    generator = np.random.default_rng(1)

    def near(frequency: float) -> complex:
        return pole(frequency * (1 + 0.05 * damping * generator.standard_normal()), damping)

    stable = stabilise(table_of(lambda n: [near(10.0), near(10.2)]))
    assert [m.frequency_hz for m in stable.modes] == pytest.approx([10.0, 10.2], rel=damping / 2)


def test_two_poles_of_one_order_never_share_a_cluster() -> None:
    stable = stabilise(table_of(lambda n: [pole(10.0, 0.02), pole(10.001, 0.02)]))
    for cluster in stable.clusters:
        orders = stable.orders[list(cluster.members)]
        assert np.unique(orders).size == orders.size


def test_poles_with_other_shapes_are_other_modes() -> None:
    table = table_of(lambda n: [pole(10.0, 0.01)])
    turned = [
        PolesAtOrder(t.order, t.poles_rad_s, np.array([[1.0, -1.0, 0.0]], complex) if t.order % 2 else t.vectors)
        for t in table
    ]
    assert len(stabilise(turned).modes) != 1
    assert len(stabilise(table).modes) == 1


def test_every_pole_has_one_fate_and_a_reason() -> None:
    generator = np.random.default_rng(2)
    table = table_of(
        lambda n: (
            [pole(8.0, 0.01), pole(20.0, -0.01), pole(25.0, 0.6), pole(generator.uniform(16, 30), 0.01)]
            + ([pole(14.0, 0.01)] if n < 8 else [])
        )
    )
    candidates = stabilise(table).candidates()
    assert len(candidates) == sum(t.poles_rad_s.size for t in table)
    assert all(c.reason for c in candidates)
    assert all(c.kept == (abs(c.frequency_hz - 8.0) < 1e-6) for c in candidates)
    reasons = " ".join(g.reason for g in grouped_candidates(candidates))
    for word in ("negative damping", "above 0.3", "only at 6 of 31 orders", "one order only"):
        assert word in reasons


def test_a_mode_can_be_dropped_later_and_says_why() -> None:
    stable = stabilise(table_of(lambda n: [pole(8.0, 0.01)]))
    dropped = stable.without(stable.modes[0], "not needed")
    assert not dropped.modes
    assert {c.reason for c in dropped.candidates()} == {"not needed"}


def test_noise_of_the_size_of_the_resolution_does_not_split_a_very_lightly_damped_mode() -> None:
    generator = np.random.default_rng(3)
    width, step = 2 * np.pi * 10 * 0.0002, 2 * np.pi / 60
    table = table_of(lambda n: [pole(10.0, 0.0002) + 0.1j * step * generator.standard_normal()])
    assert 0.1 * step > 0.5 * width
    assert len(stabilise(table, Criteria(resolution_rad_s=step)).modes) == 1
    assert not stabilise(table).modes


def test_tables_that_make_no_sense_are_refused_and_empty_ones_are_not() -> None:
    row = table_of(lambda n: [pole(8.0, 0.01)])[0]
    with pytest.raises(ValueError, match="twice"):
        stabilise([row, row])
    assert stabilise([]).candidates() == ()
