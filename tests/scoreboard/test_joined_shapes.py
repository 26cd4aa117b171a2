"""Shapes that roving runs cannot be joined to: the pole alone counts."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt_scoreboard import merge_truth, score


def test_a_mode_driven_on_its_node_line_cannot_be_joined(model, sealed) -> None:
    """Participations 1 and -1: pieces cancel as often as they agree; 1 and 2: 1 / (1 + 1/9)."""
    shapes = np.array([[1.0, 2.0, 3.0, 1.0]])

    def run(participation: float):
        moved = shapes.copy()
        moved[0, 3] = participation
        return model([8.0], [0.01], moved, drive=3)

    for second, wanted in ((-1.0, 0.0), (1.0, 1.0), (2.0, 1 / (1 + 1 / 9))):
        merged = merge_truth(sealed(run(1.0), run(second)))
        assert merged.joined_mac[0] == pytest.approx(wanted, abs=1e-9)


def test_without_a_shape_to_know_the_pole_alone_counts(model, sealed) -> None:
    shapes = np.array([[1.0, 2.0, 3.0, 1.0]])
    opposite = shapes.copy()
    opposite[0, 3] = -1.0
    truth = sealed(model([8.0], [0.01], shapes, drive=3), model([8.0], [0.01], opposite, drive=3))
    pieces = np.array([[1.0, 2.0, -3.0, -1.0]])
    card = score(truth, model([8.01], [0.01], pieces), (3.0, 35.0))
    assert (card.found, card.missed, card.false) == (1, 0, 0)
    assert "join its shape" in card.modes[0].remark
    silent = score(truth, model([30.0], [0.01], pieces), (3.0, 25.0))
    assert (silent.found, silent.missed, len(silent.unreached)) == (0, 0, 1)
