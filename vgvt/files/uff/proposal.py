"""The channel table that Universal Files suggest: what each channel is, and where it was in every run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from vgvt.data import ChannelRole, InputError, Quantity
from vgvt.files.axes import Axes
from vgvt.files.describe.draft import ProposedChannel
from vgvt.files.uff.agreement import in_aircraft_axes
from vgvt.files.uff.grouping import FoundRun, quantity_of
from vgvt.files.uff.time_history import TimeHistory
from vgvt.files.uff.units import CODES_IN_WORDS, NOT_STATED, UnitSystem
from vgvt.files.unit_labels import unit_of_factor, unit_of_label
from vgvt.files.units import QUANTITIES

_NAMES = {
    Quantity.ACCELERATION: "acc",
    Quantity.VELOCITY: "vel",
    Quantity.DISPLACEMENT: "disp",
    Quantity.EXCITATION_FORCE: "force",
    Quantity.GENERAL: "drive",
}


def propose_channels(runs: Sequence[FoundRun], axes: Axes) -> tuple[tuple[ProposedChannel, ...], tuple[str, ...]]:
    """The channels that all runs have, and words on what is left out and why.

    InputError where the order of channels changes from run to run, and not every one states a DOF.
    """
    by_column = _in_the_same_order(runs)
    columns = list(zip(*(run.histories for run in runs), strict=True)) if by_column else _matched(runs)
    channels: list[ProposedChannel] = []
    remarks = [] if by_column else ["the order of the channels changes from run to run: each is found by its DOF"]
    used: Counter[str] = Counter()
    for k, column in enumerate(columns):
        words = f"column {k + 1}" if by_column else f"the time history at {column[0].response}"
        quantity = quantity_of(column[0])
        if quantity is None and column[0].quantity_code not in NOT_STATED:
            stated = CODES_IN_WORDS.get(column[0].quantity_code, f"data type {column[0].quantity_code}")
            remarks.append(f"left out {words}: {stated} is not among the quantities that vgvt reads")
            continue
        if _role(quantity) is ChannelRole.DRIVE and not by_column:
            remarks.append(f"left out {words}: a drive signal is found by its column, which changes from run to run")
            continue
        name = _NAMES[quantity] if quantity is not None else "channel"
        used[name] += 1
        channel = ProposedChannel(
            name=f"{name}{used[name]}",
            role=_role(quantity),
            quantity=next((word for word, kind in QUANTITIES.items() if kind is quantity), ""),
            unit=_unit(column[0], quantity, runs[0].file.units) or "",
            label=column[0].unit,
            column=k + 1 if by_column else None,
            places=tuple(in_aircraft_axes(history, axes) for history in column),
        )
        double = next((other for other in channels if _share_a_place(channel, other)), None)
        if double is not None:
            used[name] -= 1
            remarks.append(f"left out {words}: {double.name} is a {channel.role.value} at the same DOF")
            continue
        channels.append(channel)
    return tuple(_without_number(channel, used) for channel in channels), tuple(remarks)


def _without_number(channel: ProposedChannel, used: Counter[str]) -> ProposedChannel:
    name = channel.name.rstrip("0123456789")
    return replace(channel, name=name) if used[name] == 1 else channel


def _in_the_same_order(runs: Sequence[FoundRun]) -> bool:
    """True unless a column holds another quantity in some run, or what stays stands in another column."""
    orders = [[(quantity_of(h), h.response) for h in run.histories] for run in runs]
    staying = set(orders[0]).intersection(*orders)
    for column in zip(*orders, strict=True):
        if len({quantity for quantity, _ in column}) > 1:
            return False
        if len(set(column)) > 1 and any(place in staying and place[1] is not None for place in column):
            return False
    return True


def _matched(runs: Sequence[FoundRun]) -> list[tuple[TimeHistory, ...]]:
    """Time histories that belong together: first those at the places of every run, then the others by quantity."""
    keyed = [{(quantity_of(h), h.response): h for h in run.histories} for run in runs]
    staying = [key for key in keyed[0] if all(key in one for one in keyed)]
    kinds = list(dict.fromkeys(key[0] for key in keyed[0]))
    rows = [
        [one[key] for key in staying]
        + [h for kind in kinds for key, h in one.items() if key[0] is kind and key not in staying]
        for one in keyed
    ]
    for run, row in zip(runs, rows, strict=True):
        alike = [quantity_of(h) for h in row] == [quantity_of(h) for h in rows[0]]
        if not alike or len(row) < len(run.histories) or any(h.response is None for h in row):
            raise InputError(
                f"{run.file.path}, time histories {run.first} to {run.first + len(run.histories) - 1}",
                "the order of quantities changes from run to run, and DOFs do not tell which channel is which: "
                "one is not stated, or comes twice, or other quantities were measured",
                "describe runs with other channels by themselves; give files in which the order is the same",
            )
    return list(zip(*rows, strict=True))


def _role(quantity: Quantity | None) -> ChannelRole:
    if quantity is Quantity.EXCITATION_FORCE:
        return ChannelRole.REFERENCE
    return ChannelRole.DRIVE if quantity is Quantity.GENERAL else ChannelRole.RESPONSE


def _unit(history: TimeHistory, quantity: Quantity | None, units: UnitSystem | None) -> str | None:
    """The label is what the axis says; without one the file's system tells, where the data type is of it."""
    if history.unit:
        labelled = unit_of_label(history.unit)
        return labelled[1] if labelled is not None and labelled[0] is quantity else None
    if units is None or quantity is None:
        return None
    factor = units.in_si(quantity, history.response is not None and history.response.direction.is_rotation)
    return None if factor is None else unit_of_factor(quantity, factor)


def _share_a_place(channel: ProposedChannel, other: ProposedChannel) -> bool:
    if channel.role is not other.role or channel.role is ChannelRole.DRIVE:
        return False
    pairs = zip(channel.places, other.places, strict=True)
    return any(a is not None and b is not None and a.unsigned == b.unsigned for a, b in pairs)
