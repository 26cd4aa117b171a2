"""What a test could see of one effect, as a page or a terminal shows it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from vgvt.data.shown import headed


@dataclass(frozen=True, slots=True)
class PowerRow:
    """The smallest size of an effect that could be seen, and the one that gets its name in 95 of 100 campaigns.

    Of the ``variant`` that shows best, of so many ``variants``; ``median`` and ``worst`` are what is just visible at
    others. Infinite is never; what is not a number is not known, and ``reason`` says why. ``alike`` are effects of
    nearly the same signature, ``elsewhere`` variants of its own at other places, each with its cosine.
    """

    effect: str
    variant: str
    parameter: str
    unit: str
    smallest: float
    named: float
    low: float
    high: float
    alike: tuple[tuple[str, float], ...] = ()
    variants: int = 1
    median: float = math.nan
    worst: float = math.nan
    worst_variant: str = ""
    reason: str = ""
    elsewhere: tuple[tuple[str, float], ...] = ()

    @property
    def place(self) -> str:
        """Which of several variants shows best, without the effect's name; nothing where there is one."""
        return self.settings_of(self.variant) if self.variants > 1 else ""

    @property
    def other_places(self) -> tuple[tuple[str, float], ...]:
        """``elsewhere`` without the effect's name."""
        return tuple((self.settings_of(label), cosine) for label, cosine in self.elsewhere)

    def settings_of(self, label: str) -> str:
        """What a variant's label says beside the effect's name."""
        begin = f"{self.effect} ("
        return label.removeprefix(begin).removesuffix(")") if label.startswith(begin) else label

    @property
    def visible(self) -> bool:
        """Whether a plausible size could be seen."""
        return self.smallest <= max(abs(self.low), abs(self.high))

    @property
    def sizes(self) -> tuple[str, str, str]:
        """In words: what is just visible, and named, where it shows best, and just visible where it shows worst."""
        if math.isnan(self.smallest):
            return self.reason.partition(":")[0], "", ""
        worst = _size(self.worst) if self.variants > 1 else ""
        return _size(self.smallest), _size(self.named), worst

    def __repr__(self) -> str:
        words = zip(("just visible", "named from", "at worst"), self.sizes, strict=True)
        # Words that stand for a size have no unit.
        told = [
            f"{name}: {f'{size} {self.unit}'.rstrip() if size[:1].isdigit() else size}" for name, size in words if size
        ]
        plausible = f"plausible {self.low:.4g} to {self.high:.4g} {self.unit}".rstrip()
        return headed(f"PowerRow {self.effect}: {self.parameter}, {', '.join((*told, plausible))}")

    @property
    def shows(self) -> str:
        """Whether a plausible size could be seen: yes, no or unknown."""
        if math.isnan(self.smallest):
            return "unknown"
        return "yes" if self.visible else "no"


def _size(value: float) -> str:
    return "not known" if math.isnan(value) else f"{value:.2g}" if math.isfinite(value) else "never"
