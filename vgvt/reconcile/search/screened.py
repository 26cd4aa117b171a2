"""A variant as a screen sees it: values to start a fit from, and what it could buy."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data.shown import headed
from vgvt.reconcile.question.hypothesis import Hypothesis

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Screened:
    """A variant with the values to start a fit from, and the nats it could buy at best: half the drop of χ².

    ``remaining`` is the χ² that it would leave, ``start`` (scores,) those of the stand that it was screened at: of the
    unknowns and of the effects that are there already. ``tuned`` names the parameter that was scanned, as it moves a
    resonance: with a part of it the resonance is elsewhere, so it is no size. What has ``arrived`` is at the bottom of
    a fit already: coarse steps would lead away. What is ``upright`` was seen from a calibration that may not bend
    (:mod:`vgvt.reconcile.search.upright`), and is too small for coarse steps to tell. What is ``foremost`` came first
    by the data's own errors: where it is as narrow as a surge, coarse steps do not tell it either.
    """

    hypothesis: Hypothesis
    values: dict[str, float]
    gain_nats: float
    visible: bool = True
    remaining: float = math.inf
    start: Array | None = None
    tuned: str = ""
    arrived: bool = False
    upright: bool = False
    foremost: bool = False

    def __repr__(self) -> str:
        values = ", ".join(f"{name} = {value:.4g}" for name, value in self.values.items())
        start = f", from {values}" if values else ""
        return headed(f"Screened {self.hypothesis.label}: {self.gain_nats:.1f} nats at best{start}")

    @property
    def sizes(self) -> dict[str, float]:
        """Neutral values of what an effect can have a part of, by name."""
        mine = (p for p in self.hypothesis.parameters if p.name in self.values and p.name != self.tuned)
        return {p.name: float(p.neutral) for p in mine if p.neutral is not None}


def parted(s: Screened, share: float) -> dict[str, float]:
    """Values of a variant with a share of its sizes."""
    return {**s.values, **{k: n + share * (s.values[k] - n) for k, n in s.sizes.items()}}
