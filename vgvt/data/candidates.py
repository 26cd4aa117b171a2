"""What a method considered before it claimed its modes: the poles it found at every model order."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class PoleCandidate:
    """A pole of one model order, whether it stands behind a claimed mode, and why or why not in plain words.

    Poles that share their fate, such as those of one mode over the orders, carry the same ``reason``.
    """

    frequency_hz: float
    damping_ratio: float
    order: int
    kept: bool
    reason: str


@dataclass(frozen=True, slots=True)
class CandidateGroup:
    """Candidates that share their fate; ranges are (least, largest), of damping ratios as of the others."""

    kept: bool
    reason: str
    poles: int
    frequency_hz: tuple[float, float]
    damping_ratio: tuple[float, float]
    order: tuple[int, int]


def grouped_candidates(candidates: tuple[PoleCandidate, ...]) -> tuple[CandidateGroup, ...]:
    """The candidates by fate and reason: the kept ones first, each part in order of frequency."""
    groups: dict[tuple[bool, str], list[PoleCandidate]] = {}
    for candidate in candidates:
        groups.setdefault((candidate.kept, candidate.reason), []).append(candidate)
    rows = [_group(kept, reason, members) for (kept, reason), members in groups.items()]
    return tuple(sorted(rows, key=lambda g: (not g.kept, g.frequency_hz)))


def _group(kept: bool, reason: str, members: list[PoleCandidate]) -> CandidateGroup:
    frequency = [m.frequency_hz for m in members]
    damping = [m.damping_ratio for m in members]
    orders = [m.order for m in members]
    return CandidateGroup(
        kept,
        reason,
        len(members),
        (min(frequency), max(frequency)),
        (min(damping), max(damping)),
        (min(orders), max(orders)),
    )
