"""A scorecard: one identifier's claim against the truth of one scenario, one row per mode."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from vgvt.data.modal import Outcome
from vgvt.data.mode_numbers import SCORE_NUMBERS, score_numbers, score_table
from vgvt.data.shown import headed
from vgvt.data.truth import TrueModes

_TWO_SIDED_95_PERCENT = 1.959963984540054


class ModeStatus(StrEnum):
    """What became of a mode; ``unreached`` modes are listed apart and never count as missed."""

    FOUND = "found"
    MISSED = "missed"
    FALSE = "false"
    UNREACHED = "unreached"


@dataclass(frozen=True, slots=True)
class ModeScore:
    """One row: a true mode, a claimed mode or, when found, both.

    The side that is missing is None. ``true_spread_hz`` is the standard
    deviation of the true frequency over the runs of the campaign (roving
    sensors move it). ``frequency_bound_hz`` is the Cramér–Rao bound of the campaign, the least
    standard deviation that an unbiased method can have; the bound of the damping ratio is about that
    over the frequency. ``scaling_error_percent`` compares the size of the residues, and so the
    modal scaling, where both sides state them. ``reachable`` is False for a true mode that the excitation
    leaves invisible at the measured DOFs, ``in_band`` for one outside the band
    asked for. ``true_index`` and ``claimed_index`` count modes in the two
    models, from 0. ``as_tested_hz`` and ``as_tested_damping_ratio`` are those of the mode without the shaker, where the
    claim is judged by the modes with it. ``remark`` says in words what the numbers cannot.
    """

    status: ModeStatus
    true_hz: float | None = None
    claimed_hz: float | None = None
    true_damping_ratio: float | None = None
    claimed_damping_ratio: float | None = None
    mac: float | None = None
    claimed_std_hz: float | None = None
    claimed_damping_ratio_std: float | None = None
    true_spread_hz: float | None = None
    frequency_bound_hz: float | None = None
    scaling_error_percent: float | None = None
    label: str = ""
    reachable: bool = True
    in_band: bool = True
    true_index: int | None = None
    claimed_index: int | None = None
    as_tested_hz: float | None = None
    as_tested_damping_ratio: float | None = None
    remark: str = ""

    def __post_init__(self) -> None:
        needs_truth = self.status is not ModeStatus.FALSE
        needs_claim = self.status in (ModeStatus.FOUND, ModeStatus.FALSE)
        if (self.true_hz is not None) != needs_truth or (self.claimed_hz is not None) != needs_claim:
            raise ValueError(f"a {self.status.value} row has true_hz={self.true_hz} and claimed_hz={self.claimed_hz}")

    def __repr__(self) -> str:
        told = [f"{name} {number}" for name, number in zip(SCORE_NUMBERS, score_numbers(self), strict=True) if number]
        return headed(f"ModeScore: {', '.join(filter(None, (self.status.value, *told, self.label)))}")

    @property
    def frequency_error_percent(self) -> float | None:
        """100 (claimed - true) / true; None unless found."""
        return _error_percent(self.claimed_hz, self.true_hz)

    @property
    def damping_error_percent(self) -> float | None:
        """100 (claimed - true) / true of the damping ratio; None unless found and both are stated."""
        return _error_percent(self.claimed_damping_ratio, self.true_damping_ratio)

    @property
    def frequency_efficiency(self) -> float | None:
        """Cramér–Rao bound over the absolute error of the frequency; of many seeds, average the squares first."""
        if self.frequency_bound_hz is None or self.claimed_hz is None or self.true_hz is None:
            return None
        error = abs(self.claimed_hz - self.true_hz)
        return self.frequency_bound_hz / error if error > 0 else None

    @property
    def frequency_covered(self) -> bool | None:
        """Whether the stated 95 % interval, ±1.96 standard deviations, holds the truth; None when none is stated."""
        return _covered(self.claimed_hz, self.claimed_std_hz, self.true_hz)

    @property
    def damping_covered(self) -> bool | None:
        """The same for the damping ratio."""
        return _covered(self.claimed_damping_ratio, self.claimed_damping_ratio_std, self.true_damping_ratio)

    def as_dict(self) -> dict[str, Any]:
        """The row with the keys of the JSON contract; what is not known is None."""
        return {
            "status": self.status.value,
            "label": self.label,
            "true_hz": self.true_hz,
            "claimed_hz": self.claimed_hz,
            "frequency_error_percent": self.frequency_error_percent,
            "frequency_std_hz": self.claimed_std_hz,
            "frequency_covered": self.frequency_covered,
            "frequency_bound_hz": self.frequency_bound_hz,
            "frequency_efficiency": self.frequency_efficiency,
            "true_spread_hz": self.true_spread_hz,
            "true_damping_ratio": self.true_damping_ratio,
            "claimed_damping_ratio": self.claimed_damping_ratio,
            "damping_error_percent": self.damping_error_percent,
            "damping_ratio_std": self.claimed_damping_ratio_std,
            "damping_covered": self.damping_covered,
            "mac": self.mac,
            "scaling_error_percent": self.scaling_error_percent,
            "reachable": self.reachable,
            "in_band": self.in_band,
            "true_index": self.true_index,
            "claimed_index": self.claimed_index,
            "as_tested_hz": self.as_tested_hz,
            "as_tested_damping_ratio": self.as_tested_damping_ratio,
            "remark": self.remark,
        }


@dataclass(frozen=True, slots=True)
class Scorecard:
    """The rows of one identifier on one scenario, in order of frequency.

    ``modes`` holds found, missed and false rows; ``unreached`` the true modes
    in the band that nobody could see from this drive point and did not claim. ``true_modes`` says which of the truth's
    modes the claim was judged by, ``remarks`` what to know about that; ``advice`` is the claim's own.
    """

    identifier: str
    scenario: str
    band_hz: tuple[float, float]
    modes: tuple[ModeScore, ...]
    unreached: tuple[ModeScore, ...] = ()
    outcome: Outcome = Outcome.FOUND
    advice: tuple[str, ...] = ()
    true_modes: TrueModes = TrueModes.AS_TESTED
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if any(row.status is ModeStatus.UNREACHED for row in self.modes):
            raise ValueError("unreached rows belong in the field unreached")
        if any(row.status is not ModeStatus.UNREACHED for row in self.unreached):
            raise ValueError("only unreached rows belong in the field unreached")

    def __repr__(self) -> str:
        unreached = f", {len(self.unreached)} unreached" if self.unreached else ""
        counts = f"{self.found} found, {self.missed} missed, {self.false} false{unreached}"
        band = f"{self.band_hz[0]:g} to {self.band_hz[1]:g} Hz"
        head = headed(f"Scorecard of {self.identifier} on {self.scenario}: {counts}; {band}", self.advice, most=2)
        rows = (*self.modes, *self.unreached)
        return f"{head}\n{score_table(rows)}" if rows else head

    def rows(self, status: ModeStatus) -> tuple[ModeScore, ...]:
        """The rows of one status."""
        return tuple(row for row in (*self.modes, *self.unreached) if row.status is status)

    @property
    def found(self) -> int:
        """How many true modes were found."""
        return len(self.rows(ModeStatus.FOUND))

    @property
    def missed(self) -> int:
        """How many reachable true modes in the band were not claimed."""
        return len(self.rows(ModeStatus.MISSED))

    @property
    def false(self) -> int:
        """How many claims belong to no true mode."""
        return len(self.rows(ModeStatus.FALSE))

    def summary(self) -> dict[str, float | int | None]:
        """The card in a few numbers; a mean or maximum over nothing is None.

        Coverage is the share of stated 95 % intervals that hold the truth.
        """
        found = self.rows(ModeStatus.FOUND)
        frequency = [abs(r.frequency_error_percent) for r in found if r.frequency_error_percent is not None]
        damping = [abs(r.damping_error_percent) for r in found if r.damping_error_percent is not None]
        mac = [r.mac for r in found if r.mac is not None]
        scaling = [abs(r.scaling_error_percent) for r in found if r.scaling_error_percent is not None]
        return {
            "true_modes": sum(r.in_band for r in found) + self.missed,
            "found": self.found,
            "missed": self.missed,
            "false": self.false,
            "unreached": len(self.unreached),
            "mean_abs_frequency_error_percent": _mean(frequency),
            "max_abs_frequency_error_percent": max(frequency, default=None),
            "mean_abs_damping_error_percent": _mean(damping),
            "max_abs_damping_error_percent": max(damping, default=None),
            "mean_mac": _mean(mac),
            "min_mac": min(mac, default=None),
            "max_abs_scaling_error_percent": max(scaling, default=None),
            "frequency_coverage": _mean([r.frequency_covered for r in found if r.frequency_covered is not None]),
            "damping_coverage": _mean([r.damping_covered for r in found if r.damping_covered is not None]),
        }

    def as_dict(self) -> dict[str, Any]:
        """The card with the keys of the JSON contract, plain types only."""
        return {
            "identifier": self.identifier,
            "scenario": self.scenario,
            "band_hz": list(self.band_hz),
            "outcome": self.outcome.value,
            "true_modes": self.true_modes.value,
            "modes": [row.as_dict() for row in self.modes],
            "missed": self.missed,
            "false": self.false,
            "unreached": [row.as_dict() for row in self.unreached],
            "summary": self.summary(),
            "advice": list(self.advice),
            "remarks": list(self.remarks),
        }


def _error_percent(claimed: float | None, true: float | None) -> float | None:
    if claimed is None or true is None or true == 0:
        return None
    return 100 * (claimed - true) / true


def _covered(claimed: float | None, std: float | None, true: float | None) -> bool | None:
    if claimed is None or std is None or true is None:
        return None
    return abs(claimed - true) <= _TWO_SIDED_95_PERCENT * std


def _mean(values: list[float] | list[bool]) -> float | None:
    return float(np.mean(values)) if values else None
