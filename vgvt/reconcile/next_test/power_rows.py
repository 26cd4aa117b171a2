"""Detectability by effect and parameter: at the variant that shows best, and how far the others are from that."""

from __future__ import annotations

import math
from collections.abc import Iterable
from statistics import median_high

from vgvt.reconcile.next_test.power import Power
from vgvt.view.reconcile_account import PowerRow


def power_rows(power: Iterable[Power]) -> tuple[PowerRow, ...]:
    """A row for each effect's parameter, those that show first.

    Of its variants (places, sides, channels) the row is of the one that shows at the smallest size, and says what is
    just visible at the median and the worst of them. Where one is known, those that are not do not count.
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
        best.alike,
        variants=len(variants),
        median=median_high(p.smallest for p in ranked),
        worst=worst.smallest,
        worst_variant=worst.label,
        reason=best.reason,
    )
