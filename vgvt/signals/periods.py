"""Periodic excitation: which whole periods of a record repeat, and their averages without a window."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from vgvt.data import Campaign, FrequencyResponseSet, InputError
from vgvt.signals.usable import UsableRun

PERIODS_NOTE = "periods"
_SETTLED = 1e-4  # of a period's root mean square, by which it may differ from the last
_NO_WORSE = 1.5  # times what the last two differ by, where that is more: noise does not settle
_WHOLE = 1e-3  # of a sample, by which a period may miss a whole number of them


@dataclass(frozen=True, slots=True)
class Periods:
    """What repeats every ``period_s`` from ``begin_s`` to ``end_s`` of a record, None for its end; which harmonics."""

    period_s: float
    begin_s: float = 0.0
    end_s: float | None = None
    lines: Literal["full", "odd"] = "full"

    def __post_init__(self) -> None:
        """ValueError for what are no periods."""
        sound = 0 < self.period_s < float("inf") and 0 <= self.begin_s < float("inf")
        if not sound or (self.end_s is not None and not self.end_s > self.begin_s):
            raise ValueError("period_s must be positive, begin_s not negative, and end_s after it")
        if self.lines not in ("full", "odd"):
            raise ValueError("lines must be 'full' or 'odd'")

    def note(self) -> str:
        """The text of a campaign's note."""
        return json.dumps({k: getattr(self, k) for k in self.__slots__ if getattr(self, k) is not None})


@dataclass(frozen=True, slots=True, eq=False)
class PeriodicPart:
    """The ``count`` last whole periods of a campaign's records, which repeat, and what there is to say of them."""

    campaign: Campaign
    periods: Periods
    count: int
    remark: str

    def harmonics(self, frf: FrequencyResponseSet) -> FrequencyResponseSet:
        """The set without the even harmonics where only odd ones are excited, and with the remark."""
        frf = replace(frf, remarks=(*frf.remarks, self.remark))
        if self.periods.lines == "full":
            return frf
        return frf.lines(np.rint(frf.frequency_hz * self.periods.period_s).astype(int) % 2 == 1)


def periods_of_notes(campaign: Campaign) -> Periods | None:
    """The periods that a campaign's notes tell of, None without any; InputError for a note that cannot be read."""
    if PERIODS_NOTE not in campaign.notes:
        return None
    try:
        note = dict(json.loads(campaign.notes[PERIODS_NOTE]))
        end_s = note.get("end_s")
        return Periods(
            float(note["period_s"]),
            float(note.get("begin_s", 0.0)),
            None if end_s is None else float(end_s),
            note.get("lines", "full"),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"{campaign.name}, note {PERIODS_NOTE!r}",
            f"cannot be read ({error})",
            'write it like {"period_s": 10.0, "begin_s": 0.0, "end_s": 80.0, "lines": "full"}',
        ) from error


def periodic_part(campaign: Campaign, runs: tuple[UsableRun, ...]) -> PeriodicPart | None:
    """The whole periods at the end of the records from where all have settled on.

    A period before that differs from the last one by more than noise makes the last two differ. None without a note
    of periods, where no whole one was recorded, or where one is no whole number of samples.
    """
    periods = periods_of_notes(campaign)
    shapes = {(run.samples, run.sample_rate_hz) for run in runs}
    if periods is None or len(shapes) > 1:
        return None
    samples, rate_hz = shapes.pop()
    length, first = round(periods.period_s * rate_hz), round(periods.begin_s * rate_hz)
    end = samples if periods.end_s is None else min(samples, round(periods.end_s * rate_hz))
    count = (end - first) // length if length > 1 else 0
    if count < 1 or abs(length - periods.period_s * rate_hz) > _WHOLE:
        return None
    settled, change = _settled(runs, end - count * length, length, count)
    kept = slice(end - (count - settled) * length, end)
    records = tuple(
        replace(record, samples=record.samples[:, kept])
        for record in campaign.runs
        if record.run in {r.run for r in runs}
    )
    remark = (
        f"frequency responses are of the last {count - settled} of {count} whole periods of {periods.period_s:g} s, at "
        "harmonics only"
    )
    if np.isfinite(change):
        remark += f"; the last two differ by {100 * change:.2g} %"
    return PeriodicPart(replace(campaign, runs=records), periods, count - settled, remark)


def _settled(runs: tuple[UsableRun, ...], first: int, length: int, count: int) -> tuple[int, float]:
    """How many periods come before all have settled, and by which part of themselves the last two differ."""
    if count < 2:
        return 0, float("nan")
    change = np.zeros(count - 1)
    for run in runs:
        parts = []
        for samples in (*run.reference_samples, *run.response_samples):
            signal = np.asarray(samples[first : first + count * length], dtype=np.float64).reshape(count, length)
            signal = signal - signal.mean(axis=1, keepdims=True)
            power = max(float((signal[-1] ** 2).mean()), float(np.finfo(float).tiny))
            parts.append(((signal[:-1] - signal[-1]) ** 2).mean(axis=1) / power)
        change = np.maximum(change, np.sqrt(np.median(parts, axis=0)))
    late = np.flatnonzero(change > max(_SETTLED, _NO_WORSE * change[-1]))
    return (int(late[-1]) + 1 if late.size else 0), float(change[-1])
