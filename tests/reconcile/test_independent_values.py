"""How many real values a residual is worth, against noise of which that is known."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.reconcile.evidence.residual import independent_values


def white(channels: int, lines: int, seed: int) -> np.ndarray:
    """White complex noise (C, L)."""
    g = np.random.default_rng(seed)
    return np.asarray(g.standard_normal((channels, lines)) + 1j * g.standard_normal((channels, lines)))


@pytest.mark.parametrize(("channels", "lines"), [(20, 160), (60, 500), (200, 200)])
def test_white_noise_is_worth_all_its_values(channels: int, lines: int) -> None:
    found = [independent_values(white(channels, lines, k)) / (2 * channels * lines) for k in range(3)]
    assert np.mean(found) == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize(("channels", "lines"), [(60, 500), (100, 200)])
def test_what_few_things_share_out_among_many_channels_is_worth_little_more_than_they(
    channels: int, lines: int
) -> None:
    """Half of the channels are each the twin of another one: not three quarters of them, as if noise spread twice."""
    found = []
    for k in range(3):
        rho = white(channels, lines, k)
        rho[channels // 2 :] = rho[: channels // 2]
        found.append(independent_values(rho) / (channels * lines))
    assert np.mean(found) == pytest.approx(1.0, abs=0.15)
