"""The confirmation of a plan: its campaign simulated with many seeds and identified, and how the claims scatter."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data.shown import counted, headed
from vgvt.identification import make_identifier, run_identifier
from vgvt.planning.informed import INFORMED, estimates
from vgvt.planning.lighter import lighter
from vgvt.planning.pairing import paired
from vgvt.planning.proposal import Proposal
from vgvt.scenario.streams import named_stream
from vgvt.simulation.campaign import simulate

Progress = Callable[[float, str], None]

_NEAR = 0.03


@dataclass(frozen=True, slots=True, eq=False)
class Confirmation:
    """Claims of ``seeds`` simulated campaigns for the target modes: frequencies and damping ratios (seeds, M).

    NaN where a campaign's claim has no mode within 3 % of the frequency, or none that is not another target's.
    """

    identifier: str
    frequency_hz: NDArray[np.float64]
    damping_ratio: NDArray[np.float64]

    def __repr__(self) -> str:
        found = ", ".join(f"{count}" for count in self.found)
        worst = self.worst_relative_damping_std if self.found.size else np.inf
        known = f"std(ζ)/ζ of the worst mode {100 * worst:.2g} %" if np.isfinite(worst) else ""
        head = f"Confirmation by {self.identifier}: {counted(self.seeds, 'campaign')}"
        return headed("; ".join(filter(None, (head, found and f"modes found in {found}", known))))

    @property
    def seeds(self) -> int:
        """How many campaigns were simulated."""
        return int(self.frequency_hz.shape[0])

    @property
    def found(self) -> NDArray[np.intp]:
        """In how many campaigns each mode was claimed, (M,)."""
        return np.asarray(np.isfinite(self.frequency_hz).sum(axis=0))

    @property
    def frequency_std_hz(self) -> NDArray[np.float64]:
        """Scatter of the claimed frequencies over the seeds, (M,); NaN for fewer than two claims."""
        return _scatter(self.frequency_hz)

    @property
    def damping_ratio_std(self) -> NDArray[np.float64]:
        """Scatter of the claimed damping ratios over the seeds, (M,); NaN for fewer than two claims."""
        return _scatter(self.damping_ratio)

    @property
    def worst_relative_damping_std(self) -> float:
        """std(ζ)/ζ of the worst mode as it was found; infinite where a mode was missed more often than not."""
        if (self.found < max(2, math.ceil(self.seeds / 2))).any():
            return float("inf")
        return float((self.damping_ratio_std / np.nanmean(self.damping_ratio, axis=0)).max())

    @property
    def own_error(self) -> float:
        """Relative standard error of a scatter from so many seeds, 1/√(2 (n - 1))."""
        return 1 / math.sqrt(2 * (self.seeds - 1)) if self.seeds > 1 else float("inf")

    def as_dict(self) -> dict[str, Any]:
        """The confirmation with the keys of the JSON contract."""
        return {
            "identifier": self.identifier,
            "seeds": self.seeds,
            "found": self.found,
            "frequency_std_hz": self.frequency_std_hz,
            "damping_ratio_std": self.damping_ratio_std,
            "worst_relative_damping_std": self.worst_relative_damping_std,
            "own_relative_error": self.own_error,
        }


def confirm(plan: Proposal, identifier: str, seeds: int, progress: Progress | None = None) -> Confirmation:
    """Simulate a plan with the linear engine and identify it, ``seeds`` times with seeds of their own.

    By a registered method, or by the fit that is told the noise (``INFORMED``).
    """
    rows = []
    for k, row in enumerate(claims(plan, identifier, range(seeds))):
        rows.append(row)
        if progress is not None:
            progress((k + 1) / seeds, f"{plan.name}, campaign {k + 1} of {seeds}")
    table = np.array(rows)
    return Confirmation(identifier, table[:, 0], table[:, 1])


def claims(plan: Proposal, identifier: str, numbers: Iterable[int]) -> Iterator[NDArray[np.float64]]:
    """The claimed frequencies and damping ratios of the targets, (2, M), of the campaigns with these numbers."""
    light = lighter(plan.scenario)
    if identifier == INFORMED:
        for frequency_hz, damping_ratio in estimates(light, numbers):
            yield _of_targets(plan, frequency_hz, damping_ratio)
        return
    method = make_identifier(identifier)
    for k in numbers:
        seed = int(named_stream(plan.scenario.seed, "plan", k).integers(2**31))
        campaign = simulate(light.model_copy(update={"seed": seed}), engine="linear").campaign
        claim = run_identifier(method, campaign)
        yield _of_targets(plan, claim.natural_frequency_hz, claim.damping_ratio)


def _of_targets(
    plan: Proposal, frequency_hz: NDArray[np.float64], damping_ratio: NDArray[np.float64]
) -> NDArray[np.float64]:
    found = np.full((2, len(plan.modes)), np.nan)
    pairs = paired([mode.frequency_hz for mode in plan.modes], frequency_hz, _NEAR)
    for k, claim in enumerate(pairs):
        if claim is not None:
            found[:, k] = frequency_hz[claim], damping_ratio[claim]
    return found


def _scatter(values: NDArray[np.float64]) -> NDArray[np.float64]:
    known = np.isfinite(values)
    count = known.sum(axis=0)
    mean = np.divide(np.where(known, values, 0.0).sum(axis=0), count, out=np.zeros(count.shape), where=count > 0)
    squares = (np.where(known, values - mean, 0.0) ** 2).sum(axis=0)
    variance = np.divide(squares, count - 1, out=np.full(count.shape, np.nan), where=count > 1)
    return np.asarray(np.sqrt(variance))
