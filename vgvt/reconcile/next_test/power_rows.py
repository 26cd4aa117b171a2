"""Detectability by effect and parameter: at the variant that shows best, and how far the others are from that."""

from __future__ import annotations

import math
from collections.abc import Iterable
from statistics import median_high

from vgvt.reconcile.next_test.power import Power
from vgvt.view.power_account import PowerRow


def power_rows(power: Iterable[Power]) -> tuple[PowerRow, ...]:
    """A row for each effect's parameter, those that show first.

    Of its variants (places, sides, channels) the row is of the one that shows at the smallest size, and says what is
    just visible at the median and the worst of them. Where one is known, those that are not do not count. It is hard to
    tell from what any of its variants is hard to tell from; ``elsewhere`` is where else it could be by all that the one
    that shows best does.
    """
    variants: dict[tuple[str, str], list[Power]] = {}
    for p in power:
        variants.setdefault((p.effect, p.parameter), []).append(p)
    rows = [_row(found) for found in variants.values()]
    return tuple(sorted(rows, key=lambda r: (not r.visible, r.effect, r.parameter)))


def _row(variants: list[Power]) -> PowerRow:
    ranked = sorted((p for p in variants if not math.isnan(p.smallest)), key=lambda p: p.smallest)
    if not any(math.isfinite(p.smallest) for p in ranked) and len(ranked) < len(variants):
        ranked = [p for p in variants if math.isnan(p.smallest)]
    best, worst = ranked[0], ranked[-1]
    return PowerRow(
        best.effect,
        best.label,
        best.parameter,
        best.unit,
        best.smallest,
        best.named,
        best.low,
        best.high,
        _alike(variants),
        variants=len(variants),
        median=median_high(p.smallest for p in ranked),
        worst=worst.smallest,
        worst_variant=worst.label,
        reason=best.reason,
        elsewhere=best.elsewhere,
    )


def _alike(variants: list[Power]) -> tuple[tuple[str, float], ...]:
    """What any of them is hard to tell from, the most alike first."""
    best: dict[str, float] = {}
    for name, cosine in (pair for p in variants for pair in p.alike):
        best[name] = max(best.get(name, 0.0), cosine)
    return tuple(sorted(best.items(), key=lambda pair: -pair[1]))


def invisible(rows: Iterable[PowerRow]) -> list[str]:
    """Effects that no plausible size of any parameter shows; one of which that is not known is not among them."""
    rows = tuple(rows)
    return sorted({r.effect for r in rows} - {r.effect for r in rows if r.shows != "no"})


def confusable(power: Iterable[Power]) -> list[dict[str, object]]:
    """Pairs of effects of nearly the same signature, each once, the most alike first, and which variants they are."""
    found: dict[tuple[str, str], tuple[float, tuple[str, str]]] = {}
    for p in power:
        for (name, cosine), other in zip(p.alike, p.alike_variants, strict=True):
            pair = (min(p.effect, name), max(p.effect, name))
            if cosine > found.get(pair, (0.0, ("", "")))[0]:
                labels = (p.label, other) if p.effect == pair[0] else (other, p.label)
                found[pair] = cosine, labels
    ranked = sorted(found.items(), key=lambda item: -item[1][0])
    return [{"effects": list(pair), "variants": list(labels), "cosine": cosine} for pair, (cosine, labels) in ranked]
