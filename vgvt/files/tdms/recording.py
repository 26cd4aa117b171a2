"""What of a run in a TDMS file was recorded together: time histories of one length and rate, and their time axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.files.describe.guesses import rate_in_few_digits_hz
from vgvt.files.tdms.grouping import GroupedRun
from vgvt.files.tdms.read import Kind, TdmsChannel, read_kinds, read_samples
from vgvt.files.tdms.timing import check_rate, check_starts, increment_s
from vgvt.files.time_axis import RATE_TOLERANCE, check_time_axis
from vgvt.files.unit_labels import unit_of_label

_STATED_WITHIN = 1e-7  # of an increment, which may have been written as a single
_RESOLUTION_S = 1e-6  # of moments, as programs write them
_NAMES_OF_TIME = ("time", "t")
_SECONDS = ("s", "sec", "seconds")


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """The channels of one run that vgvt can take together, and what was left out and why."""

    run: GroupedRun
    channels: tuple[TdmsChannel, ...]
    time: TdmsChannel | None
    """The channel that holds their time axis."""
    sample_rate_hz: float | None
    """None where neither increments nor a time axis state it."""
    remarks: tuple[str, ...]

    @property
    def samples(self) -> int:
        """Of every channel."""
        return self.channels[0].samples

    @property
    def groups(self) -> tuple[str, ...]:
        """Of its channels, in order of appearance."""
        return tuple(dict.fromkeys(channel.group for channel in self.channels))


def recording_of(run: GroupedRun) -> Recording:
    """What of a run was recorded together: what most channels of a known quantity have in common.

    InputError where it holds no time history, or a file is damaged.
    """
    histories, times, remarks = _sorted(run)
    if not histories:
        raise InputError(
            str(run.file.path),
            "\n  ".join(["holds no time history", *remarks]),
            "give another file, or export it again",
        )
    samples, increment = _main_shape(histories)
    kept = tuple(c for c, own in histories if c.samples == samples and _alike(own, increment))
    remarks += [
        f"left out {c.path}: it has {_shape(c.samples, own)}, and the others {_shape(samples, increment)}"
        for c, own in histories
        if c not in kept
    ]
    rate_hz = None if increment is None else rate_in_few_digits_hz(increment, _STATED_WITHIN * increment)
    time, rate_hz, words = _time_axis(run, times, samples, rate_hz)
    if rate_hz is not None:
        words += _contradictions(run, kept, rate_hz)
    return Recording(run, kept, time, rate_hz, (*remarks, *words))


def _sorted(run: GroupedRun) -> tuple[list[tuple[TdmsChannel, float | None]], list[TdmsChannel], list[str]]:
    """Time histories with their increments (s), time axes, and words on what is neither."""
    histories: list[tuple[TdmsChannel, float | None]] = []
    times: list[TdmsChannel] = []
    remarks: list[str] = []
    for channel, kind in zip(run.channels, read_kinds(run.file.path, run.channels), strict=True):
        if _is_time(channel, kind):
            times.append(channel)
        elif kind == "others":
            remarks.append(f"left out {channel.path}: it holds no real numbers")
        elif not channel.samples:
            remarks.append(f"left out {channel.path}: it has no samples")
        else:
            try:
                increment = increment_s(channel, channel.path)
            except InputError as error:
                remarks.append(f"left out {channel.path}: {error.problem}")
                continue
            histories.append((channel, increment if increment and increment > 0 else None))
    return histories, times, remarks


def _is_time(channel: TdmsChannel, kind: Kind) -> bool:
    """Moments, and numbers of seconds; without a unit the name tells."""
    if kind != "numbers":
        return kind == "times"
    return channel.unit in _SECONDS or (not channel.unit and channel.name.strip().lower() in _NAMES_OF_TIME)


def _main_shape(histories: Sequence[tuple[TdmsChannel, float | None]]) -> tuple[int, float | None]:
    """Length and increment of most channels whose unit says what they measure; of most at all where that is even."""
    shapes = list(dict.fromkeys((channel.samples, increment) for channel, increment in histories))

    def members(shape: tuple[int, float | None]) -> tuple[int, int, bool]:
        own = [c for c, increment in histories if c.samples == shape[0] and _alike(increment, shape[1])]
        return sum(unit_of_label(c.unit) is not None for c in own), len(own), shape[1] is not None

    return max(shapes, key=members)


def _alike(increment: float | None, other: float | None) -> bool:
    """True where two increments are one, or one is not stated."""
    return increment is None or other is None or abs(increment / other - 1) <= RATE_TOLERANCE


def _shape(samples: int, increment: float | None) -> str:
    return f"{samples} samples" + ("" if increment is None else f" at {1 / increment:.6g} Hz")


def _time_axis(
    run: GroupedRun, times: Sequence[TdmsChannel], samples: int, rate_hz: float | None
) -> tuple[TdmsChannel | None, float | None, list[str]]:
    """The first channel that is a time axis of so many samples, the rate where that tells it, and words on others."""
    words: list[str] = []
    for channel in times:
        (time_s,) = read_samples(run.file.path, [channel])
        try:
            found_hz = rate_hz or _rate_of(time_s.astype(float))
            check_time_axis(time_s.astype(float), samples, found_hz, channel.path)
        except InputError as error:
            words.append(f"left out {channel.path}: {error.problem}")
            continue
        words += [f"left out {other.path}: {channel.path} is the time axis" for other in times if other is not channel]
        return channel, found_hz, words
    return None, rate_hz, words


def _rate_of(time_s: NDArray[np.float64]) -> float:
    """Samples a second by the ends of a time axis (N,), or by most of its steps where a gap lies between the ends.

    1 where it does not grow, which no check lets pass.
    """
    steps_s = np.diff(time_s)
    if not steps_s.size:
        return 1.0
    step = float(np.mean(steps_s))
    if np.ptp(steps_s) > step:
        step = float(np.median(steps_s))
    return rate_in_few_digits_hz(step, _RESOLUTION_S / steps_s.size) if 0 < step < float("inf") else 1.0


def _contradictions(run: GroupedRun, channels: Sequence[TdmsChannel], rate_hz: float) -> list[str]:
    """What the file states against this rate or a common start, in the words of the reader, which refuses it."""
    try:
        for channel in channels:
            check_rate(channel, rate_hz, False, channel.path)
        check_starts(channels, rate_hz, str(run.file.path.name))
    except InputError as error:
        return [f"CHECK: {error.where}: {error.problem}; {error.advice}"]
    return []
