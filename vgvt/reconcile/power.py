"""What a campaign could see at all: the smallest size of each effect beyond the tolerances, and what looks alike."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from vgvt.effects.parameter import Parameter
from vgvt.reconcile.fit import Fit
from vgvt.reconcile.hypothesis import Hypothesis
from vgvt.reconcile.scan import start_values
from vgvt.reconcile.stand import Stand
from vgvt.reconcile.thresholds import noise_share

_SIGMA = 5.0
_ALIKE = 0.6


@dataclass(frozen=True, slots=True)
class Power:
    """One size parameter of one variant: the smallest size seen at five standard deviations, in ``unit``.

    ``low`` and ``high`` bound what is plausible; ``alike`` are variants whose signature, after what the unknowns
    can imitate, has a cosine above 0.6 with it. ``smallest`` is infinite for what A/F does not show.
    """

    effect: str
    label: str
    parameter: str
    unit: str
    smallest: float
    low: float
    high: float
    alike: tuple[tuple[str, float], ...]

    @property
    def visible(self) -> bool:
        """Whether a plausible size could be seen."""
        return self.smallest <= max(abs(self.low), abs(self.high))

    def document(self) -> dict[str, object]:
        """Plain values; an infinite size is None."""
        return asdict(self) | {"smallest": self.smallest if np.isfinite(self.smallest) else None}


def power(
    null: Fit, hypotheses: Sequence[Hypothesis], progress: Callable[[float, str], None] | None = None
) -> tuple[Power, ...]:
    """Detectability and confusability of every variant around a fit, from derivatives alone (5 / |q|).

    Of what grows with the square of its size, from the second one.
    """
    stand = Stand.of(null)
    worth = np.sqrt(noise_share(null.problem.measured, null.problem.split.train).worth)
    rows, signatures = [], []
    for k, hypothesis in enumerate(hypotheses):
        if progress is not None:
            progress(k / len(hypotheses), f"power {hypothesis.name}")
        switches = [p for p in hypothesis.parameters if p.neutral is not None]
        neutral = {p.name: float(p.neutral) for p in switches if p.neutral is not None}
        for p in switches:
            values = {**start_values(hypothesis), **neutral}
            square = stand.squared(hypothesis, values, p)
            slope = stand.slope(hypothesis, values, p) if square is None else square[1]
            seen = None if slope is None else stand.projected(slope)
            length = 0.0 if seen is None else float(np.linalg.norm(seen))
            smallest = _SIGMA / (worth * length) if length > 1e-9 else float("inf")
            rows.append((hypothesis, p, smallest if square is None else square[0] * smallest**0.5))
            signatures.append(None if seen is None or length <= 1e-9 else (seen / length).astype(np.float32))
    return tuple(
        Power(h.name, h.label, p.name, p.unit, smallest, p.low, p.high, _alike(k, rows, signatures))
        for k, (h, p, smallest) in enumerate(rows)
    )


def _alike(
    k: int, rows: list[tuple[Hypothesis, Parameter, float]], signatures: list[np.ndarray | None]
) -> tuple[tuple[str, float], ...]:
    own = signatures[k]
    if own is None:
        return ()
    best: dict[str, float] = {}
    for j, other in enumerate(signatures):
        name = rows[j][0].name
        if other is not None and name != rows[k][0].name:
            best[name] = max(best.get(name, 0.0), abs(float(own @ other)))
    found = [(name, cosine) for name, cosine in best.items() if cosine > _ALIKE]
    return tuple(sorted(found, key=lambda pair: -pair[1]))
