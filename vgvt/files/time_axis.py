"""The time axis that lies beside measured samples: one entry a sample, even, and at the rate that was stated."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError

RATE_TOLERANCE = 1e-3
# Of a step, for axes that were rounded when they were written; a sample that was lost or doubled is a whole step.
_STEP_TOLERANCE = 0.5

_ADVICE = "cut the record there, or resample it; leave time_s out where the time axis is known to be wrong"


def time_of_run(array: NDArray[Any], index: int | None, where: str) -> NDArray[np.float64]:
    """The time axis (N,), in seconds, of a run: the only one in ``array``, or row ``index`` (from 1) of one a run.

    InputError when the array is no time axis, or has none for this run.
    """
    axes = np.atleast_1d(np.squeeze(np.asarray(array, dtype=np.float64)))
    if index is not None and axes.ndim == 2:
        if index > axes.shape[0]:
            raise InputError(where, f"no time axis of run {index} in an array of shape {array.shape}", "correct index")
        axes = axes[index - 1]
    if axes.ndim != 1 and axes.size:
        raise InputError(where, f"an array of shape {array.shape} is no time axis", "name another variable as time_s")
    return np.ravel(axes)


def check_time_axis(time_s: NDArray[np.float64], samples: int, sample_rate_hz: float, where: str) -> None:
    """InputError unless a time axis (N,), in seconds, is that of a record of ``samples`` at this rate without a gap."""
    if time_s.size < 2:
        raise InputError(where, f"the time axis has {time_s.size} entries", "record again")
    if time_s.size != samples:
        raise InputError(
            where,
            f"the time axis has {time_s.size} entries for {samples} samples",
            "name the time axis of these samples; leave time_s out where it is known to be wrong",
        )
    steps = np.diff(time_s) * sample_rate_hz
    even = np.abs(steps - 1) <= _STEP_TOLERANCE
    # Where most steps are right, the others are gaps: they are not to be taken for another rate.
    typical = float(steps[even].mean() if even.any() else steps.mean())
    if not abs(typical - 1) <= RATE_TOLERANCE:
        raise InputError(
            where,
            f"the time axis says {sample_rate_hz / (typical or np.nan):.6g} Hz, "
            f"the sidecar says {sample_rate_hz:.6g} Hz",
            "correct sample_rate_hz, or leave time_s out where the time axis is known to be wrong",
        )
    if not even.all():
        k = int(np.argmin(even))
        raise InputError(
            where,
            f"the time axis steps by {steps[k] / sample_rate_hz:.6g} s from entry {k + 1} to entry {k + 2}, "
            f"{1 / sample_rate_hz:.6g} s is one sample ({np.count_nonzero(~even)} such steps)",
            _ADVICE,
        )
    count = np.arange(time_s.size)
    ahead = (time_s - time_s[0]) * sample_rate_hz - count
    astray = np.abs(ahead) > _STEP_TOLERANCE + RATE_TOLERANCE * count
    if astray.any():
        k = int(np.argmax(astray))
        raise InputError(where, f"the time axis is not even: entry {k + 1} is {ahead[k]:+.3g} samples off", _ADVICE)
