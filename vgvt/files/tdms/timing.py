"""When the samples of TDMS channels were taken: rate and start that their waveform properties state.

NI's waveform properties: ``wf_increment`` (s), ``wf_start_offset`` (s), ``wf_start_time`` (UTC), ``wf_xunit_string``.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import Any

import numpy as np

from vgvt.data import InputError
from vgvt.files.tdms.read import TdmsChannel
from vgvt.files.time_axis import RATE_TOLERANCE

_SECONDS = {"": 1.0, "s": 1.0, "sec": 1.0, "second": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6}
_RATE_ADVICE = (
    "correct sample_rate_hz, or leave the channel out; where the file is wrong, write "
    'overrides = ["sample_rate_hz"] in [records]'
)


def increment_s(channel: TdmsChannel, where: str) -> float | None:
    """Time from sample to sample as the file states it, None where it does not; InputError where it is over no time."""
    stated = channel.properties.get("wf_increment")
    if stated is None:
        return None
    unit = str(channel.properties.get("wf_xunit_string", "")).strip()
    if unit.lower() not in _SECONDS:
        raise InputError(
            where, f"a function over {unit!r} (wf_xunit_string), and not over time", "give the time history itself"
        )
    return _number(stated) * _SECONDS[unit.lower()]


def check_rate(channel: TdmsChannel, sample_rate_hz: float, overridden: bool, where: str) -> None:
    """InputError unless a channel is over time and, where it is not ``overridden``, at this rate, as far as it says."""
    increment = increment_s(channel, where)
    if increment is None or overridden or abs(increment * sample_rate_hz - 1) <= RATE_TOLERANCE:
        return
    states = f"{1 / increment:.6g} Hz" if increment > 0 else "no rate"
    raise InputError(
        where,
        f"the file states {states} (wf_increment = {increment:.6g} s), the sidecar {sample_rate_hz:.6g} Hz",
        _RATE_ADVICE,
    )


def check_starts(channels: Sequence[TdmsChannel], sample_rate_hz: float, where: str) -> None:
    """InputError unless channels of one run begin at one time, to half a sample, as far as they say."""
    begins = np.array([_number(channel.properties.get("wf_start_offset", 0.0)) for channel in channels])
    moments: list[Any] = [channel.properties.get("wf_start_time") for channel in channels]
    if all(isinstance(moment, np.datetime64) for moment in moments):
        begins += [(moment - moments[0]) / np.timedelta64(1, "s") for moment in moments]
    if np.ptp(begins) <= 0.5 / sample_rate_hz:
        return
    late = int(np.argmax(np.abs(begins - begins[0])))
    raise InputError(
        where,
        f"its channels do not begin together: {channels[late].path} {begins[late] - begins[0]:+.6g} s after "
        f"{channels[0].path} (wf_start_time, wf_start_offset)",
        "give channels of one recording, cut to one length; where the file is wrong, write "
        'overrides = ["sample_rate_hz"] in [records]',
    )


def _number(value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        return 0.0
    return number if isfinite(number) else 0.0
