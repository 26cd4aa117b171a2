"""The force law of a joint against its own terms, and where a load holds it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.effects.elements import JointLaw
from vgvt.reconcile.mechanics.joints import Hanging
from vgvt.reconcile.mechanics.law import Law

STIFFNESS = 2000.0


def test_beyond_its_play_it_is_a_spring_that_stiffens() -> None:
    law, x = Law(STIFFNESS, cubic=2e7, play=1e-3), np.array([-3e-3, -1e-3, 0.0, 0.5e-3, 1e-3, 4e-3])
    pressed = np.array([-2e-3, 0.0, 0.0, 0.0, 0.0, 3e-3])
    np.testing.assert_allclose(law.elastic(x), STIFFNESS * pressed + 2e7 * pressed**3, rtol=1e-12)


def test_more_weight_moves_a_joint_to_where_it_is_held() -> None:
    law = Law(STIFFNESS, cubic=2e7, play=1e-3, rest=-4e-3)
    more = law.loaded(-0.5)
    assert more.load == pytest.approx(law.load - 0.5, rel=1e-9)
    assert more.rest < law.rest


@pytest.mark.parametrize(
    ("law", "force"),
    [
        (Law(798.0, play=6.6e-4, rest=-6.74e-4), 0.0405),
        (Law(798.0, cubic=5e8, play=6.6e-4, rest=-6.74e-4), 0.0405),
        (Law(400.0, cubic=1e9, play=5e-3, rest=2e-2), -4e3),
        (Law(400.0, play=5e-3, rest=1e-3), 0.2),
        (Law(400.0, cubic=1e9, rest=-3e-2), 3.0),
    ],
)
def test_it_carries_what_rests_on_it_beyond_its_band_too(law: Law, force: float) -> None:
    """Steps by its slopes ended in the band, where it carries nothing, or on their way."""
    assert law.loaded(force).load == pytest.approx(law.load + force, rel=1e-9)
    assert law.loaded(0.0) == law


def test_what_takes_its_load_off_leaves_a_joint_in_its_band() -> None:
    law = Law(400.0, play=5e-3, rest=-8e-3)
    assert law.loaded(-law.load).rest == -5e-3
    assert replace(law, rest=2e-3).loaded(0.0).rest == 2e-3


def test_of_a_joint_at_its_stop_a_linear_model_has_half_of_its_spring() -> None:
    """As central differences take it, whose one side is in the gap; well beyond the stop it has all of it."""
    for rest, share in ((-1e-3, 0.5), (-3e-3, 1.0), (0.0, 0.0)):
        law = Law.of(JointLaw("wing-left", "bending", STIFFNESS, play_rad=1e-3), rest)
        assert law.modelled == pytest.approx(share * STIFFNESS, rel=1e-6)


def test_joints_carry_what_a_run_weighs_on_them_and_turn_with_where_they_hang() -> None:
    laws = (Law(STIFFNESS, cubic=2e7, rest=2e-3), Law(STIFFNESS, play=1e-3, rest=-3e-3))
    hanging = Hanging(np.array([7, 9]), laws, np.array([[0.0, 0.0], [0.5, -0.25]]))
    first, second = hanging.in_runs()
    assert [law.load for law in first] == pytest.approx([law.load for law in laws], rel=1e-12)
    assert [law.load for law in second] == pytest.approx([laws[0].load + 0.5, laws[1].load - 0.25], rel=1e-9)
    turned = hanging.turned(np.array([1e-3, 0.0]))
    assert turned.laws[0].rest == pytest.approx(3e-3) and turned.laws[1].rest == laws[1].rest
    # A structure is linearised where its joints are.
    assert turned.laws[0].modelled == pytest.approx(STIFFNESS + 3 * 2e7 * 3e-3**2, rel=1e-4)
