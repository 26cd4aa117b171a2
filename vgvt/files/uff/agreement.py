"""What a sidecar says of a time history, held against what the file states of it; where it states nothing, all fits."""

from __future__ import annotations

import numpy as np

from vgvt.data import Dof, InputError
from vgvt.files.axes import Axes
from vgvt.files.sidecar import ChannelRow
from vgvt.files.time_axis import RATE_TOLERANCE, check_time_axis
from vgvt.files.uff.time_history import TimeHistory
from vgvt.files.uff.units import CODES_IN_WORDS, NOT_STATED, QUANTITY_OF_CODE, UnitSystem
from vgvt.files.unit_agreement import check_unit_label, override, unit_in_words
from vgvt.files.unit_labels import same_unit

_TIME = 17
_FIXED_DIGITS = 1e-5  # of the abscissa in the file's header, relative
_RATE_ADVICE = 'correct sample_rate_hz; where the file is wrong, write overrides = ["sample_rate_hz"] in [records]'


def in_aircraft_axes(history: TimeHistory, axes: Axes) -> Dof | None:
    """Where the file says that a time history was measured, with the direction along aircraft axes."""
    dof = history.response
    return None if dof is None else Dof(dof.node, axes.to_aircraft(dof.direction))


def check_channel(
    history: TimeHistory, channel: ChannelRow, dof: Dof | None, axes: Axes, units: UnitSystem | None, run: int
) -> None:
    """InputError where quantity, DOF or unit of a channel are others than the file states, unless they override it."""
    where = f"{history.where} (run {run}, channel {channel.name!r})"
    if "quantity" not in channel.overrides:
        _check_quantity(history, channel, where)
    stated = in_aircraft_axes(history, axes)
    if "dof" not in channel.overrides and dof is not None and stated is not None and stated != dof:
        turned = "" if stated == history.response else f", which is {stated} in aircraft axes"
        raise InputError(
            where,
            f"the file says that it was measured at {history.response}{turned}; the sidecar says {dof}",
            f"correct the column, or the place; {override('dof')}",
        )
    if "unit" not in channel.overrides:
        at = dof or stated
        _check_unit(history, channel, units, where, at is not None and at.direction.is_rotation)


def check_rate(history: TimeHistory, sample_rate_hz: float, overridden: bool, where: str) -> None:
    """InputError unless a time history is over time, evenly, and at this rate; ``overridden`` believes the latter."""
    if history.abscissa_code not in (*NOT_STATED, _TIME):
        over = CODES_IN_WORDS.get(history.abscissa_code, f"data type {history.abscissa_code}")
        raise InputError(where, f"a function over {over}, and not over time", "export the time history itself")
    if overridden:
        return
    if not history.form.even:
        try:
            check_time_axis(history.abscissa_s(), history.form.samples, sample_rate_hz, where)
        except InputError as error:
            raise InputError(
                where, error.problem, f"cut the record there, or resample it; or {_RATE_ADVICE}"
            ) from error
        return
    increment = history.form.increment
    if not abs(increment * sample_rate_hz - 1) <= RATE_TOLERANCE:
        states = f"{1 / increment:.6g} Hz" if increment > 0 else "no rate"
        unit = f" {history.abscissa_unit}" if history.abscissa_unit else ""
        raise InputError(
            where,
            f"the file states {states} (an increment of {increment:.6g}{unit}), the sidecar {sample_rate_hz:.6g} Hz",
            _RATE_ADVICE,
        )


def check_starts(histories: list[TimeHistory], sample_rate_hz: float, where: str) -> None:
    """InputError unless time histories of one run begin at one time, to half a sample."""
    full = [history for history in histories if history.form.samples]
    starts = np.array([h.form.minimum if h.form.even else h.abscissa_s()[0] for h in full])
    if not starts.size or np.ptp(starts) <= 0.5 / sample_rate_hz + _FIXED_DIGITS * np.abs(starts).max():
        return
    late = full[int(np.argmax(np.abs(starts - starts[0])))]
    raise InputError(
        where,
        f"its channels do not begin together: from {starts.min():.6g} s to {starts.max():.6g} s "
        f"({full[0].where} against {late.where})",
        "give channels of one recording, cut to one length",
    )


def _check_quantity(history: TimeHistory, channel: ChannelRow, where: str) -> None:
    code = history.quantity_code
    if code in NOT_STATED or QUANTITY_OF_CODE.get(code) is channel.kind:
        return
    stated = CODES_IN_WORDS.get(code, "another quantity")
    raise InputError(
        where,
        f"the file says {stated} (specific data type {code}), the sidecar says {channel.quantity}",
        f"correct the column, or the quantity; {override('quantity')}",
    )


def _check_unit(
    history: TimeHistory, channel: ChannelRow, units: UnitSystem | None, where: str, about_an_axis: bool
) -> None:
    if check_unit_label(channel, history.unit, where):
        return
    # The file's system says nothing of volts, nor of what has a unit of its own.
    if units is None or channel.unit is None or history.unit or history.quantity_code not in QUANTITY_OF_CODE:
        return
    factor = units.in_si(channel.kind, about_an_axis)
    if factor is not None and not same_unit(channel.si_per_sample, factor):
        raise InputError(
            where,
            f"by the file's units (dataset 164) it is in units of {factor:.6g} {channel.kind.si_unit}, "
            f"the sidecar says {unit_in_words(channel)}",
            f"correct the unit; {override('unit')}",
        )
