"""Frequency labels that do not run into each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_LABEL_SHARE = 0.12
"""Width of '19.06' as a share of the axis on a phone; wider pages only have more room."""


def lane_labels(frequency_hz: NDArray[np.float64], band_hz: tuple[float, float]) -> tuple[list[str], list[str]]:
    """Text and plotly position of the label of each marker in a lane, for ascending ``frequency_hz`` (N,).

    A label goes above its marker, below where the one above is taken, and is left out (the marker
    still answers the mouse) where both are.
    """
    room = _LABEL_SHARE * (band_hz[1] - band_hz[0])
    last = {"top center": -np.inf, "bottom center": -np.inf}
    texts, positions = [], []
    for frequency in frequency_hz:
        slot = next((s for s, taken in last.items() if frequency - taken >= room), None)
        texts.append(f"{frequency:.2f}" if slot else "")
        positions.append(slot or "top center")
        if slot:
            last[slot] = frequency
    return texts, positions
