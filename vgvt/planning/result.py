"""What planning came to: the plans in order, the scenario as it is, and whether there is anything to gain."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from vgvt.data.shown import counted, headed
from vgvt.planning.confirmation import Confirmation
from vgvt.planning.proposal import Proposal

LEAST_GAIN = 1.05
"""A plan that knows the worst mode better by less than this factor is not worth changing a test for."""


class Verdict(StrEnum):
    """Whether another plan is better than the scenario as it is."""

    BETTER = "better"
    NOTHING_TO_GAIN = "nothing_to_gain"


@dataclass(frozen=True, slots=True, eq=False)
class PlanningResult:
    """The ``plans``, best first, beside the scenario ``as_described`` and the same with the ``budget`` used up.

    ``confirmed`` holds, by a plan's name, what simulated campaigns say of it.
    """

    as_described: Proposal
    with_budget: Proposal | None
    plans: tuple[Proposal, ...]
    confirmed: dict[str, Confirmation]

    def __repr__(self) -> str:
        plans = [p for p in (self.as_described, self.with_budget, *self.plans) if p is not None]
        head = f"PlanningResult: {counted(len(self.plans), 'plan')}"
        if self.as_described.targets:
            seen = "" if self.confirmed_gain is None else f", {self.confirmed_gain:.3g} times in simulated campaigns"
            factor = f"the worst mode's damping {self.gain:.3g} times as well known{seen}"
            head = f"{head}, {self.verdict.value.replace('_', ' ')}; {factor}"
        return headed(head, [plan.in_words for plan in plans], most=6)

    @property
    def gain(self) -> float:
        """Predicted std(ζ)/ζ of the worst mode as described over that of the best plan."""
        return self._over(self.as_described)

    @property
    def gain_at_equal_means(self) -> float | None:
        """The same against the scenario with all accelerometers at once and all of the time; None without one."""
        return None if self.with_budget is None else self._over(self.with_budget)

    @property
    def confirmed_gain(self) -> float | None:
        """The factor that the simulated campaigns show; None where they were not made."""
        if not self.plans or any(name not in self.confirmed for name in (self.as_described.name, self.plans[0].name)):
            return None
        before, after = (self.confirmed[p.name].worst_relative_damping_std for p in (self.as_described, self.plans[0]))
        return before / after if after > 0 else None

    @property
    def confirmed_gain_relative_error(self) -> float | None:
        """Relative standard error of that factor: two scatters, each known from so many seeds."""
        if self.confirmed_gain is None:
            return None
        errors = [self.confirmed[p.name].own_error for p in (self.as_described, self.plans[0])]
        return math.hypot(*errors)

    @property
    def contradicted(self) -> bool:
        """Whether simulated campaigns do not bear a plan out, beyond their own error."""
        seen, error = self.confirmed_gain, self.confirmed_gain_relative_error
        # NaN: the modes were missed more often than not in both, which bears nothing out.
        return seen is not None and error is not None and not seen * (1 + 2 * error) >= 1

    @property
    def verdict(self) -> Verdict:
        """Better only where the prediction says so and no simulation contradicts it beyond its own error."""
        better = self.gain >= LEAST_GAIN and not self.contradicted
        return Verdict.BETTER if better else Verdict.NOTHING_TO_GAIN

    def as_dict(self) -> dict[str, Any]:
        """The result with the keys of the JSON contract."""
        return {
            "verdict": self.verdict,
            "gain": self.gain,
            "gain_at_equal_means": self.gain_at_equal_means,
            "confirmed_gain": self.confirmed_gain,
            "confirmed_gain_relative_error": self.confirmed_gain_relative_error,
            "as_described": self._with_confirmation(self.as_described),
            "with_budget": None if self.with_budget is None else self._with_confirmation(self.with_budget),
            "plans": [self._with_confirmation(plan) for plan in self.plans],
        }

    def _over(self, other: Proposal) -> float:
        return other.worst_relative_damping_std / self.plans[0].worst_relative_damping_std if self.plans else 1.0

    def _with_confirmation(self, plan: Proposal) -> dict[str, Any]:
        seen = self.confirmed.get(plan.name)
        return {**plan.as_dict(), "confirmed": None if seen is None else seen.as_dict()}
