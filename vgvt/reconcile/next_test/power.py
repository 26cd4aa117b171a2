"""What a campaign could see at all: the smallest size of each effect beyond the tolerances, and what looks alike.

And how large it has to be to get its name, which is more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from vgvt.data.shown import headed, listed
from vgvt.effects.parameter import Parameter
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.next_test.at_size import Sight, Views, least, size_of
from vgvt.reconcile.next_test.nameable import nameable_ratio, within_reach
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import Thresholds, noise_share, stored_thresholds
from vgvt.reconcile.search.scan import start_values
from vgvt.reconcile.search.stand import Stand
from vgvt.reconcile.work.one_thread import one_thread

_SIGMA = 5.0
_ALIKE = 0.6
# Settings that say where an effect sits, and how many such places are told.
_WHERE = ("x_m", "y_m", "other_x_m", "other_y_m", "side", "item", "node", "channels", "sensors")
_ELSEWHERE = 3
# Times the largest plausible size.
_ABSURD = 1e3


BY_LEVEL, NOT_KNOWN, NEVER = "by level: not foretold", "not known", "never"


@dataclass(frozen=True, slots=True)
class Power:
    """One size parameter of one variant: the smallest size seen at five standard deviations, in ``unit``.

    ``named`` is the size that gets its name in 95 of 100 such campaigns; ``low`` and ``high`` bound what is plausible;
    ``alike`` are effects with a variant, ``alike_variants``, whose signature has a cosine above 0.6 with it, after what
    the unknowns can imitate; ``elsewhere`` are up to three variants of the same effect at another place, side or
    channel that look as alike. Sizes hold ``at`` the defaults of whatever has no neutral value: a frequency, an angle.
    ``smallest`` is infinite for what A/F does not show, and ``named`` for what would have to be absurdly large; either
    is not a number where no size keeps what slopes promise: ``by_level`` as an answer may hang on the level of force.
    """

    effect: str
    label: str
    parameter: str
    unit: str
    smallest: float
    named: float
    low: float
    high: float
    alike: tuple[tuple[str, float], ...]
    by_level: bool = False
    alike_variants: tuple[str, ...] = ()
    at: tuple[tuple[str, float], ...] = ()
    elsewhere: tuple[tuple[str, float], ...] = ()

    def __repr__(self) -> str:
        sizes = (("just visible", self.smallest), ("named from", self.named))
        told = [f"{words}: {f'{v:.2g} {self.unit}'.rstrip() if np.isfinite(v) else self._why(v)}" for words, v in sizes]
        plausible = f"plausible {self.low:.4g} to {self.high:.4g} {self.unit}".rstrip()
        alike = f"; like {listed([f'{name} {cosine:.2f}' for name, cosine in self.alike], 2)}" if self.alike else ""
        return headed(f"Power {self.label}: {self.parameter}, {', '.join((*told, plausible))}{alike}")

    @property
    def visible(self) -> bool:
        """Whether a plausible size could be seen."""
        return self.smallest <= max(abs(self.low), abs(self.high))

    @property
    def reason(self) -> str:
        """Why there is no smallest size; nothing where there is one."""
        return self._why(self.smallest)

    def _why(self, size: float) -> str:
        if np.isfinite(size):
            return ""
        return NEVER if np.isinf(size) else BY_LEVEL if self.by_level else NOT_KNOWN

    def document(self) -> dict[str, object]:
        """Plain values; an infinite size, or one that is not known, is None, and ``reason`` says why of the first."""
        plain = {k: v for k, v in asdict(self).items() if k != "by_level"} | {"at": dict(self.at)}
        sizes = {"smallest": self.smallest, "named": self.named}
        why = self.reason or self._why(self.named)
        return plain | {k: v if np.isfinite(v) else None for k, v in sizes.items()} | {"reason": why}


@one_thread
def power(
    null: Fit,
    hypotheses: Sequence[Hypothesis],
    progress: Callable[[float, str], None] | None = None,
    thresholds: Thresholds | None = None,
) -> tuple[Power, ...]:
    """Detectability and confusability of every variant beside what a fit has: from slopes (5 / |q|), looked at there.

    Of what grows with the square of its size, from the second one. ``thresholds`` (default: those that are shipped)
    say what a name needs.
    """
    share = noise_share(null.problem.measured, null.problem.split.train)
    needed = (thresholds or stored_thresholds()).at(share).evidence_nats
    stand = Stand.of(null)
    sight = Sight.of(stand, share.worth)
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
            smallest = named = float("inf")
            if slope is not None and seen is not None and length > 1e-9:
                grows, at = (1, 1.0) if square is None else (2, square[0])
                smallest, named = _sizes(hypothesis, p, needed, at, grows, sight.views(slope, seen))
                smallest, named = _looked_at(sight, hypothesis, values, p, needed, grows, (smallest, named))
                named = within_reach(hypothesis, p, named, _sign(p))
            if not np.isfinite(smallest):
                seen = None
            rows.append((hypothesis, p, smallest, named))
            signatures.append(None if seen is None or length <= 1e-9 else (seen / length).astype(np.float32))
    found = []
    for k, (h, p, smallest, named) in enumerate(rows):
        alike = _alike(k, rows, signatures)
        names, variants = tuple((name, cosine) for name, cosine, _ in alike), tuple(label for *_, label in alike)
        beside = tuple(start_values(h).items())
        found.append(
            Power(
                h.name, h.label, p.name, p.unit, smallest, named, p.low, p.high, names, not h.linear, variants, beside,
                _elsewhere(k, rows, signatures),
            )
        )  # fmt: skip
    return tuple(found)


def _sign(p: Parameter) -> float:
    """Which way from its neutral value more of a parameter is plausible."""
    neutral = float(p.neutral or 0.0)
    return 1.0 if p.high - neutral >= neutral - p.low else -1.0


def _looked_at(
    sight: Sight,
    hypothesis: Hypothesis,
    values: dict[str, float],
    p: Parameter,
    needed: float,
    grows: int,
    foretold: tuple[float, float],
) -> tuple[float, float]:
    """The sizes that are just visible and that get a name, ``foretold`` by a slope, as the effect shows at them.

    What would have to be larger than plausible is looked at where that ends: if it does not show there it stays what
    was foretold.
    """
    smallest, named = foretold
    neutral, most = float(p.neutral or 0.0), max(abs(p.low), abs(p.high))
    if not np.isfinite(smallest):
        return foretold
    sign = _sign(p)

    def views_at(size: float, promised: float | None = None) -> Views | None:
        return sight.at(hypothesis, {**values, p.name: neutral + sign * size}, p, promised)

    def first_by_slope(size: float) -> Views | None:
        return views_at(size, _SIGMA if size == foretold[0] else None)

    if smallest > most:
        there = views_at(most, _SIGMA * (most / smallest) ** grows)
        if there is None or least(there) < _SIGMA:
            return foretold
    found = size_of(first_by_slope, min(smallest, most), _SIGMA, grows, most)
    if found is None:
        return float("nan"), float("nan")
    if found[0] == smallest:
        return foretold
    smallest, named = found[0], max(found[0], _sizes(hypothesis, p, needed, found[0], grows, found[1])[1])
    if not np.isfinite(named) or named > most:
        return smallest, named
    deviations = least(found[1]) * (named / smallest) ** grows
    more = size_of(views_at, named, deviations, grows)
    return smallest, float("nan") if more is None else more[0]


def _sizes(
    hypothesis: Hypothesis, p: Parameter, needed: float, at: float, grows: int, views: Views
) -> tuple[float, float]:
    """The sizes that are just visible and that get a name, by the view of the data that sees least.

    ``views`` are those of a size ``at``, which are taken to grow with that power of it.
    """
    sizes = []
    for shown, raw in views:
        smallest = float((_SIGMA / shown) ** (1 / grows) * at) if shown > 0 else float("inf")
        if smallest > _ABSURD * max(abs(p.low), abs(p.high)):
            # What leaves A/F alone but for round-off: no score is known of such a size.
            return float("inf"), float("inf")
        more = nameable_ratio(
            hypothesis, p, smallest, deviations=_SIGMA, raw=_SIGMA * raw / shown,
            threshold_nats=needed, power=grows,
        )  # fmt: skip
        sizes.append((smallest, smallest * more))
    return max(s for s, _ in sizes), max(n for _, n in sizes)


def _alike(
    k: int, rows: list[tuple[Hypothesis, Parameter, float, float]], signatures: list[np.ndarray | None]
) -> list[tuple[str, float, str]]:
    """Other effects that look alike, the most alike first, by name, cosine and variant."""
    own = signatures[k]
    if own is None:
        return []
    best: dict[str, tuple[float, str]] = {}
    for (hypothesis, *_), other in zip(rows, signatures, strict=True):
        name = hypothesis.name
        if other is not None and name != rows[k][0].name:
            cosine = abs(float(own @ other))
            if cosine > best.get(name, (_ALIKE, ""))[0]:
                best[name] = cosine, hypothesis.label
    return sorted(((name, cosine, label) for name, (cosine, label) in best.items()), key=lambda found: -found[1])


def _elsewhere(
    k: int, rows: list[tuple[Hypothesis, Parameter, float, float]], signatures: list[np.ndarray | None]
) -> tuple[tuple[str, float], ...]:
    """Where else the same effect looks alike, the most alike first, by variant and cosine: the best one of a place."""
    own, (mine, size, *_) = signatures[k], rows[k]
    if own is None:
        return ()
    here, best = _where(mine), dict[tuple[str, ...], tuple[str, float]]()
    for (hypothesis, p, *_), other in zip(rows, signatures, strict=True):
        if other is None or hypothesis.cls is not mine.cls or p.name != size.name:
            continue
        there = _where(hypothesis)
        if there != here and not _one_in_the_ratio(mine, hypothesis):
            cosine = abs(float(own @ other))
            if cosine > best.get(there, ("", _ALIKE))[1]:
                best[there] = hypothesis.label, cosine
    return tuple(sorted(best.values(), key=lambda found: -found[1])[:_ELSEWHERE])


def _one_in_the_ratio(one: Hypothesis, other: Hypothesis) -> bool:
    """Whether one is of the force and the other of all responses: A/F is a quotient, and knows of one place there."""
    return {one.settings.get("channels"), other.settings.get("channels")} == {"force", "response"}


def _where(hypothesis: Hypothesis) -> tuple[str, ...]:
    """Where a variant sits, by its settings."""
    return tuple(repr(hypothesis.settings.get(name)) for name in _WHERE)
