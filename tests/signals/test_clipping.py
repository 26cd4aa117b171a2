"""Flat tops are seen as clipping, smooth tops and coarse steps are not."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.signals import impact_train, stepped_sine
from vgvt.signals.clipping import clipped_share
from vgvt.signals.usable import doubt_of, fault_of

TIME_S = np.arange(40000) / 1000.0
SIGNALS = {
    "sweep": np.sin(2 * np.pi * (TIME_S + 0.3 * TIME_S**2)),
    "sine": np.sin(2 * np.pi * 5 * TIME_S),
    "noise": np.random.default_rng(0).standard_normal(TIME_S.size),
}


@pytest.mark.parametrize("step", [0.0, 1e-6, 1e-3, 1e-2])
@pytest.mark.parametrize("name", SIGNALS)
def test_sound_signals_are_not_clipped_however_coarse_their_steps(name: str, step: float) -> None:
    x = SIGNALS[name]
    assert clipped_share(np.round(x / step) * step if step else x) == 0


@pytest.mark.parametrize("step", [0.0, 1e-6, 1e-3])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_hammer_at_rest_between_its_hits_is_not_clipped(step: float, sign: float) -> None:
    force = sign * impact_train(TIME_S, np.random.default_rng(2), 40, 1.0, 0.1, 0.012, strength_scatter=0.1)
    assert clipped_share(np.round(force / step) * step if step else force) == 0
    # Hits that overdrive the gauge still are: a third of each hit lies on the flat top.
    assert clipped_share(np.clip(force, -0.6, 0.6)) > 0


def test_dwells_whose_sines_touch_the_same_top_are_not_clipped() -> None:
    """Ten sines of one amplitude, periods of whole samples: each touches 1.0 once a cycle."""
    assert clipped_share(stepped_sine(TIME_S, 5.0, 50.0, 40.0, 10, 0.1)) == 0


@pytest.mark.parametrize("step", [0.0, 1e-6, 1e-3])
@pytest.mark.parametrize("name", ["sweep", "noise"])
def test_the_share_of_clipped_samples_is_counted_exactly(name: str, step: float) -> None:
    x = SIGNALS[name]
    x = np.round(x / step) * step if step else x
    limit = float(np.quantile(np.abs(x), 0.9))
    assert clipped_share(np.clip(x, -limit, limit)) == pytest.approx(float((np.abs(x) >= limit).mean()), rel=1e-9)


def test_one_side_is_enough() -> None:
    x = np.minimum(SIGNALS["noise"], 1.5)
    assert clipped_share(x) == pytest.approx(float((SIGNALS["noise"] >= 1.5).mean()))


def test_much_clipping_is_a_fault_and_little_a_remark() -> None:
    noise = SIGNALS["noise"]
    assert "saturated" in str(fault_of(np.clip(noise, -2, 2), 1000.0))
    little = np.clip(noise, -3.2, 3.2)
    assert fault_of(little, 1000.0) is None
    assert "clipped" in str(doubt_of(little))
    assert doubt_of(noise) is None
